"""Verdict of a run that ended early: by the linear analysis of the same cut."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from chatter.description.errors import InputError, RunError
from chatter.description.progress import Progress, no_progress
from chatter.detection.chatter_detection import Detection
from chatter.simulation.displaced_too_far import DisplacedTooFarError
from chatter.simulation.result import SimulationResult
from chatter.stability.check import StabilityCheck, check


def with_linear_verdict(
    error: DisplacedTooFarError, progress: Progress = no_progress
) -> SimulationResult:
    """Result of a run whose tool was displaced too far, with the verdict of `check`.

    Where the linear analysis finds the cut stable, or cannot be made, the run stays without one and
    says why.
    """
    result = error.result
    try:
        linear = check(result.case, progress=progress)
    except (InputError, RunError) as problem:
        why = f"{result.why_no_verdict}; the linear analysis gives no verdict: {problem}"
        return replace(result, why_no_verdict=why)
    if linear.stable:
        why = (
            f"{result.why_no_verdict}; the linear analysis finds the cut stable "
            f"({linear.method}, spectral radius {linear.spectral_radius:.4g}): its forced "
            "vibration is that large"
        )
        return replace(result, why_no_verdict=why)
    return replace(result, detection=_chatter(result, linear), why_no_verdict="")


def _chatter(result: SimulationResult, linear: StabilityCheck) -> Detection:
    reason = (
        f"{result.why_no_verdict}; the linear analysis ({linear.method}) has a spectral radius of "
        f"{linear.spectral_radius:.4g}"
    )
    nothing = np.zeros((0, result.displacement.shape[1]))
    return Detection(
        verdict="chatter",
        confidence=1.0,
        reason=reason,
        bifurcation=linear.bifurcation,
        period=0,
        period_unit="tooth",
        chatter_frequency=linear.chatter_frequency,
        growth_rate=math.nan,
        once_per_revolution=nothing,
        once_per_tooth=nothing,
        metrics={},
    )
