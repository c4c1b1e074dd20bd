"""What the waveforms bear witness of: runout, law, resonances, offsets, each kept by evidence."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from chatter.cutting_coefficients.laws import BY_DIRECTION, LAWS, TriedLaw, of_directions
from chatter.cutting_coefficients.revolution_average import RevolutionAverage
from chatter.cutting_coefficients.waveform_fit import Problem, WaveformFit, fitted, residual_weights
from chatter.cutting_coefficients.waveform_model import WaveformModel
from chatter.description.arrays import Array

#: start angles tried within the pitch of a tooth
_STARTS = 48
#: multiple of the least residual up to which start angles fit alike
_ALIKE = 1.01
#: runout that is tried first, in its unit, and its directions
_FIRST_RUNOUT, _DIRECTIONS = 0.5, 6
_FIRST_EXPONENT, _FIRST_HELIX = 0.7, math.radians(30.0)
#: damping ratio of a resonance that is tried first
_FIRST_DAMPING = 0.1
#: its frequencies that are tried
_FREQUENCIES = 24
#: directions whose powers are fitted together
_SEVERAL = 2
#: the law of which the search starts: with edge forces
_FIRST_LAW = "linear"


def waveform_fits(
    averages: Sequence[RevolutionAverage], unsigned: Sequence[str], helix: bool, zeroed: bool
) -> list[WaveformFit]:
    """Fits of every law to the waveforms, with the runout, offsets and resonances that show.

    Parameters
    ----------
    averages : sequence of RevolutionAverage
    unsigned : sequence of str
        Channels whose sense is not known.
    helix : bool
        Whether the helix is fitted too.
    zeroed : bool
        Whether the air has shown the offsets: what they would hide is told by the means then.

    Returns
    -------
    list of WaveformFit
        The best first, by the Bayesian criterion.
    """
    rigid = _first_fit(averages, unsigned)
    found = [_with_runout(rigid), *([] if not helix else [_with_helix(_with_runout(rigid))])]
    best = _with_dynamics(_best([rigid, *found]))
    if not best.model.runout:
        # a resonance may have hidden it
        best = _best([best, _with_runout(best)])
    # from here on what a harmonic is left to be wrong by says how much it counts
    best = _weighted(best)
    without = _without_offsets(best)
    best = without if zeroed and best.hidden else _best([best, without])
    others = [law for law in _laws(LAWS, averages) if law.name != _FIRST_LAW]
    fits = [best, *(_with_law(best, law) for law in others)]
    fits += _by_direction(best)
    effective = _effective(fits)
    return sorted(fits, key=lambda one: one.criterion(effective))


def _laws(laws: Sequence[TriedLaw], averages: Sequence[RevolutionAverage]) -> list[TriedLaw]:
    """Laws that the channels can tell."""
    return of_directions(laws, np.concatenate([one.directions for one in averages]))


def _by_direction(linear: WaveformFit) -> list[WaveformFit]:
    """Fits with a power in one direction, and in all those where one is better than a line."""
    laws = _laws(BY_DIRECTION, linear.averages)
    single = [_with_law(linear, law) for law in laws if law.exponent_count == 1]
    better = [one for one in single if _best([linear, one]) is one]
    bent = {number for one in better for number in range(3) if one.model.law.exponents[number] >= 0}
    if len(bent) < _SEVERAL:
        return single
    together = next(
        law for law in laws if bent == {number for number in range(3) if law.exponents[number] >= 0}
    )
    return [*single, _with_law(linear, together)]


def _with_dynamics(fit: WaveformFit) -> WaveformFit:
    """Resonances and a low-pass of the dynamometer; one may hide the other at first."""
    best = _with_resonances(fit)
    best = _best([best, _with_low_pass(best)])
    return _with_resonances(best)


def _weighted(fit: WaveformFit) -> WaveformFit:
    return fitted(fit.model, fit.averages, fit.parameters, residual_weights(fit))


def _effective(fits: Sequence[WaveformFit]) -> Array:
    """Independent readings that all are compared by: those of what the best one leaves."""
    return min(fits, key=lambda one: float(np.sum(np.log(one.power)))).effective


def _best(fits: Sequence[WaveformFit]) -> WaveformFit:
    effective = _effective(fits)
    return min(fits, key=lambda one: one.criterion(effective))


def refitted(fit: WaveformFit, averages: Sequence[RevolutionAverage]) -> WaveformFit:
    """Fit the same model to other cuts, from the same first values and aligned anew."""
    parts = fit.model.split(fit.parameters, len(fit.averages))
    names = [one.run for one in fit.averages]
    start = [parts["start"][names.index(one.run)] for one in averages]
    first = np.concatenate([start, fit.parameters[len(fit.averages) :]])
    return fitted(fit.model, averages, first, fit.weights)


def _first_fit(averages: Sequence[RevolutionAverage], unsigned: Sequence[str]) -> WaveformFit:
    """Linear law without runout, its start angles and the senses of the channels looked for."""
    teeth = averages[0].case.tool.teeth
    linear = next(law for law in _laws(LAWS, averages) if law.name == _FIRST_LAW)
    choices = itertools.product((1.0, -1.0), repeat=len(unsigned))
    models = [
        WaveformModel(linear, teeth, dict(zip(unsigned, one, strict=True))) for one in choices
    ]
    largest = max(averages, key=lambda one: one.case.cut.feed_per_tooth)
    began = _preferred([start for model in models for start in _starts(model, largest)])
    found = [began.angle if one is largest else _nearest(began, one) for one in averages]
    return fitted(began.model, averages, np.array(found))


class _Start(NamedTuple):
    """A start angle of one cut, and what the linear law is like that fits best there."""

    model: WaveformModel
    angle: float  # rad
    coefficients: Array
    wrong: int  # senses looked for: cutting coefficients below zero, radial above tangential
    power: float  # of the residual
    doubtful: bool  # whether a tangential or radial coefficient, of chip or edge, is below zero
    offset: float  # size of the offsets over that of the varying force


def _angles(model: WaveformModel) -> Array:
    """Start angles that are tried, rad, within the pitch of a tooth."""
    return np.linspace(0.0, 2.0 * math.pi / model.teeth, _STARTS, endpoint=False)


def _starts(model: WaveformModel, cut: RevolutionAverage) -> list[_Start]:
    problem = Problem(model, [cut])
    count = len(model.law.keys)
    found = []
    for angle in _angles(model):
        values, left = problem.solved(np.array([angle]))
        coefficients, offsets = values[:count], values[count:]
        cutting = coefficients[model.law.cutting]
        wrong = int(np.sum(cutting < 0.0)) + int(cutting[1] > cutting[0])
        in_plane = [number for number, key in enumerate(model.law.keys) if key[1] != "a"]
        found.append(
            _Start(
                *(model, float(angle), coefficients, wrong if model.signs else 0),
                float(left @ left),
                bool(np.any(coefficients[in_plane] < 0.0)),
                float(np.linalg.norm(offsets * problem.weights[:, 0])),
            )
        )
    return found


def _preferred(starts: Sequence[_Start]) -> _Start:
    """Best start; of those that fit alike the one whose coefficients cut, or of the least offset.

    In a slot an odd number of teeth turned by half a revolution is in the work where it was out of
    it. Chip forces are then the opposite of what they were but for a constant, which free offsets
    take up, and edge forces are the same: both turns fit every waveform alike.
    """
    best = min(starts, key=lambda one: (one.wrong, one.power))
    alike = [one for one in starts if one.wrong == best.wrong and one.power <= _ALIKE * best.power]
    return min(alike, key=lambda one: (one.doubtful, one.offset))


def _nearest(began: _Start, one: RevolutionAverage) -> float:
    """Start angle of another cut by the coefficients of the first."""
    model = began.model
    parts = model.split(np.zeros(1), 1)
    forces = model.forces(one, parts)

    def left(start: float) -> float:
        shown = model.seen(one, parts, forces, start) @ began.coefficients
        return float(np.sum(np.abs((shown - one.amplitude)[:, 1:]) ** 2))

    return float(min(_angles(model), key=left))


def _with_runout(fit: WaveformFit) -> WaveformFit:
    """Runout found from the first cut, then the tooth that each other cut starts with."""
    model = replace(fit.model, runout=True)
    if model.teeth == 1:
        return fit
    averages = fit.averages
    rest = fit.parameters[len(averages) :]
    tries = [
        fitted(model, averages[:1], np.concatenate([fit.parameters[:1], runout, rest]), fit.weights)
        for runout in _runouts(model)
    ]
    first = min(tries, key=lambda one: float(one.power.sum()))
    pitch = 2.0 * math.pi / model.teeth
    starts = [first.parameters[0]]
    for number, one in enumerate(averages[1:], start=1):
        problem = Problem(model, [one], fit.weights)
        turned = [fit.parameters[number] + pitch * tooth for tooth in range(model.teeth)]
        starts.append(min(turned, key=lambda start: _power(problem, start, first.parameters[1:])))
    return fitted(model, averages, np.concatenate([starts, first.parameters[1:]]), fit.weights)


def _power(problem: Problem, start: float, rest: Array) -> float:
    left = problem.solved(np.concatenate([[start], rest]))[1]
    return float(left @ left)


def _runouts(model: WaveformModel) -> Iterator[Array]:
    if model.runout_count == 1:
        yield np.array([_FIRST_RUNOUT])
        yield np.array([-_FIRST_RUNOUT])
        return
    for angle in 2.0 * math.pi * np.arange(_DIRECTIONS) / _DIRECTIONS:
        yield _FIRST_RUNOUT * np.array([math.cos(angle), math.sin(angle)])


def _with_helix(fit: WaveformFit) -> WaveformFit:
    return _again(fit, replace(fit.model, helix=True), {"helix": np.array([_FIRST_HELIX])})


def _with_law(fit: WaveformFit, law: TriedLaw) -> WaveformFit:
    exponents = np.full(law.exponent_count, _FIRST_EXPONENT)
    return _again(fit, replace(fit.model, law=law), {"exponent": exponents})


def _without_offsets(fit: WaveformFit) -> WaveformFit:
    return _again(fit, replace(fit.model, offsets=False), {})


def _with_resonances(fit: WaveformFit) -> WaveformFit:
    """Resonances added one channel after another, each from where it leaves least."""
    best = fit
    for name in fit.averages[0].channels:
        if name in best.model.resonant:
            continue
        model = replace(best.model, resonant=(*best.model.resonant, name))
        problem = Problem(model, best.averages, best.weights)
        tries = [_resonance(best, frequency) for frequency in _frequencies(best)]
        scored = [
            (float(np.sum(problem.solved(_joined(best, one))[1] ** 2)), number)
            for number, one in enumerate(tries)
        ]
        best = _best([best, _again(best, model, tries[min(scored)[1]])])
    return best


def _with_low_pass(fit: WaveformFit) -> WaveformFit:
    """One low-pass before all channels, from where it leaves least; its delay turns the starts."""
    model = replace(fit.model, low_pass=True)
    problem = Problem(model, fit.averages, fit.weights)
    starts = fit.parameters[: len(fit.averages)]
    speeds = np.array([one.speed for one in fit.averages])
    tries = [
        {
            "start": starts + math.sqrt(2.0) * speeds / (2.0 * math.pi * cut_off),
            "low_pass": np.array([math.log(cut_off)]),
        }
        for cut_off in _frequencies(fit)
    ]
    best = min(tries, key=lambda one: float(np.sum(problem.solved(_joined(fit, one))[1] ** 2)))
    return _again(fit, model, best)


def _resonance(fit: WaveformFit, frequency: float) -> dict[str, Array]:
    kept = fit.model.split(fit.parameters, len(fit.averages))["resonance"]
    return {"resonance": np.append(kept, [math.log(frequency), math.log(_FIRST_DAMPING)])}


def _frequencies(fit: WaveformFit) -> Array:
    """Frequencies of a resonance that are tried, Hz, above those of the teeth."""
    one = fit.averages[0]
    turn = one.speed / (2.0 * math.pi)
    return np.geomspace(2.0 * fit.model.teeth * turn, 2.0 * one.harmonic[-1] * turn, _FREQUENCIES)


def _again(fit: WaveformFit, model: WaveformModel, new: dict[str, Array]) -> WaveformFit:
    """Fit a changed model from where the fit is."""
    return fitted(model, fit.averages, _joined(fit, new), fit.weights)


def _joined(fit: WaveformFit, new: dict[str, Array]) -> Array:
    parts = {**fit.model.split(fit.parameters, len(fit.averages)), **new}
    return np.concatenate(list(parts.values()))
