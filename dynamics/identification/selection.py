"""How many modes the data support: candidates dropped and missing modes added."""

from collections.abc import Iterator

import numpy as np
import scipy
from numpy.typing import NDArray

from dynamics.identification.condensed import SearchRecords
from dynamics.identification.mode_quality import inside, mode_quality, without_mode
from dynamics.identification.refinement import (
    ModalModel,
    falls_with_a_pole,
    pole_range,
    refine,
    refine_poles,
    rises_without_a_mode,
)
from dynamics.identification.residues import Records
from dynamics.identification.stabilisation import HIGHEST_DAMPING
from dynamics.least_squares import ROUGH

#: gain from which a mode that stands alone needs no second look
CLEAR_GAIN = 10.0

#: dampings at which a missing mode is first tried
TRIAL_DAMPINGS = (0.001, 0.004, 0.015, 0.05, 0.15)

#: frequencies at which a missing mode is tried in one round
MOST_TRIALS = 4

#: poles that may stand for the modes beyond either end of the lines
MOST_BEYOND = 2

#: part of the half bandwidth, and of the damping, by which a pole may move and counts as the same
_STAYED = 0.05

#: rounds of adding modes one by one
MOST_ADDED = 30


def drop_unsupported(records: SearchRecords, model: ModalModel) -> ModalModel:
    """Leave out, one by one, the modes that the data do not support, weakest first.

    The model is refined, and so is the one returned, in which every mode is supported.
    """
    supported = np.zeros((0, 2))
    while model.count:
        astray = _astray(records.fewer, model)
        if astray.size:
            doubtful: int | None = int(astray[0])
        else:
            doubtful, supported = _unsupported(records, model, supported)
        if doubtful is None:
            return model
        model = refine(records.fewer, without_mode(records.fewer, model, doubtful))
    return model


def _unsupported(
    records: SearchRecords, model: ModalModel, supported: NDArray[np.float64]
) -> tuple[int | None, NDArray[np.float64]]:
    """The mode of least weight that is not supported, None where all are.

    And the poles (p, 2) found to be, frequency, rad/s, and damping, with those of before: a mode
    that is still where it was is not tried again without it, the others moved.
    """
    without = model.chi_square + rises_without_a_mode(records.fewer, model)
    kept = list(supported)
    for mode in _by_contribution(records.fewer, model):
        pole = model.natural_frequency[mode], model.damping[mode]
        first = mode_quality(records, model, mode, float(without[mode]))
        distance = _distance(model, mode)
        alone = first.gain > CLEAR_GAIN and distance > 5.0
        clear = alone or (first.gain > 100.0 * CLEAR_GAIN and distance > 1.5)
        if first.supported and (clear or _is_among(pole, supported)):
            continue  # no other mode could take its place
        if not first.supported:
            return mode, np.reshape(kept, (-1, 2))
        best = refine(records.fewer, without_mode(records.fewer, model, mode), ROUGH)
        if not mode_quality(records, model, mode, best.chi_square).supported:
            return mode, np.reshape(kept, (-1, 2))
        kept.append(np.array(pole))
    return None, np.reshape(kept, (-1, 2))


def _is_among(pole: tuple[float, float], poles: NDArray[np.float64]) -> bool:
    """Whether a pole has stayed, within a part of its bandwidth."""
    frequency, damping = poles.T
    same = np.abs(frequency - pole[0]) < _STAYED * pole[1] * pole[0]
    return bool(np.any(same & (np.abs(np.log(damping / pole[1])) < _STAYED)))


def _distance(model: ModalModel, mode: int) -> float:
    """Distance of the nearest other mode in half-power bandwidths, those of the broader one."""
    others = np.arange(model.count) != mode
    if not np.any(others):
        return np.inf
    bandwidth = 2.0 * (model.damping * model.natural_frequency)
    apart = np.abs(model.natural_frequency - model.natural_frequency[mode])[others]
    return float(np.min(apart / np.maximum(bandwidth[others], bandwidth[mode])))


def add_missing(records: SearchRecords, model: ModalModel) -> ModalModel:
    """Add modes where the residual still has structure, as long as the data support them.

    The model is refined, and so is the one returned.
    """
    for _ in range(MOST_ADDED):
        grown = _best_addition(records, model)
        if grown is None:
            return model
        model = grown
    return model


