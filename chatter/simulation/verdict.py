"""Chatter or not: by the record of a simulated cut, and by perturbed runs where need be."""

import math
from dataclasses import replace
from typing import TypeVar

import numpy as np

from chatter.description.errors import InputError
from chatter.detection.chatter_detection import Detection, detect_chatter
from chatter.detection.cut_record import CutRecord
from chatter.simulation.perturbation.lyapunov_verdict import (
    LARGE_SWING,
    LyapunovVerdict,
    lyapunov_verdict,
)
from chatter.simulation.result import SimulationResult
from chatter.simulation.tool_course import ToolCourse
from cutting.chip.discrete_chip import DiscreteCut
from dynamics.modal.modes import inside_band

#: a record of fewer revolutions, or of fewer cycles of the lowest mode, is not judged
_LEAST_REVOLUTIONS = 8.0
_LEAST_CYCLES = 12.0
#: deviations from period to period that are none: a carved wall repeats less well
_DELAYED, _CARVED = 0.005, 0.03
#: share of the lowest resonance or loop corner below which motion is no chatter
_WELL_BELOW = 0.25
#: of the highest speed of a program, by which it falls from row to row where it stops
_EVEN = 1e-9
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
    try:
        record = _cut_record(result)
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


def _large(result: SimulationResult) -> bool:
    """Whether the motion is so large that teeth may leave the cut."""
    swing = 0.5 * float(np.ptp(result.displacement[result.settled], axis=0).max())
    return swing > LARGE_SWING * result.case.cut.feed_per_tooth


def _steady(result: SimulationResult) -> bool:
    """Whether the cut is that of [cut] all along, on modes that are known."""
    section = result.case.simulation
    bent = section is not None and section.has_own_path
    return result.case.stock is None and not bent and result.setup.on_machine is None


def _cut_record(result: SimulationResult) -> CutRecord:
    cutter, slices = result.setup.cutter, result.setup.slices
    widest = int(np.argmax(np.ptp(slices.normal_offset, axis=0)))
    # flutes of different helix are no more alike than teeth out of true
    known = np.ptp(cutter.helix) <= _SAME_HELIX
    rows = _before_the_last_stop(result)
    return CutRecord(
        time=result.time[rows],
        spindle_angle=result.spindle_angle[rows],
        displacements=result.displacement[rows],
        tooth_angles=np.sort(cutter.tooth_angles),
        feed_per_tooth=result.case.cut.feed_per_tooth,
        forces=result.force[rows],
        runout=slices.normal_offset[:, widest] if known else None,
        lowest_frequency=_lowest_frequency(result),
        speed_follows=result.setup.turned_by_port,
        negligible=_CARVED if isinstance(result.setup.groups[0], DiscreteCut) else _DELAYED,
    )


def _before_the_last_stop(result: SimulationResult) -> slice:
    """Rows up to where a program begins to stop for the last time: the force falls to nothing."""
    course = result.setup.path
    if not isinstance(course, ToolCourse):
        return slice(None)
    velocity = np.asarray(course.trajectory.at(result.time).velocity, dtype=np.float64)
    speed = np.linalg.norm(velocity, axis=1)
    speed[~np.isfinite(speed)] = 0.0
    for begin, end in course.in_air:
        speed[(result.time >= begin) & (result.time <= end)] = 0.0
    cutting = np.flatnonzero(speed > 0.0)
    if not cutting.size:
        return slice(None)
    does_not_fall = np.diff(speed[: cutting[-1] + 1]) >= -_EVEN * speed.max()
    held = np.flatnonzero(does_not_fall)
    return slice(0, int(held[-1]) + 2 if held.size else int(cutting[-1]) + 1)


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
