"""The structure of a case: modes as given, measured FRFs, or a machine linearised."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from chatter.errors import InputError
from chatter.measured_frf import MeasuredSide, measured_sides
from chatter.stability.zero_order import frequency_lines
from dynamics.frf import MeasurementError
from dynamics.identification import ModalFit
from dynamics.modal import Mode, receptance_matrix

if TYPE_CHECKING:
    from chatter.case import Case

#: chatter is looked for up to this multiple of the highest mode
_HIGHEST_CHATTER = 4.0


@dataclass(frozen=True)
class GivenModes:
    """Structure described by modes.

    Parameters
    ----------
    modes : tuple of Mode
    notes : tuple of str
        Assumptions; none here.
    """

    modes: tuple[Mode, ...]
    notes: tuple[str, ...] = ()

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
    """Structure described by measured FRFs; modes are fitted when they are first asked for.

    Parameters
    ----------
    sides : tuple of MeasuredSide
    notes : tuple of str
        Assumptions made on reading.
    """

    sides: tuple[MeasuredSide, ...]
    notes: tuple[str, ...] = ()

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
        """Fitted real modes in the directions of the case."""
        return tuple(mode for side in self.sides for mode in side.modes)

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


def _given_modes(case: Case) -> GivenModes:
    speed = case.cut.spindle_speed if case.cut is not None else 0.0
    modes = []
    for place, mode in enumerate(case.structure.mode):
        frequency = mode.frequency_at(speed)
        if not frequency > 0.0:
            raise InputError(
                f"{case.name}: structure.mode[{place}].frequency_slope: {mode.frequency_slope:g} "
                f"s/rad leaves no frequency at {speed * 30.0 / np.pi:.0f} rpm"
            )
        modes.append(Mode(frequency, mode.damping, mode.modal_mass, mode.direction, mode.side))
    notes = ()
    if any(mode.frequency_slope for mode in case.structure.mode):
        notes = (f"natural frequencies as at {speed * 30.0 / np.pi:.0f} rpm",)
    return GivenModes(tuple(modes), notes)


Structure = GivenModes | MeasuredStructure


def structure_of(case: Case) -> Structure:
    """Return the structure that a case describes.

    Raises
    ------
    InputError
        If the FRF files cannot be read or do not say what is needed, or the machine cannot make
        the cut.
    """
    section = case.structure
    if section.mode:
        return _given_modes(case)
    if section.frf:
        return MeasuredStructure(*measured_sides(case))
    from chatter.coupled.linearised import machine_structure

    return machine_structure(case)
