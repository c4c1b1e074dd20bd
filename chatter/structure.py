"""The structure of a case: modes as given, or the measured FRFs that it names."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from chatter.case import Case
from chatter.errors import InputError
from chatter.measured_frf import MeasuredAxes, measured_axes
from chatter.stability.zero_order import frequency_lines
from dynamics.frf import MeasurementError, on_common_lines
from dynamics.identification import ModalFit, identify_modes
from dynamics.modal import Mode, receptance_matrix

_AXES = {"x": 0, "y": 1, "z": 2}
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
    axes : tuple of MeasuredAxes
        One entry for each set of FRFs that is fitted together.
    notes : tuple of str
        Assumptions made on reading.
    """

    axes: tuple[MeasuredAxes, ...]
    notes: tuple[str, ...] = ()

    @property
    def directions(self) -> NDArray[np.float64]:
        """Directions (n, 3) that were measured."""
        used = sorted({axis for entry in self.axes for axis in entry.directions})
        return np.eye(3)[[_AXES[axis] for axis in used]]

    @cached_property
    def fits(self) -> tuple[ModalFit, ...]:
        """Modal fit of each set of FRFs."""
        try:
            return tuple(identify_modes(entry.frfs) for entry in self.axes)
        except MeasurementError as error:
            raise InputError(str(error)) from error

    @cached_property
    def modes(self) -> tuple[Mode, ...]:
        """Fitted real modes in the directions of the case."""
        return tuple(
            mode
            for entry, fit in zip(self.axes, self.fits, strict=True)
            for mode in entry.modes(fit)
        )

    def receptance(self) -> tuple[NDArray[np.float64], NDArray[np.complex128]]:
        """Usable lines (m,) in Hz and relative receptance (m, 3, 3) as measured, without a fit."""
        parts = [(entry, frf) for entry in self.axes for frf in entry.tool_point_frfs()]
        frequency, columns = on_common_lines([frf for _, frf in parts])
        total = np.zeros((frequency.size, 3, 3), dtype=np.complex128)
        for (entry, frf), column in zip(parts, columns.T, strict=True):
            for response, reference in entry.case_directions(frf):
                total[:, _AXES[response], _AXES[reference]] += column
        return frequency, total


Structure = GivenModes | MeasuredStructure


def structure_of(case: Case) -> Structure:
    """Return the structure that a case describes.

    Raises
    ------
    InputError
        If the FRF files cannot be read or do not say what is needed.
    """
    section = case.structure
    if section.mode:
        return GivenModes(
            tuple(
                Mode(mode.frequency, mode.damping, mode.mass_kg, tuple(mode.direction), mode.side)
                for mode in section.mode
            )
        )
    if section.frf:
        return measured_structure(case)
    raise InputError(
        f"{case.name}: structure.machine: stability from a virtual machine is not available yet; "
        "give structure.mode or structure.frf"
    )


def measured_structure(case: Case) -> MeasuredStructure:
    """Read the FRFs that a case names."""
    axes, notes = measured_axes(case)
    return MeasuredStructure(axes, notes)
