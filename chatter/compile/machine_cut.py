"""A case on a machine: who moves, where the cut acts, at which step."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from chatter.compile.linearised_friction import rigid_motions
from chatter.compile.machine_parts import assembled_machine, machine_points
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.machine.machine_file import MachineFile
from dynamics.machine.description import Machine
from dynamics.modal.modes import Mode
from dynamics.reduction.modal_truncation import damping_ratios, undamped_modes
from dynamics.structure.spring_coupling import Term

#: cosine of the angle by which directions may miss being along, or across
_ALONG, _ACROSS = 0.999, 1e-3
#: part of the largest motion of the tool point below which a mode does not move it
_UNMOVED = 1e-3
_LEAST_DAMPING = 1e-4


@dataclass(frozen=True, eq=False)
class MachineCut:
    """Machine of a case, seen from the cut."""

    file: MachineFile
    machine: Machine
    #: (3, n), rows of the tool against the workpiece along x, y, z of the cut, both taken at the
    #: tip, so that the force on both has no moment left over
    tool: NDArray[np.float64]
    #: (n,), row of the turning tool against the workpiece, positive as the tool turns; None where
    #: no axis turns it and its speed is prescribed
    spindle: NDArray[np.float64] | None
    spindle_axis: str | None
    sense: float  # 1 or -1: of the spindle's axis against the turning of the tool
    #: velocity of each axis of the machine for a feed of 1 m/s; empty where none of those under
    #: control can feed the tool, whose path is then prescribed
    feeds: Mapping[str, float]
    #: direction of the cut, "x", "y", "z" -> velocity of each axis for 1 m/s along it; those alone
    #: along which the axes under control can move the tool
    travels: Mapping[str, Mapping[str, float]]
    notes: tuple[str, ...] = ()  # what was assumed of the machine

    def velocities(self, feed: float, speed: float) -> dict[str, float]:
        """Velocity of all axes for a feed, m/s, and a spindle speed, rad/s."""
        moving = {axis: share * feed for axis, share in self.feeds.items()}
        if self.spindle_axis is not None:
            moving[self.spindle_axis] = self.sense * speed
        return moving

    def modes(self) -> tuple[Mode, ...]:
        """Undamped modes of the structure that move the tool point, as far as they tell.

        For resolution and pictures; loops are open in them and axes free.
        """
        structure = self.machine.structure
        found = undamped_modes(structure)
        ratios = np.maximum(damping_ratios(structure, found), _LEAST_DAMPING)
        moved = (self.tool @ found.shapes).T
        size = np.linalg.norm(moved, axis=1)
        elastic = found.frequency > 0.0
        least = _UNMOVED * np.max(size[elastic], initial=0.0)
        return tuple(
            Mode(
                float(found.frequency[i]),
                float(min(ratios[i], 0.9)),
                float(size[i] ** -2),
                tuple(moved[i] / size[i]),
            )
            for i in np.flatnonzero(elastic & (size > least))
        )


def machine_cut(case: Case, friction: bool | None = None) -> MachineCut:
    """Machine that a case names, in the state that it asks for.

    `friction` overrides that of the case. InputError if the machine cannot make the cut: no tool
    point, a spindle across the tool.
    """
    section = case.structure
    file = case.machine_file()
    if file.tool_point is None:
        raise InputError(f"{file.name}: tool_point is missing; {case.name} cuts there")
    _refuse_unknown_axes(case, file)
    machine = assembled_machine(file, section.condition, section.position)
    wanted = section.friction if friction is None else friction
    if wanted is False:
        machine = machine.without_friction()
    return cut_on(case, file, machine, section.position or {})


def cut_on(
    case: Case, file: MachineFile, machine: Machine, positions: Mapping[str, float]
) -> MachineCut:
    """Cut of a case on a machine with its axes at positions, m. InputError as `machine_cut`."""
    name = _spindle_axis(case, file, machine)
    tool, spindle, sense = _rows(case, file, machine, positions, name)
    travels = _travels(machine, tool, [one for one in machine.axes if one != name])
    feeds = travels.get("x", {})
    notes = (
        *file.notes,
        *file.questions_of_positions(case.structure.position or {}),
        *_notes_on_workpiece(file),
        *_notes_on_contact(case, file),
    )
    return MachineCut(file, machine, tool, spindle, name, sense, feeds, travels, notes)


def _notes_on_workpiece(file: MachineFile) -> tuple[str, ...]:
    """Say that nothing of the machine yields under the work where the file has no such point."""
    if file.workpiece is not None:
        return ()
    return (
        f"{file.name} has no workpiece: the work is taken as rigid, and what carries it is not in "
        "this cut",
    )


def _notes_on_contact(case: Case, file: MachineFile) -> tuple[str, ...]:
    """What becomes of a contact of the machine in a cut: tap tests may know it, the cut does not.

    Which shares of it act in a cut follows from the engagement, which the case describes.
    """
    if file.contact is None or case.contact is not None:
        return ()
    return (
        f"the [contact] of {file.name} acts in FRFs in the cut; this cut has none, as the case "
        "has no [contact]",
    )


def rows_of_cut(
    case: Case, file: MachineFile, machine: Machine, positions: Mapping[str, float]
) -> dict[str, NDArray[np.float64]]:
    """Rows that a run of the cut reads, by name, on a machine with its axes at positions, m."""
    name = _spindle_axis(case, file, machine)
    tool, spindle, _ = _rows(case, file, machine, positions, name)
    return named_rows(tool, spindle)


def named_rows(
    tool: NDArray[np.float64], spindle: NDArray[np.float64] | None
) -> dict[str, NDArray[np.float64]]:
    """Rows of tool and spindle by the names of their ports."""
    rows = {f"tool {axis}": row for axis, row in zip("xyz", tool, strict=True)}
    return rows if spindle is None else {**rows, "tool turn": spindle}


def _rows(
    case: Case,
    file: MachineFile,
    machine: Machine,
    positions: Mapping[str, float],
    spindle_axis: str | None,
) -> tuple[NDArray[np.float64], NDArray[np.float64] | None, float]:
    """Rows of the tool, and of the spindle with the sense of its axis where one turns it."""
    axes = cut_directions(case)
    tip, workpiece = _ends(file, positions)
    tool = np.array(
        [
            machine.row(
                "tool", (Term(tip.body, direction, tip.at), Term(workpiece, -direction, tip.at))
            )
            for direction in axes
        ]
    )
    if spindle_axis is None:
        return tool, None, 1.0
    return tool, *_spindle_row(case, file, machine, spindle_axis, positions, axes[2])


def _refuse_unknown_axes(case: Case, file: MachineFile) -> None:
    for key in ("condition", "position"):
        for name in getattr(case.structure, key) or ():
            if name not in file.axis:
                known = ", ".join(file.axis) or "none"
                raise InputError(
                    f'{case.name}: structure.{key}: {file.name} has no axis "{name}"; there are '
                    f"{known}"
                )


def cut_directions(case: Case) -> NDArray[np.float64]:
    """Rows x, y, z of the cut in the machine's directions.

    InputError if feed and tool axis are not perpendicular.
    """
    x = np.array(case.structure.feed or (1.0, 0.0, 0.0))
    z = np.array(case.structure.tool_axis or (0.0, 0.0, 1.0))
    if abs(x @ z) > _ACROSS:
        raise InputError(
            f"{case.name}: structure.feed: {x.tolist()} is not perpendicular to the tool axis "
            f"{z.tolist()}"
        )
    return np.array([x, np.cross(z, x), z])


def _ends(file: MachineFile, positions: Mapping[str, float]):
    points = {point.name: point for point in machine_points(file, positions)}
    workpiece = "ground" if file.workpiece is None else points[file.workpiece].body
    return points[file.tool_point], workpiece


def _spindle_axis(case: Case, file: MachineFile, machine: Machine) -> str | None:
    controlled = {drive.axis for drive in machine.drives}
    named = case.structure.spindle
    if named is not None:
        if named not in controlled:
            known = ", ".join(sorted(controlled)) or "none"
            raise InputError(
                f'{case.name}: structure.spindle: axis "{named}" is not under control in '
                f"{file.name}; there are {known}"
            )
        if not file.axis[named].drive.is_rotary:
            turn = [name for name in sorted(controlled) if file.axis[name].drive.is_rotary]
            raise InputError(
                f'{case.name}: structure.spindle: axis "{named}" of {file.name} does not turn; '
                f"{', '.join(turn) or 'none'} would"
            )
        return named
    turning = [
        name
        for name, axis in file.axis.items()
        if axis.drive is not None and axis.drive.kind == "spindle" and name in controlled
    ]
    if len(turning) > 1:
        raise InputError(
            f"{case.name}: structure.spindle is missing; {file.name} has {', '.join(turning)}"
        )
    return turning[0] if turning else None


def _spindle_row(
    case: Case,
    file: MachineFile,
    machine: Machine,
    name: str,
    positions: Mapping[str, float],
    upwards: NDArray[np.float64],
) -> tuple[NDArray[np.float64], float]:
    """Row of the turning tool against the workpiece, and the sense of the axis."""
    direction = np.asarray(file.axis[name].direction, dtype=np.float64)
    direction = direction / np.linalg.norm(direction)
    along = float(direction @ upwards)
    if abs(along) < _ALONG:
        raise InputError(
            f"{case.name}: structure.tool_axis: the spindle {name} of {file.name} turns about "
            f"{direction.tolist()}, not about {upwards.tolist()}"
        )
    # seen from above the tool turns clockwise: about the direction to its tip
    sense = -math.copysign(1.0, along)
    tip, workpiece = _ends(file, positions)
    about = np.concatenate([np.zeros(3), sense * direction])
    rotor = f"{name}: motor"
    turning = rotor if rotor in machine.assembly.parts else tip.body
    terms = (Term(turning, about, tip.at), Term(workpiece, -about, tip.at))
    return machine.row("spindle", terms), sense


def _travels(
    machine: Machine, tool: NDArray[np.float64], axes: list[str]
) -> dict[str, dict[str, float]]:
    """Velocities of controlled axes that move the tool along x, y, z at 1 m/s, where they can."""
    controlled = [name for name in axes if name in {drive.axis for drive in machine.drives}]
    if not controlled:
        return {}
    motions = rigid_motions(machine, [{name: 1.0} for name in controlled])
    ways = (tool @ np.array(motions).T).reshape(3, len(controlled))
    found = {}
    for way, wanted in zip("xyz", np.eye(3), strict=True):
        share, *_ = np.linalg.lstsq(ways, wanted, rcond=None)
        if np.max(np.abs(ways @ share - wanted)) <= _UNMOVED:
            moved = dict(zip(controlled, share.tolist(), strict=True))
            found[way] = {name: part for name, part in moved.items() if abs(part) > 1e-9}
    return found
