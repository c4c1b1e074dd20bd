"""Steady vibration and location error: the time loop against the series of the rigid force.

Where all teeth are alike each meets the wave of the last in phase, so that the chip is that of a
rigid tool and the vibration its force through the receptance, at any amplitude.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from benchmarks.contradictions.confrontation import (
    Comparison,
    Confrontation,
    Document,
    PremiseFailsError,
    relative,
)
from benchmarks.contradictions.drawing import cut, material, structure, tool
from benchmarks.contradictions.drawing.quantities import chosen
from benchmarks.contradictions.edge_quadrature import RigidCut
from benchmarks.contradictions.numbers import refuse_large_vibration, spectral_radius
from chatter.description.case import Case
from chatter.simulation.setup import set_up
from chatter.simulation.simulate import run_setup

#: of the peak displacement, of the peak normal displacement for the location error, and of the cusp
#: between two passes
_DISPLACEMENT, _LOCATION, _CUSP = 0.01, 0.03, 0.1
#: samples of a tooth period for the series, and heights of the wall
_SAMPLES, _HEIGHTS = 6000, 40
#: angles of a pass along the wall, and positions within a feed mark
_PASS, _MARK = 1000, 100
#: a transient has died out at this share
_REST = 1e-4
#: of the feed per tooth: beyond it teeth may leave the cut before the motion is steady
_LARGEST_SWING = 0.25


def draw_alike(rng: np.random.Generator) -> Document:
    """Tool of teeth that are alike, in a stable cut."""
    tool_ = chosen(rng, (tool.end_mill, tool.end_mill, tool.bull_nose, tool.taper, tool.ball))(rng)
    sections = {
        "tool": tool_,
        "material": material.any_material(rng),
        "cut": cut.any_cut(rng, tool_),
    }
    sections["structure"] = {"mode": structure.modes(rng, sections)}
    for mode in sections["structure"]["mode"]:
        mode["damping"] = max(mode["damping"], 0.02)
    return structure.at_depth_of_limits(rng, sections)


def steady_motion(case: Case) -> tuple[NDArray, NDArray]:
    """Spindle angles (n,), rad, of a tooth period and the steady displacement (n, 3) there, m."""
    period = 2.0 * math.pi / case.tool.teeth
    angle = period * (np.arange(_SAMPLES) + 0.5) / _SAMPLES
    spectrum = np.fft.rfft(RigidCut(case).at(angle)[:3], axis=1)
    omega = np.arange(spectrum.shape[1]) * case.tool.teeth * case.cut.spindle_speed
    motion = np.zeros_like(spectrum)
    for mode in case.structure.mode:
        natural = 2.0 * math.pi * mode.frequency
        receptance = 1.0 / (natural**2 - omega**2 + 2j * mode.damping * natural * omega)
        receptance /= mode.modal_mass
        d = np.asarray(mode.direction)
        motion += d[:, None] * (receptance * (d @ spectrum))
    return angle, np.fft.irfft(motion, _SAMPLES, axis=1).T


def compare_vibration(document: Document) -> list[Comparison]:
    """Displacement of the last revolution, and the location error of a straight wall."""
    case = Case.from_dict(document)
    refuse_large_vibration(case)
    radius, _ = spectral_radius(case)
    if radius > 0.93:
        raise PremiseFailsError("the cut is not stable enough to be steady within a short run")
    turns = math.ceil(math.log(_REST) / math.log(max(radius, 1e-6)) / case.tool.teeth) + 6
    case = case.patch({"simulation.revolutions": turns})
    result, _ = run_setup(set_up(case))
    angle, motion = steady_motion(case)
    swing = 0.5 * float(np.ptp(motion, axis=0).max())
    if swing > _LARGEST_SWING * case.cut.feed_per_tooth:
        # docs/time-domain.md: teeth leave the cut on the way from rest, to another steady motion
        raise PremiseFailsError("forced vibration beyond a quarter of the feed per tooth")
    period = 2.0 * math.pi / case.tool.teeth
    last = result.spindle_angle > result.spindle_angle[-1] - 2.0 * math.pi
    at = np.mod(result.spindle_angle[last], period)
    found = []
    scale = float(np.abs(motion).max())
    for axis, name in enumerate("xyz"):
        expected = np.interp(at, angle, motion[:, axis], period=period)
        simulated = result.displacement[last, axis]
        worst = int(np.argmax(np.abs(simulated - expected)))
        found.append(
            relative(
                f"displacement {name}, m", simulated[worst], expected[worst], _DISPLACEMENT, scale
            )
        )
    return found + _location(case, result, angle, motion)


def _location(case: Case, result, angle: NDArray, motion: NDArray) -> list[Comparison]:
    """Mean over the heights of what the edges leave of the wall."""
    error = result.finish.location_error
    if case.tool.kind != "end mill" or case.cut.mode == "slot" or error is None:
        return []
    expected = float(np.mean([_left(case, angle, motion, height) for height in _heights(case)]))
    cusp = case.cut.feed_per_tooth**2 / (4.0 * case.tool.diameter)
    allowed = _LOCATION * float(np.abs(motion[:, 1]).max()) + _CUSP * cusp
    return [Comparison("location error, m", error, expected, allowed)]


def _heights(case: Case) -> NDArray:
    return case.cut.axial_depth * (np.arange(_HEIGHTS) + 0.5) / _HEIGHTS


def _left(case: Case, angle: NDArray, motion: NDArray, height: float) -> float:
    """Mean of the envelope of all passes at a height, m; beyond the wall is positive.

    Where the tool vibrates fast along the normal, an edge reaches furthest beside the wall's angle.
    """
    wall, side = (0.0, 1.0) if case.cut.mode == "up" else (math.pi, -1.0)
    radius, feed = 0.5 * case.tool.diameter, case.cut.feed_per_tooth
    period = 2.0 * math.pi / case.tool.teeth
    swing = float(np.ptp(motion[:, 0]))
    turned = np.linspace(-1.0, 1.0, _PASS) * (1.5 * feed + swing) / radius
    lag = height * math.tan(case.tool.helix) / radius
    x, y = (
        np.interp(np.mod(wall + lag + turned, period), angle, motion[:, axis], period=period)
        for axis in (0, 1)
    )
    along = side * radius * np.sin(turned) + x + feed * turned / period
    beyond = side * y + radius * (np.cos(turned) - 1.0)
    order, at = np.argsort(along), np.arange(_MARK) * feed / _MARK
    passes = [
        np.interp(at + shift * feed, along[order], beyond[order], left=-np.inf, right=-np.inf)
        for shift in (-2, -1, 0, 1, 2)
    ]
    return float(np.max(passes, axis=0).mean())


FORCED_VIBRATION = Confrontation(
    name="forced vibration",
    ways="time loop; Fourier series of the quadrature of the rigid force through the receptance",
    stated="1 % of the peak displacement; for the location error 3 % of the normal one and a tenth "
    "of the cusp between two passes",
    weight=2.0,
    draw=draw_alike,
    compare=compare_vibration,
)
