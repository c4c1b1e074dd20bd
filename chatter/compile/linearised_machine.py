"""The machine of a case as the stability methods see it: FRFs at the tool point, linearised."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.compile.linearised_friction import (
    RESTING,
    closed_backlashes,
    linearised_frictions,
    rigid_motion,
)
from chatter.compile.machine_cut import MachineCut, machine_cut
from chatter.compile.real_modes import largest_misfit, lines_around, real_modes
from chatter.description.case import Case
from chatter.description.errors import InputError
from dynamics.machine.harmonic import receptance
from dynamics.modal.modes import Mode

#: lines of the receptance, and how far they reach above the highest mode that matters
_LINES = 1600
_ABOVE = 1.5
#: flexibility at the tool point, as a share of the largest, above which a mode matters
_MATTERS = 0.01
_LOWEST = 1.0
#: misfit of the modes, over the largest receptance, of which the user should know
_WORTH_TELLING = 0.02
#: of the lowest natural frequency, from where on resonances are; below, loops hold the axes
_RESONANT_FROM = 0.7


class FittedModes(NamedTuple):
    """Real modes, and by how much they miss the receptance, over its largest value."""

    modes: tuple[Mode, ...]
    lowest: float  # frequency from which on resonances are, Hz
    misfit: float  # from there on
    whole_misfit: float  # at all lines

    @property
    def notes(self) -> list[str]:
        """What of it the user should know."""
        if max(self.misfit, self.whole_misfit) <= _WORTH_TELLING:
            return []
        below = ""
        if self.whole_misfit > _WORTH_TELLING:
            below = f"; with the motion of the axes below, {self.whole_misfit:.1%}"
        return [
            f"methods that need modes take real ones, which miss the receptance above "
            f"{self.lowest:.3g} Hz, where the structure resonates, by up to {self.misfit:.1%} of "
            f"its largest value{below}"
        ]


@dataclass(frozen=True)
class LinearisedMachine:
    """Structure described by the receptance of a linearised machine at its tool point.

    Parameters
    ----------
    case : Case
    cut : MachineCut
    excluded : tuple of str
        Names of frictions that are excluded.
    """

    case: Case
    cut: MachineCut
    excluded: tuple[str, ...] = ()

    @property
    def sticking(self) -> tuple[str, ...]:
        """Names of the frictions that hold as springs: none moves, and no amplitude is stated."""
        if self.case.structure.amplitude_at_frictions > 0.0:
            return ()
        moving = moving_axes(self.case, self.cut)
        motion = rigid_motion(self.cut.machine, moving) if moving else None
        return tuple(
            one.name
            for one in self.cut.machine.frictions
            if one.name not in self.excluded
            and (motion is None or abs(one.row @ motion) <= RESTING)
            and np.real(one.law.stiffness_at_rest(np.array([_LOWEST])))[0] > 0.0
        )

    @property
    def resting(self) -> tuple[str, ...]:
        """Names of the frictions that rest and hold, stuck or linearised at an amplitude."""
        if not self.cut.machine.frictions:
            return ()
        return self.with_stuck().sticking

    def with_stuck(self) -> LinearisedMachine:
        """The same machine with the resting frictions stuck, as under vanishing vibration."""
        return self._stuck

    def with_amplitude(self, amplitude: float) -> LinearisedMachine:
        """The same machine with the resting frictions at vibration of an amplitude, m."""
        return replace(self, case=self.case.patch({"structure.friction_amplitude": amplitude}))

    def without_resting(self) -> LinearisedMachine:
        """The same machine with nothing in place of the frictions that rest."""
        return self._without_resting

    @cached_property
    def _stuck(self) -> LinearisedMachine:
        """As `with_stuck`: several limits ask for its receptance."""
        return self.with_amplitude(0.0)

    @cached_property
    def _without_resting(self) -> LinearisedMachine:
        """As `without_resting`, likewise."""
        return replace(self, excluded=(*self.excluded, *self.resting))

    @cached_property
    def _guess(self) -> tuple[Mode, ...]:
        """Modes of the structure that matter, its loops open."""
        modes = self.cut.modes()
        if not modes:
            raise InputError(
                f"{self.case.name}: structure.machine: {self.cut.file.name} is rigid at the tool"
            )
        least = _MATTERS * max(1.0 / mode.stiffness for mode in modes)
        return tuple(mode for mode in modes if 1.0 / mode.stiffness > least)

    @cached_property
    def _fitted(self) -> FittedModes:
        highest = _ABOVE * max(mode.frequency for mode in self._guess)
        if highest <= _LOWEST:
            raise InputError(
                [
                    f"{self.cut.file.name}: what is most flexible at the tool has its modes at "
                    f"{highest / _ABOVE:.2g} Hz and below: a stiffness is hardly that of a machine",
                    *self.cut.file.notes,
                ]
            )
        lines = lines_around(self._guess, _LOWEST, highest)
        values = tool_receptance(self.case, self.cut, lines, self.excluded)
        modes = real_modes(lines, values, self._guess)
        lowest = _RESONANT_FROM * min(mode.frequency for mode in self._guess)
        above = lines >= lowest
        resonant = largest_misfit(modes, lines[above], values[above])
        return FittedModes(modes, lowest, resonant, largest_misfit(modes, lines, values))

    @property
    def modes(self) -> tuple[Mode, ...]:
        """Real modes fitted to the receptance."""
        return self._fitted.modes

    @property
    def notes(self) -> tuple[str, ...]:
        """What was assumed."""
        loops = "its control loops closed" if self.cut.machine.drives else "no axis under control"
        notes = [*self.cut.notes, f"dynamics of {self.cut.file.name}, linearised, {loops}"]
        if self.cut.machine.frictions:
            amplitude = self.case.structure.amplitude_at_frictions
            others = (
                "stick"
                if amplitude == 0.0
                else f"are linearised at vibration of {amplitude * 1e6:g} um along their axes"
            )
            notes.append(f"frictions of axes that move slide, those of others {others}")
        notes += [*closed_backlashes(self.cut.machine), *self._fitted.notes]
        return tuple(notes)

    @property
    def directions(self) -> NDArray[np.float64]:
        """Directions (3, 3) in which the tool point can move."""
        return np.eye(3)

    def receptance(self) -> tuple[NDArray[np.float64], NDArray[np.complex128]]:
        """Lines (m,) in Hz and relative receptance (m, 3, 3), without a fit, m/N."""
        return self._receptance

    @cached_property
    def _receptance(self) -> tuple[NDArray[np.float64], NDArray[np.complex128]]:
        """As `receptance`: every limit of the same state asks for it."""
        highest = _ABOVE * max(mode.frequency for mode in self._guess)
        lines = np.union1d(
            np.linspace(_LOWEST, highest, _LINES), lines_around(self._guess, _LOWEST, highest)
        )
        return lines, tool_receptance(self.case, self.cut, lines, self.excluded)


def machine_structure(case: Case) -> LinearisedMachine:
    """Structure of a case whose dynamics come from a machine.

    The machine moves at the feed of the case, so that frictions on moving axes slide and others
    stick; the control loops are closed. Modes are fitted to its FRFs when they are asked for.

    Raises
    ------
    InputError
        If the machine cannot make the cut.
    """
    return LinearisedMachine(case, machine_cut(case))


def tool_receptance(
    case: Case, cut: MachineCut, frequency: NDArray[np.float64], excluded: tuple[str, ...] = ()
) -> NDArray[np.complex128]:
    """Receptance (m, 3, 3) of the tool against the workpiece in the directions of the cut, m/N.

    Parameters
    ----------
    case : Case
    cut : MachineCut
    frequency : (m,) array of float
        Hz, above 0.
    excluded : tuple of str, optional
        Names of frictions that are excluded.
    """
    moving = moving_axes(case, cut)
    frictions = linearised_frictions(cut.machine, moving, friction_amplitudes(case, cut))
    frictions = {name: how for name, how in frictions.items() if name not in excluded}
    return receptance(cut.machine, frequency, cut.tool, cut.file.step, frictions)


def friction_amplitudes(case: Case, cut: MachineCut) -> dict[str, float] | None:
    """Amplitude at every friction for the one along the axes, m; at motors by the transmission."""
    along = case.structure.amplitude_at_frictions
    if along == 0.0:
        return None
    found = {}
    for one in cut.machine.frictions:
        # one friction of the file may act at several places: "name[1]"
        target = cut.file.friction[one.name.partition("[")[0]].on
        drive = None if target.motor is None else cut.file.axis[target.motor].drive
        if drive is None:
            found[one.name] = along
        elif not drive.is_rotary:
            found[one.name] = along / drive.spec().transmission
    return found


def moving_axes(case: Case, cut: MachineCut) -> dict[str, float]:
    """Velocity of the axes that move in the cut, m/s or rad/s, by name."""
    teeth, speed = case.tool.teeth, case.cut.spindle_speed
    feed = case.cut.feed_per_tooth * teeth * speed / (2.0 * math.pi)
    return cut.velocities(feed, speed)
