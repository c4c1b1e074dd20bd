"""Sections whose keys are those of a law: fields, schema and checks from what the laws declare."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, ClassVar, Literal, Protocol

from pydantic import Field, create_model, model_validator

from chatter.description.registry import Registry
from chatter.description.section import Section, raise_if_any
from chatter.description.wording import key_problems
from cutting.force import laws as force_laws
from cutting.force.law import ForceLawEntry
from dynamics.friction import laws as friction_laws
from dynamics.friction.law import FrictionLawEntry


class Key(Protocol):
    """A quantity that a law declares (`cutting.keys.Key`, `dynamics.keys.Key`)."""

    name: str
    dimension: str
    help: str
    default: float | None
    needed: bool
    above: float | None
    at_least: float | None
    below: float | None
    at_most: float | None

    def problem(self, value: float) -> str:
        """Say how an SI value is out of range; empty where it is within."""


class LawSection(Section):
    """A section with `law`, and the keys of every law in a registry."""

    LAWS: ClassVar[Registry]
    law: str

    @property
    def values(self) -> dict[str, float]:
        """Values by key of the law, SI; those that are not given and have no default left out."""
        given = {key.name: getattr(self, key.name) for key in self.LAWS[self.law].keys}
        return {name: value for name, value in given.items() if value is not None}

    @model_validator(mode="after")
    def _check_keys(self) -> LawSection:
        keys = {key.name: key for key in self.LAWS[self.law].keys}
        of_laws = {key.name for law in self.LAWS for key in law.keys}
        shared = tuple(name for name in type(self).model_fields if name not in of_laws)
        problems = key_problems(
            self, "law", {name: key.needed for name, key in keys.items()}, shared
        )
        for name, value in self.values.items():
            problem = keys[name].problem(value)
            problems += [(name, f'{problem}, of law = "{self.law}"')] if problem else []
        raise_if_any(problems)
        return self


def law_section(base: type[LawSection], default: str | None, field_type: Callable[..., Any]) -> Any:
    """Make the base of a section from the keys that its laws declare.

    Parameters
    ----------
    base : type
        With `LAWS`.
    default : str or None
        Law where the section names none; None where it must.
    field_type : callable
        Name of a dimension and bounds -> type of a field, such as `quantity`.
    """
    laws = base.LAWS
    by_name: dict[str, list[Key]] = {}
    for law in laws:
        for key in law.keys:
            by_name.setdefault(key.name, []).append(key)
    fields = {key: _field(declared, field_type) for key, declared in by_name.items()}
    described = "; ".join(f"{law.name}: {law.help}" for law in laws)
    return create_model(
        base.__name__,
        __base__=base,
        __module__=__name__,
        law=(Literal[laws.names()], Field(default or ..., description=described)),
        **fields,
    )


def _field(declared: list[Key], field_type: Callable[..., Any]) -> tuple[Any, Any]:
    """Type and default of a field that several laws may have, with the widest of their ranges."""
    first = declared[0]
    others = {key.dimension for key in declared} - {first.dimension}
    if others:
        raise ValueError(f"laws differ in what {first.name} is: {first.dimension}, {others}")
    bounds = {
        **_widest(("above", "at_least"), ((key.above, key.at_least) for key in declared), min),
        **_widest(("below", "at_most"), ((key.below, key.at_most) for key in declared), max),
    }
    defaults = {key.default for key in declared}
    default = defaults.pop() if len(defaults) == 1 else None
    info = Field(default, description=first.help or None)
    kind = field_type(first.dimension, **bounds)
    return (kind if default is not None else kind | None), info


def _widest(
    names: tuple[str, str],
    bounds: Iterable[tuple[float | None, float | None]],
    choose: Callable[..., float],
) -> dict[str, float]:
    """Bound, exclusive or inclusive, that holds for all; none where one has none."""
    pairs = list(bounds)
    if any(pair == (None, None) for pair in pairs):
        return {}
    widest = choose(strict if strict is not None else loose for strict, loose in pairs)
    inclusive = any(loose == widest for _, loose in pairs)
    return {names[1] if inclusive else names[0]: widest}


FORCE_LAWS: Registry[ForceLawEntry] = Registry(
    group="chatter.force_laws", what="force law", built_in=force_laws.LAWS
)
FRICTION_LAWS: Registry[FrictionLawEntry] = Registry(
    group="chatter.friction_laws", what="friction law", built_in=friction_laws.LAWS
)

for _force_law in FORCE_LAWS:
    force_laws.include(_force_law)
for _friction_law in FRICTION_LAWS:
    friction_laws.include(_friction_law)
