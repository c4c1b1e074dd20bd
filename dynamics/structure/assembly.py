"""Bodies, beams, rotors and imported parts joined into one structure.

Displacements and rotations are small; an axis may travel far along its guides, since nothing
resists it there.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.structure.bodies import GROUND, Body, Connector, MeshedPart, Part, Point
from dynamics.structure.linear_structure import LinearStructure, StructureError
from dynamics.structure.rigid_body_motion import DIRECTIONS, refuse_free_motion
from dynamics.structure.spring_coupling import Coupling, Term


class _Spring(NamedTuple):
    """Springs and dampers of a connector or a coupling."""

    link: Connector | Coupling
    deformation: NDArray[np.float64]  # per freedom, (k, n)
    stiffness: NDArray[np.float64]  # (k,)
    damping: NDArray[np.float64]  # (k,)
    of_rigid: NDArray[np.float64]  # of those with a stiffness, per rigid motion of the parts


@dataclass(frozen=True, eq=False)
class Assembly:
    """Structure that still knows its parts."""

    structure: LinearStructure
    parts: Mapping[str, Part]
    columns: Mapping[str, slice]  # freedoms of each part
    #: motion of parts at positions that were asked for
    _motions: Mapping[str, dict[bytes, NDArray[np.float64]]]
    _springs: Mapping[str, _Spring] = field(default_factory=dict)
    _loose: LinearStructure | None = None  # of the parts without them

    def motion(self, who: str, part: str, at: ArrayLike) -> NDArray[np.float64]:
        """Motion (6, n) of a part at a position, m, per freedom; none of the ground.

        Raises StructureError if there is no such part; the message begins with `who`.
        """
        motion = np.zeros((6, self.structure.size))
        if part != GROUND:
            columns = self.columns_of(who, part)
            motion[:, columns] = self.own_motion(part, at)
        return motion

    def columns_of(self, who: str, part: str) -> slice:
        """Freedoms of a part, which is not the ground; StructureError if there is none."""
        if part not in self.parts:
            known = ", ".join(f'"{name}"' for name in self.parts)
            raise StructureError(f'{who}: there is no body or beam "{part}"; there are {known}')
        return self.columns[part]

    def own_motion(self, part: str, at: ArrayLike) -> NDArray[np.float64]:
        """Motion (6, k) of a part at a position, m, per freedom of its own."""
        # nut, scale, friction and motor of an axis are at one place
        known, key = self._motions[part], np.asarray(at, dtype=np.float64).tobytes()
        if key not in known:
            known[key] = self.parts[part].motion_at(at)
        return known[key]

    def row(self, who: str, terms: Sequence[Term]) -> NDArray[np.float64]:
        """Row (n,) of the sum of motions, as a port of the structure."""
        row = np.zeros(self.structure.size)
        for term in terms:
            if term.part != GROUND:
                columns = self.columns_of(who, term.part)
                row[columns] += np.asarray(term.direction) @ self.own_motion(term.part, term.at)
        return row


def assembly(
    bodies: Sequence[Part],
    connectors: Sequence[Connector],
    points: Sequence[Point],
    beams: Sequence[MeshedPart] = (),
    allowed_rigid_motions: int = 0,
    rotors: Sequence[Part] = (),
    couplings: Sequence[Coupling] = (),
    neighbour: Assembly | None = None,
) -> Assembly:
    """Join parts by connectors and couplings (transmissions) into one structure of dense matrices.

    Bodies have six freedoms each, in order: x, y, z of the centre of gravity and rotations;
    imported parts may stand among them. Lines of beam elements (`dynamics.beam.shaft.BeamLine`)
    follow with their freedoms, their bearings join the connectors; the freedoms of rotors, which
    turn in the drives (`dynamics.structure.rotor.Rotor`), come last. `allowed_rigid_motions` is how
    many independent motions may be left that no connector resists (6 for a free machine, 1 for an
    axis whose drive is free to turn). What an assembly of some of the same parts and connectors,
    the `neighbour`, knows of them is not found again. StructureError if names are unknown or twice
    given, nothing is there to move, or parts move freely.
    """
    joints = [*connectors, *(bearing for beam in beams for bearing in beam.connectors)]
    meshed = with_nodes_where_joined(beams, connectors, couplings, points)
    parts = _named("body or beam", [*bodies, *meshed, *rotors])
    for kind, items in (("connector", joints), ("coupling", couplings), ("point", points)):
        _named(kind, items)
    if not parts:
        raise StructureError("a structure needs at least one body or beam")
    columns = _columns({name: part.rigid_motions.shape[0] for name, part in parts.items()})
    same = _same_parts(parts, columns, neighbour)
    motions = {name: neighbour._motions[name] if name in same else {} for name in parts}
    bare = Assembly(_loose(parts, same, neighbour), parts, columns, motions)
    links: list[Connector | Coupling] = [*joints, *couplings]
    rigid = _side_by_side([part.rigid_motions for part in parts.values()])
    known = {} if neighbour is None else neighbour._springs
    springs = {
        one.name: known[one.name] if _is_known(one, known, same) else _spring(one, bare, rigid)
        for one in links
    }
    _refuse_free_parts(parts, springs.values(), allowed_rigid_motions)
    whole = LinearStructure(
        bare.structure.mass,
        bare.structure.damping + _over(springs.values(), lambda one: one.damping),
        bare.structure.stiffness + _over(springs.values(), lambda one: one.stiffness),
        {one.name: bare.motion(f'point "{one.name}"', one.body, one.at) for one in points},
    )
    return replace(bare, structure=whole, _springs=springs, _loose=bare.structure)


def assemble(
    bodies: Sequence[Body],
    connectors: Sequence[Connector],
    points: Sequence[Point],
    beams: Sequence[MeshedPart] = (),
    allowed_rigid_motions: int = 0,
    rotors: Sequence[Part] = (),
    couplings: Sequence[Coupling] = (),
) -> LinearStructure:
    """Structure of an `assembly`, which see."""
    return assembly(
        bodies, connectors, points, beams, allowed_rigid_motions, rotors, couplings
    ).structure


def with_nodes_where_joined(
    beams: Sequence[MeshedPart],
    connectors: Sequence[Connector],
    couplings: Sequence[Coupling],
    points: Sequence[Point],
) -> list[MeshedPart]:
    """Beams with nodes wherever connectors, their bearings, couplings or points are on them."""
    joints = [*connectors, *(bearing for beam in beams for bearing in beam.connectors)]
    positions = [(part, joint.at) for joint in joints for part in (joint.first, joint.second)]
    positions += [(point.body, point.at) for point in points]
    positions += [(term.part, term.at) for one in couplings for term in one.terms]
    return [
        beam.with_nodes_at([at for name, at in positions if name == beam.name]) for beam in beams
    ]


def _named(kind: str, items: Iterable) -> dict:
    named: dict = {}
    for item in items:
        if item.name in named:
            raise StructureError(f'{kind} "{item.name}" is there twice; names must differ')
        named[item.name] = item
    return named


def _columns(sizes: Mapping[str, int]) -> dict[str, slice]:
    ends = np.cumsum(list(sizes.values()))
    return {
        name: slice(int(end) - size, int(end))
        for (name, size), end in zip(sizes.items(), ends, strict=True)
    }


def _deformation(joint: Connector, bare: Assembly) -> NDArray[np.float64]:
    """Relative motion (6, n) of both sides of a connector in its own axes."""
    deformation = np.zeros((6, bare.structure.size))
    for part, sign in ((joint.first, 1.0), (joint.second, -1.0)):
        if part != GROUND:
            columns = bare.columns_of(f'connector "{joint.name}"', part)
            deformation[:, columns] = sign * joint.in_own_axes(bare.own_motion(part, joint.at))
    return deformation


def _same_parts(
    parts: Mapping[str, Part], columns: Mapping[str, slice], neighbour: Assembly | None
) -> set[str]:
    """Names of parts that are those of another assembly, with the same freedoms of the whole."""
    if neighbour is None or neighbour.columns != columns:
        return set()
    return {name for name, part in parts.items() if neighbour.parts[name] is part}


def _loose(
    parts: Mapping[str, Part], same: set[str], neighbour: Assembly | None
) -> LinearStructure:
    """Structure of parts that nothing joins, which does not change where they only travel."""
    if same and all(
        np.array_equal(one, other)
        for name in parts.keys() - same
        for one, other in zip(_matrices(parts[name]), _matrices(neighbour.parts[name]), strict=True)
    ):
        return neighbour._loose
    mass, damping, stiffness = (
        _side_by_side(matrices) for matrices in zip(*map(_matrices, parts.values()), strict=True)
    )
    return LinearStructure(mass, damping, stiffness, {})


def _matrices(part: Part) -> tuple[NDArray[np.float64], ...]:
    return part.mass_matrix, part.damping_matrix, part.stiffness_matrix


def _is_known(
    link: Connector | Coupling, known: Mapping[str, _Spring], same: Container[str]
) -> bool:
    """Whether another assembly has the connector, between the same parts."""
    return (
        isinstance(link, Connector)
        and link.name in known
        and known[link.name].link is link
        and all(end == GROUND or end in same for end in (link.first, link.second))
    )


def _spring(link: Connector | Coupling, bare: Assembly, rigid: NDArray[np.float64]) -> _Spring:
    """Springs and dampers of a link between parts whose rigid motions (n, m) are given."""
    if isinstance(link, Connector):
        deformation = _deformation(link, bare)
    else:
        deformation = bare.row(f'coupling "{link.name}"', link.terms)[None, :]
    stiffness, damping = np.atleast_1d(link.stiffness), np.atleast_1d(link.damping)
    return _Spring(link, deformation, stiffness, damping, deformation[stiffness > 0.0] @ rigid)


def _side_by_side(matrices: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Block diagonal matrix; scipy's of many small blocks takes longer than all of the rest."""
    rows, columns = np.sum([one.shape for one in matrices], axis=0)
    whole = np.zeros((rows, columns))
    row = column = 0
    for one in matrices:
        whole[row : row + one.shape[0], column : column + one.shape[1]] = one
        row, column = row + one.shape[0], column + one.shape[1]
    return whole


def _over(
    springs: Iterable[_Spring], rate: Callable[[_Spring], NDArray[np.float64]]
) -> NDArray[np.float64]:
    """Matrix (n, n) of springs of a rate along their deformations."""
    several = list(springs)
    if not several:
        return 0.0
    each = np.concatenate([rate(one) for one in several])
    # most directions of most joints have no rate, dampers above all
    acting = each != 0.0
    rows = np.vstack([one.deformation for one in several])[acting]
    return rows.T @ (each[acting, None] * rows)


def _refuse_free_parts(parts: Mapping[str, Part], springs: Iterable[_Spring], allowed: int) -> None:
    """Refuse rigid motions of parts that no spring resists."""
    turning, labels = [], []
    for name, part in parts.items():
        single = part.rigid_motions.shape[1] == 1
        turning += [True] if single else [False] * 3 + [True] * 3
        labels += [
            f'"{name}" {direction}' for direction in (("rotation",) if single else DIRECTIONS)
        ]
    rows = np.vstack([*(one.of_rigid for one in springs), np.zeros((1, len(turning)))])
    refuse_free_motion(rows, np.array(turning), labels, allowed)