def with_mode_count(records: SearchRecords, model: ModalModel, count: int) -> ModalModel:
    """Bring a model to a number of modes that the user wants.

    The model is refined; it has fewer modes than asked for only where no more could be placed
    inside the band.
    """
    while np.sum(inside(records.lines, model)) > count:
        lesser = [
            refine(records.fewer, without_mode(records.fewer, model, r)) for r in range(model.count)
        ]
        model = min(lesser, key=lambda m: m.chi_square)
    while np.sum(inside(records.lines, model)) < count:
        grown = [g for g, r in _additions(records.fewer, model) if inside(records.lines, g)[r]]
        if not grown:
            return model
        model = refine(records.fewer, min(grown, key=lambda m: m.chi_square))
    return model


def _astray(records: Records, model: ModalModel) -> NDArray[np.int64]:
    """Poles that are no modes: two octaves off the lines, or on them and overdamped."""
    hertz = model.natural_frequency / (2.0 * np.pi)
    lowest, highest = pole_range(records)
    off = (hertz < 1.01 * lowest) | (hertz > 0.99 * highest)
    return np.flatnonzero(off | (inside(records, model) & (model.damping > HIGHEST_DAMPING)))


def _by_contribution(records: Records, model: ModalModel) -> list[int]:
    """Modes by rising weight of their contribution."""
    weight = [
        float(np.sum(np.abs(model.mode_contribution(records, r) / records.noise) ** 2))
        for r in range(model.count)
    ]
    return [int(r) for r in np.argsort(weight)]


def _best_addition(records: SearchRecords, model: ModalModel) -> ModalModel | None:
    """The model with the one more mode that helps most, None where none is supported."""
    for grown, newcomer in _additions(records.fewer, model):
        if mode_quality(records, grown, newcomer, model.chi_square).supported:
            return refine(records.fewer, grown)
    return None


def _additions(records: Records, model: ModalModel) -> Iterator[tuple[ModalModel, int]]:
    """Refined models with one more mode, the most promising first, and which is the new one."""
    for hertz, damping in _promising(records, model):
        grown = refine_poles(
            records,
            np.append(model.natural_frequency, 2.0 * np.pi * hertz),
            np.append(model.damping, damping),
            model.terms,
            ROUGH,
        )
        if _astray(records, grown).size == 0:
            yield grown, _newcomer(model, grown)


def _promising(records: Records, model: ModalModel) -> list[tuple[float, float]]:
    """Poles (Hz, damping) to begin with: the best of each place, by falling promise."""
    low, high = float(records.frequency[0]), float(records.frequency[-1])
    hertz = model.natural_frequency / (2.0 * np.pi)
    beyond = (0.4 * low, 0.8 * low) if np.sum(hertz < low) < MOST_BEYOND else ()
    beyond += (1.1 * high, 1.6 * high) if np.sum(hertz > high) < MOST_BEYOND else ()
    trials = [[(f, damping) for damping in TRIAL_DAMPINGS] for f in _places(records, model)]
    if beyond:
        trials.append([(f, TRIAL_DAMPINGS[2]) for f in beyond])
    frequency, damping = np.array([pole for place in trials for pole in place]).T
    falls = iter(falls_with_a_pole(records, model, 2.0 * np.pi * frequency, damping).tolist())
    best = [max((next(falls), *pole) for pole in place) for place in trials]
    return [(f, d) for _, f, d in sorted(best, reverse=True)]


def _newcomer(model: ModalModel, grown: ModalModel) -> int:
    """Index of the mode in `grown` that no mode of `model` turned into."""
    left = set(range(grown.count))
    for r in range(model.count):
        near = min(
            left, key=lambda i: abs(np.log(grown.natural_frequency[i] / model.natural_frequency[r]))
        )
        left.discard(near)
    return left.pop()


def _places(records: Records, model: ModalModel) -> list[float]:
    """Frequencies at which the residual stands out most from the noise, Hz."""
    error = (records.values - model.synthesis(records)) / records.noise
    excess = np.sum(np.abs(error) ** 2, axis=1)
    frequencies: list[float] = []
    for width in (1, 5, 21):
        smooth = scipy.ndimage.uniform_filter1d(
            excess, size=min(width, excess.size), mode="nearest"
        )
        for line in np.argsort(smooth)[::-1]:
            frequency = float(records.frequency[line])
            if all(abs(frequency - p) > 0.01 * p for p in frequencies):
                frequencies.append(frequency)
                break
    return frequencies[:MOST_TRIALS]
