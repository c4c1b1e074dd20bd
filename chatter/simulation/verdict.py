"""Chatter or not: by the record of a simulated cut, and by perturbed runs where need be."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from chatter.description.errors import InputError
from chatter.detection.chatter_detection import Detection, detect_chatter
from chatter.detection.cut_record import CutRecord
from chatter.simulation.perturbation.lyapunov_verdict import (
    LARGE_SWING,
    LyapunovVerdict,
    lyapunov_verdict,
)
from chatter.simulation.result import SimulationResult
from chatter.simulation.steady_parts import in_direction_of_feed, may_be_modulation, steady_parts
from cutting.chip.discrete_chip import DiscreteCut
from dynamics.modal.modes import inside_band

#: a record of fewer revolutions, or of fewer cycles of the lowest mode, is not judged
_LEAST_REVOLUTIONS = 8.0
_LEAST_CYCLES = 12.0
#: deviations from period to period that are none: a carved wall repeats less well
_DELAYED, _CARVED = 0.005, 0.03
#: share of the lowest resonance or loop corner below which motion is no chatter
_WELL_BELOW = 0.25
#: helix angles within this, rad, are the same
_SAME_HELIX = 1e-12

Result = TypeVar("Result", bound=SimulationResult)


def with_verdict(result: Result) -> Result:
    """Result with the answer whether its cut chatters.

    The record alone tells at a constant speed, unless it repeats and is so large that teeth leave
    the cut: chatter that is full may repeat too, above all from revolution to revolution. There,
    and under a varying speed, further runs follow how a small perturbation of the motion goes on.
    """
    detection, why_not = _detected(result)
    return replace(result, detection=detection, why_no_verdict=why_not)


def _detected(result: SimulationResult) -> tuple[Detection | None, str]:
    if not result.setup.modes:
        return None, "the tool is rigid"
    if result.revolutions < _LEAST_REVOLUTIONS:
        return None, f"fewer than {_LEAST_REVOLUTIONS:g} revolutions were simulated"
    slowest = min(mode.frequency for mode in inside_band(result.setup.modes))
    if result.time[-1] * slowest < _LEAST_CYCLES:
        return (
            None,
            f"the run holds fewer than {_LEAST_CYCLES:g} cycles of the lowest mode, "
            f"{slowest:.4g} Hz",
        )
    parts = steady_parts(result)
    if parts is not None:
        return _over_parts(result, parts, slowest)
    try:
        record = _cut_record(result, slice(None), result.displacement)
    except InputError as error:
        return None, str(error)
    found = detect_chatter(record)
    varies = result.setup.spindle.amplitude != 0.0
    if not varies and not (found.verdict == "stable" and _large(result) and _steady(result)):
        return found, ""
    perturbed = lyapunov_verdict(result.case, result.setup.modes)
    if not perturbed.verdict:
        return None, perturbed.reason
    if not varies and perturbed.stable:
        return found, ""
    return _by_perturbation(perturbed, found, result.setup.spindle.speed), ""


def _over_parts(
    result: SimulationResult, parts: Sequence[slice], slowest: float
) -> tuple[Detection | None, str]:
    """Verdict of a program: chatter where any steady part has it, else that of the longest."""
    long = [rows for rows in parts if _holds_enough(result, rows, slowest)]
    if not long:
        return None, (
            f"no part of the program at a constant feed, on a line or an arc, holds "
            f"{_LEAST_REVOLUTIONS:g} revolutions and {_LEAST_CYCLES:g} cycles of the lowest mode, "
            f"{slowest:.4g} Hz"
        )
    found = []
    for rows in long:
        try:
            record = _cut_record(result, rows, in_direction_of_feed(result, rows))
        except InputError as error:
            return None, str(error)
        one = detect_chatter(record)
        if not (one.verdict == "chatter" and may_be_modulation(result, rows, one)):
            found.append((one, rows))
    if not found:
        return None, "on its arcs chatter is not told from the forces that turn with the feed"
    return _worst(result, found), ""


def _holds_enough(result: SimulationResult, rows: slice, slowest: float) -> bool:
    angle, time = result.spindle_angle[rows], result.time[rows]
    turned = float(angle[-1] - angle[0]) / (2.0 * math.pi)
    return turned >= _LEAST_REVOLUTIONS and float(time[-1] - time[0]) * slowest >= _LEAST_CYCLES


def _worst(result: SimulationResult, found: Sequence[tuple[Detection, slice]]) -> Detection:
    """The surest chatter, or the longest part, with its time in the reason."""
    chatters = [one for one in found if one[0].verdict == "chatter"]
    if chatters:
        worst, rows = max(chatters, key=lambda one: one[0].confidence)
    else:
        worst, rows = max(found, key=lambda one: one[1].stop - one[1].start)
    if len(found) == 1 and rows.stop - rows.start == len(result.time):
        return worst
    begin, end = result.time[rows.start], result.time[rows.stop - 1]
    where = f"from {begin:.3g} to {end:.3g} s, at a constant feed, "
    share = f"; {len(chatters)} of {len(found)} such parts chatter" if len(found) > 1 else ""
    return replace(worst, reason=f"{where}{worst.reason}{share}")


def _large(result: SimulationResult) -> bool:
    """Whether the motion is so large that teeth may leave the cut."""
    swing = 0.5 * float(np.ptp(result.displacement[result.settled], axis=0).max())
    return swing > LARGE_SWING * result.case.cut.feed_per_tooth


def _steady(result: SimulationResult) -> bool:
    """Whether the cut is that of [cut] all along, on modes that are known."""
    section = result.case.simulation
    bent = section is not None and section.has_own_path
    return result.case.stock is None and not bent and result.setup.on_machine is None


def _cut_record(
    result: SimulationResult, rows: slice, displacement: NDArray[np.float64]
) -> CutRecord:
    cutter, slices = result.setup.cutter, result.setup.slices
    widest = int(np.argmax(np.ptp(slices.normal_offset, axis=0)))
    # flutes of different helix are no more alike than teeth out of true
    known = np.ptp(cutter.helix) <= _SAME_HELIX
    return CutRecord(
        time=result.time[rows],
        spindle_angle=result.spindle_angle[rows],
        displacements=displacement,
        tooth_angles=np.sort(cutter.tooth_angles),
        feed_per_tooth=result.case.cut.feed_per_tooth,
        forces=result.force[rows],
        runout=slices.normal_offset[:, widest] if known else None,
        lowest_frequency=_lowest_frequency(result),
        speed_follows=result.setup.turned_by_port,
        negligible=_CARVED if isinstance(result.setup.groups[0], DiscreteCut) else _DELAYED,
    )


def _lowest_frequency(result: SimulationResult) -> float:
    """Frequency, Hz, well below every resonance of the structure and every loop of its drives."""
    lowest = min(mode.frequency for mode in result.setup.modes)
    on_machine = result.setup.on_machine
    if on_machine is not None:
        gains = [drive.controller.position.gain for drive in on_machine.machine.drives]
        # the corner of a position loop
        corners = (gain / (2.0 * math.pi) for gain in gains if gain > 0.0)
        lowest = min([lowest, *corners])
    return _WELL_BELOW * lowest


def _by_perturbation(perturbed: LyapunovVerdict, found: Detection, speed: float) -> Detection:
    """Verdict by a small perturbation, where the record does not tell."""
    a_revolution = math.expm1(min(perturbed.rate, 50.0))
    return replace(
        found,
        verdict=perturbed.verdict,
        confidence=min(1.0, 0.5 + 10.0 * abs(a_revolution)),
        reason=perturbed.reason,
        bifurcation="none" if perturbed.stable else "unknown",
        chatter_frequency=perturbed.frequency,
        growth_rate=perturbed.rate * speed / (2.0 * math.pi),
    )
