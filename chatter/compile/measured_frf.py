"""The FRF files that a case names: read, given their directions, sorted by side."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from chatter.description.errors import InputError
from chatter.io.formats.format_list import read_frfs
from dynamics.frf.container import Frf, MeasurementError, Point, on_common_lines
from dynamics.identification.fit import identify_modes
from dynamics.identification.prepare import prepare
from dynamics.identification.result import IdentifiedMode, ModalFit
from dynamics.modal.modes import Mode, Side, frequency_lines, receptance_matrix

if TYPE_CHECKING:
    from chatter.description.case import Case
    from chatter.description.sections.structure import MeasuredFrf


_AXES = "xyz"


@dataclass(frozen=True)
class MeasuredSide:
    """All FRFs of the tool or of the workpiece, in the directions of the case."""

    side: Side
    #: those at the tool point and, for better poles, others of the same structure
    frfs: tuple[Frf, ...]
    node: str | None = None  # node of the tool point

    def tool_point_frfs(self) -> tuple[Frf, ...]:
        """FRFs with force and response at the tool point."""
        return tuple(
            frf
            for frf in self.frfs
            if frf.response.node == frf.reference.node and self.node in (None, frf.response.node)
        )

    @cached_property
    def fit(self) -> ModalFit:
        """Modal fit of all FRFs of the side.

        Raises InputError if no mode at the tool point is found.
        """
        try:
            fit = with_magnitudes(identify_modes(self.frfs, tool_point=self.node))
        except MeasurementError as error:
            raise InputError(str(error)) from error
        if not fit.modes:
            raise InputError(f"structure.frf: no mode at the tool point: {fit.no_mass_reason}")
        return fit

    @cached_property
    def modes(self) -> tuple[Mode, ...]:
        """Real modes at the tool point, those for what lies beyond the band included.

        Magnitudes where the FRFs are not passive (see notes).
        """
        both = (*self.fit.modes, *self.fit.beyond.modes)
        return tuple(replace(mode, side=self.side) for mode in both)

    def notes_on_modes(self) -> tuple[str, ...]:
        """What the modes say of the structure beyond the band; the FRFs are fitted for it."""
        return notes_on_band(self.fit, self.side)

    def notes(self) -> tuple[str, ...]:
        """Warnings about FRFs that no drive point can have."""
        return tuple(
            f"{frf.source}: {NOT_PASSIVE}"
            for frf in self.tool_point_frfs()
            if frf.is_drive_point and not is_passive(frf)
        )

    def receptance(self) -> tuple[NDArray[np.float64], NDArray[np.complex128]]:
        """Usable lines (m,) in Hz and receptance (m, 3, 3) at the tool point, m/N, as measured.

        Where the measurement is not that of a drive point, the receptance of `modes` stands in.
        """
        measured = self.tool_point_frfs()
        band = prepare(measured, None).clean
        inside = [frf.receptance().band(band.lowest, band.highest) for frf in measured]
        frequency, columns = on_common_lines(inside)
        if self.notes():
            lines = frequency_lines(
                np.array([mode.frequency for mode in self.modes]),
                np.array([mode.damping for mode in self.modes]),
                band.highest,
            )
            return lines, receptance_matrix(self.modes, lines)
        total = np.zeros((frequency.size, 3, 3), dtype=np.complex128)
        for frf, column in zip(measured, columns.T, strict=True):
            i, j = (_AXES.index(p.direction) for p in (frf.response, frf.reference))
            value = column * frf.response.sign * frf.reference.sign
            total[:, i, j] = value
            # reciprocity stands in for a cross term that was not measured itself
            if not np.any(total[:, j, i]):
                total[:, j, i] = value
        return frequency, total


#: compliance beyond the band, over that of the modes in it, and misfit that are worth a note
_NOTED_COMPLIANCE, _NOTED_MISFIT = 0.002, 0.01


def notes_on_band(fit: ModalFit, side: Side) -> tuple[str, ...]:
    """Say which modes stand for what lies beyond the band of a fit, and what they miss."""
    ends = f"the band {fit.band.lowest:.4g} to {fit.band.highest:.4g} Hz of the FRFs of the {side}"
    notes = []
    for mode in fit.beyond.modes:
        compliance = 1.0 / mode.stiffness
        inside = sum(
            np.dot(one.direction, mode.direction) ** 2 / one.stiffness for one in fit.modes
        )
        if compliance < _NOTED_COMPLIANCE * inside:
            continue
        along = ", ".join(f"{part:.2g}" for part in mode.direction)
        notes.append(
            f"{mode.band} {ends}, a mode at {mode.frequency:.4g} Hz with damping "
            f"{mode.damping:.2g} along [{along}] stands for the fitted residual: static compliance "
            f"{1e6 * compliance:.3g} um/N, {compliance / inside:.2g} of that of the modes in the "
            "band"
        )
    if fit.beyond.misfit > _NOTED_MISFIT:
        notes.append(
            f"the modes for what lies beyond {ends} miss the fit by up to "
            f"{fit.beyond.misfit:.1%} of its largest receptance"
        )
    return tuple(notes)


def measured_sides(
    case: Case, entries: Sequence[MeasuredFrf]
) -> tuple[tuple[MeasuredSide, ...], tuple[str, ...]]:
    """Read FRFs of a case.

    Tool side and workpiece side of the files that count, as far as measured, and assumptions made.
    InputError if a file cannot be read, or files do not say at which point or in which direction.
    """
    notes: list[str] = []
    problems: list[str] = []
    found: dict[Side, list[Frf]] = {"tool": [], "workpiece": []}
    nodes: dict[Side, set[str]] = {"tool": set(), "workpiece": set()}
    for entry in entries:
        try:
            frfs = read_frfs(entry.file)
            found[entry.side] += _directed(entry, frfs, notes)
        except (MeasurementError, InputError) as error:
            problems.append(str(error))
            continue
        nodes[entry.side] |= _tool_nodes(entry, frfs)
    for side, names in nodes.items():
        if len(names) > 1 and not problems:
            listed = ", ".join(f'"{name}"' for name in sorted(names))
            problems.append(
                f"{case.name}: structure.frf: drive points at several nodes of the {side} "
                f'({listed}); name the tool point with node = "..."'
            )
        if found[side] and not names and not problems:
            problems.append(
                f"{case.name}: structure.frf: no FRF of the {side} has force and response at the "
                "same point; the tool point needs one"
            )
    if problems:
        raise InputError(problems)
    sides = tuple(
        MeasuredSide(side, tuple(frfs), next(iter(nodes[side])))
        for side, frfs in found.items()
        if frfs
    )
    notes += [note for side in sides for note in side.notes()]
    return sides, tuple(dict.fromkeys(notes))


def _tool_nodes(entry: MeasuredFrf, frfs: Iterable[Frf]) -> set[str]:
    drive = {frf.response.node for frf in frfs if frf.response.node == frf.reference.node}
    if entry.node is not None:
        drive &= {entry.node}
    return drive


def _directed(entry: MeasuredFrf, frfs: list[Frf], notes: list[str]) -> list[Frf]:
    """Give the FRFs of one file the directions that the case says they have."""
    if entry.direction is None:
        if all(frf.response.direction and frf.reference.direction for frf in frfs):
            return frfs
        notes.append(
            f"{entry.file.name} names no direction: taken as the same in x and y; say so, or "
            'otherwise, with direction = "x" in [[structure.frf]]'
        )
        return [with_direction(frf, axis, axis) for axis in "xy" for frf in frfs]
    pairs = {(frf.response.direction, frf.reference.direction) for frf in frfs}
    if len(pairs) > 1:
        listed = ", ".join(sorted("".join(pair) or "none" for pair in pairs))
        raise InputError(
            f"{entry.file}: holds FRFs in several directions ({listed}); direction = "
            f'"{entry.direction}" cannot stand for all of them; leave it out'
        )
    response, reference = entry.direction[0], entry.direction[-1]
    return [with_direction(frf, response, reference) for frf in frfs]


def with_direction(frf: Frf, response: str, reference: str) -> Frf:
    """Return an FRF with the directions of response and force replaced, their senses kept."""
    return replace(
        frf,
        response=Point(frf.response.node, response, frf.response.sign),
        reference=Point(frf.reference.node, reference, frf.reference.sign),
    )


NOT_PASSIVE = (
    "power flows out at some resonances, so this is no drive point; the magnitudes of its modes "
    "are used, which is right where force and response were at opposite ends of a symmetric part. "
    "Measure force and response at the same point to be sure"
)
#: lines this high, relative to the peak, count as resonance
_RESONANCE_SHARE = 0.1
#: share of the summed imaginary part that may have the wrong sign
_MOST_WRONG = 0.1


def is_passive(frf: Frf) -> bool:
    """Tell whether an FRF can be that of a drive point, sign of the sensor aside.

    Not where the imaginary part of the mobility-like loss changes sign between resonances.
    """
    positive = frf.band(np.finfo(float).tiny, np.inf)
    # the measured quantity keeps the weight of high and low modes alike
    turn = {"receptance": 1.0, "mobility": 1j, "accelerance": -1.0}[frf.quantity]
    loss = -(positive.values / turn).imag
    high = np.abs(positive.values) >= _RESONANCE_SHARE * np.abs(positive.values).max()
    total = np.abs(loss[high]).sum()
    inflow = loss[high][loss[high] > 0.0].sum() / total if total else 1.0
    return bool(min(inflow, 1.0 - inflow) <= _MOST_WRONG)


def with_magnitudes(fit: ModalFit) -> ModalFit:
    """Give the modes of a drive point that is none the mass that the magnitude of its FRF means.

    The same where it has real modes at the tool point, or where no FRF is labelled a drive point;
    else with masses, directions and a warning in every mode.
    """
    labelled = [k for k, frf in enumerate(fit.frfs) if frf.is_drive_point]
    if fit.modes or not labelled:
        return fit
    k = labelled[0]
    axis = fit.frfs[k].response.direction or "x"
    direction = tuple(float(axis == name) for name in "xyz")
    identified = tuple(_with_magnitude(mode, k, direction) for mode in fit.identified)
    modes = tuple(
        Mode(mode.frequency, mode.damping, mode.mass, direction)
        for mode in identified
        if mode.mass is not None
    )
    notes = (*fit.notes, f"{fit.frfs[k].source}: {NOT_PASSIVE}")
    return replace(fit, identified=identified, modes=modes, no_mass_reason="", notes=notes)


def _with_magnitude(
    mode: IdentifiedMode, k: int, direction: tuple[float, float, float]
) -> IdentifiedMode:
    residue = abs(float(mode.residues[k].real))
    if not (np.isfinite(residue) and residue > 0.0):
        return mode
    return replace(mode, mass=1.0 / residue, direction=direction)
