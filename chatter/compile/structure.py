"""The structure of a case: modes as given, measured FRFs, or a machine linearised."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from chatter.description.errors import InputError
from chatter.description.units import rpm
from dynamics.frf.container import MeasurementError
from dynamics.modal.modes import Mode, frequency_lines, receptance_matrix

if TYPE_CHECKING:
    from chatter.compile.measured_frf import MeasuredSide
    from chatter.description.case import Case
    from dynamics.identification.result import ModalFit

#: chatter is looked for up to this multiple of the highest mode
_HIGHEST_CHATTER = 4.0


@dataclass(frozen=True)
class GivenModes:
    """Structure described by modes."""

    modes: tuple[Mode, ...]
    notes: tuple[str, ...] = ()  # assumptions; none here

    @property
    def directions(self) -> NDArray[np.float64]:
        """Directions (n, 3) in which the tool point can move."""
        return np.array([mode.direction for mode in self.modes])

    def receptance(self) -> tuple[NDArray[np.float64], NDArray[np.complex128]]:
        """Lines (m,) in Hz dense around every mode, and relative receptance (m, 3, 3), m/N."""
        frequency = np.array([mode.frequency for mode in self.modes])
        damping = np.array([mode.damping for mode in self.modes])
        lines = frequency_lines(frequency, damping, _HIGHEST_CHATTER * float(frequency.max()))
        return lines, receptance_matrix(self.modes, lines)


@dataclass(frozen=True)
class MeasuredStructure:
    """Structure described by measured FRFs; modes are fitted when they are first asked for."""

    sides: tuple[MeasuredSide, ...]
    notes: tuple[str, ...] = ()  # assumptions made on reading

    @cached_property
    def directions(self) -> NDArray[np.float64]:
        """Directions (n, 3) that were measured."""
        used = {
            point.direction
            for side in self.sides
            for frf in side.tool_point_frfs()
            for point in (frf.response, frf.reference)
        }
        return np.eye(3)[["xyz".index(axis) for axis in sorted(used)]]

    @property
    def fits(self) -> tuple[ModalFit, ...]:
        """Modal fit of each side."""
        return tuple(side.fit for side in self.sides)

    @property
    def modes(self) -> tuple[Mode, ...]:
        """Fitted real modes in the directions of the case, those beyond the band included."""
        return tuple(mode for side in self.sides for mode in side.modes)

    @property
    def notes_on_modes(self) -> tuple[str, ...]:
        """What was assumed by who takes the modes instead of the measured lines."""
        return tuple(note for side in self.sides for note in side.notes_on_modes())

    def receptance(self) -> tuple[NDArray[np.float64], NDArray[np.complex128]]:
        """Usable lines (m,) in Hz and relative receptance (m, 3, 3) as measured, without a fit."""
        try:
            parts = [side.receptance() for side in self.sides]
        except MeasurementError as error:
            raise InputError(str(error)) from error
        lowest = max(float(lines[0]) for lines, _ in parts)
        highest = min(float(lines[-1]) for lines, _ in parts)
        lines = parts[0][0][(parts[0][0] >= lowest) & (parts[0][0] <= highest)]
        if lines.size < 2:
            raise InputError("structure.frf: tool and workpiece share no frequency range")
        return lines, sum(_on_lines(lines, *part) for part in parts)


def _on_lines(
    lines: NDArray[np.float64], frequency: NDArray[np.float64], values: NDArray[np.complex128]
) -> NDArray[np.complex128]:
    """Interpolate (m, 3, 3) values linearly to other lines."""
    flat = values.reshape(len(values), 9).T
    columns = [
        np.interp(lines, frequency, column.real) + 1j * np.interp(lines, frequency, column.imag)
        for column in flat
    ]
    return np.stack(columns, axis=1).reshape(lines.size, 3, 3)


def depends_on_speed(case: Case) -> bool:
    """Tell whether the modes or FRFs of a case are others at another spindle speed."""
    section = case.structure
    return section is not None and (
        any(mode.depends_on_speed for mode in section.mode) or bool(_measured_speeds(case))
    )


def reference_speeds(case: Case, speeds: NDArray[np.float64]) -> NDArray[np.float64]:
    """Spindle speed whose structure stands for each speed (rad/s): alike means the same structure.

    Of measured FRFs those of the nearest speed stand for all around it; modes change with every
    speed; else it is the speed of the case.
    """
    speeds = np.asarray(speeds, dtype=np.float64)
    if not depends_on_speed(case):
        return np.full(speeds.shape, case.cut.spindle_speed)
    measured = np.array(_measured_speeds(case))
    if not measured.size:
        return speeds
    return measured[np.argmin(np.abs(speeds[..., None] - measured), axis=-1)]


def _measured_speeds(case: Case) -> list[float]:
    """Speeds (rad/s) at which FRFs were measured, ascending; none where no speed is given."""
    measured = {frf.spindle_speed for frf in case.structure.frf if frf.spindle_speed is not None}
    return sorted(measured)


def _given_modes(case: Case, speed: float) -> GivenModes:
    modes = []
    for index, mode in enumerate(case.structure.mode):
        frequency = mode.frequency_at(speed)
        if not frequency > 0.0:
            raise InputError(
                f"{case.name}: structure.mode[{index}].frequency_slope: {mode.frequency_slope:g} "
                f"s/rad leaves no frequency at {rpm(speed):.0f} rpm"
            )
        damping, mass = mode.damping_at(speed), mode.mass_at(speed)
        modes.append(Mode(frequency, damping, mass, mode.direction, mode.side))
    return GivenModes(tuple(modes), _notes_on_speed(case))


def _notes_on_speed(case: Case) -> tuple[str, ...]:
    if not depends_on_speed(case):
        return ()
    notes = ["the structure depends on the spindle speed, and is taken as it is at each speed"]
    for index, mode in enumerate(case.structure.mode):
        if mode.speed_dependence is not None:
            first, *_, last = mode.speed_dependence.speeds
            notes.append(
                f"structure.mode[{index}].speed_dependence goes from {rpm(first):.0f} to "
                f"{rpm(last):.0f} rpm; beyond, the mode is held as at the end"
            )
    measured = _measured_speeds(case)
    if measured:
        listed = ", ".join(f"{rpm(speed):.0f}" for speed in measured)
        notes.append(
            f"FRFs were measured at {listed} rpm; those of the nearest of these speeds stand for "
            "all around it"
        )
    return tuple(notes)


Structure = GivenModes | MeasuredStructure


def structure_of(case: Case) -> Structure:
    """Return the structure that a case describes, at its spindle speed.

    InputError if the FRF files cannot be read or do not say what is needed, or the machine cannot
    make the cut.
    """
    return structure_at(case, case.cut.spindle_speed if case.cut is not None else 0.0)


def structure_at(case: Case, spindle_speed: float) -> Structure:
    """Return the structure that a case describes, at any spindle speed (rad/s).

    A machine is taken at the speed of the case.

    InputError as `structure_of`.
    """
    section = case.structure
    if section.mode:
        return _given_modes(case, spindle_speed)
    if section.frf:
        measured = _measured_speeds(case)
        nearest = min(measured, key=lambda speed: abs(speed - spindle_speed)) if measured else None
        chosen = tuple(frf for frf in section.frf if frf.spindle_speed in (None, nearest))
        from chatter.compile.measured_frf import measured_sides

        sides, notes = measured_sides(case, chosen)
        return MeasuredStructure(sides, (*notes, *_notes_on_speed(case)))
    from chatter.compile.linearised_machine import machine_structure

    return machine_structure(case)
