"""What a friction law is: a specification, keys of files, a table and leaves for the kernels."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.keys import Key, with_defaults


class FrictionLaw(Protocol):
    """Parameters of one friction, SI; along a rotation read N m, rad for N, m.

    A frozen dataclass.
    """

    __dataclass_fields__: ClassVar[dict[str, Any]]

    def steady_state_force(self, velocity: ArrayLike) -> NDArray[np.float64]:
        """Force at constant velocities in m/s, N."""
        ...

    def stiffness_at_rest(self, frequency: ArrayLike) -> NDArray[np.complex128]:
        """Dynamic stiffness, N/m, of small motion about rest; Hz."""
        ...

    def stiffness_in_motion(self, frequency: ArrayLike, velocity: float) -> NDArray[np.complex128]:
        """Dynamic stiffness, N/m, of small motion about a velocity in m/s; Hz."""
        ...

    def describing_function(self, amplitude: float, frequency: float) -> tuple[float, float]:
        """Equivalent stiffness, N/m, and damping, N s/m, of x = A sin(w t); m, Hz."""
        ...


class FrictionTable(Protocol):
    """Frictions of one law as the kernels see them: a NamedTuple of columns."""

    @property
    def port(self) -> NDArray[np.int64]:
        """(n,): where each acts."""
        ...


@dataclass(frozen=True)
class FrictionLawEntry:
    """A friction law in the list of laws.

    Parameters
    ----------
    name : str
        In files.
    label : str
        In messages and pictures.
    help : str
        One line for the schema and the tables of the docs.
    keys : sequence of Key
        That files give; those with the names of the fields of `spec`, unless `make` reads others.
    spec : type
        Of the law: a `FrictionLaw`.
    table : type
        NamedTuple of columns for the kernels, with `port`, and with the state `rate` (m/s, of the
        last step) where `implicit.implicit_force` solves the law.
    columns : callable
        Laws and their ports -> table at rest.
    step : callable
        Leaf: force held over a step; see `dynamics.friction.implicit`.
    force : callable
        Leaf: mean force over a motion at constant velocity.
    advance : callable
        Leaf: moves the state on.
    make : callable, optional
        Values by key -> law; by default `spec` itself.
    """

    name: str
    label: str
    help: str
    keys: Sequence[Key]
    spec: type
    table: type
    columns: Callable[[Sequence[Any], Sequence[int]], FrictionTable]
    step: Callable
    force: Callable
    advance: Callable
    make: Callable[..., FrictionLaw] | None = None

    def of(self, values: Mapping[str, float]) -> FrictionLaw:
        """Law of values by key, SI; those with a default may be left out.

        Raises ValueError if a value is out of its range; the message names it.
        """
        return (self.make or self.spec)(**with_defaults(self.keys, values))


def parameter_columns(laws: Sequence[Any], names: Sequence[str]) -> dict[str, NDArray[np.float64]]:
    """Columns (n,) of the parameters of n laws, by their names; not writeable."""
    return {
        name: _fixed(np.array([getattr(law, name) for law in laws], dtype=np.float64))
        for name in names
    }


def port_column(ports: Sequence[int]) -> NDArray[np.int64]:
    """Column (n,) of the ports that n laws act on; not writeable."""
    return _fixed(np.array(ports, dtype=np.int64))


def _fixed(column: NDArray) -> NDArray:
    column.flags.writeable = False
    return column
