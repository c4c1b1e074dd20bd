"""Chatter as several lines of like size, or as one without sidebands, beside a strong cut."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.detection.spectral.chatter_lines import LOWEST_ORDER, Comb
from chatter.detection.spectral.frame_evidence import Evidence
from chatter.detection.spectral.line_of_cut import (
    CUTS_CLEARLY,
    cut_significance,
    is_limit_cycle,
    is_low_harmonic_nearby,
    line_wanders,
    may_be_of_mains,
)
from chatter.detection.spectral.spectra import RATIO_AT_REST, mean_of

Array = NDArray[np.float64]

#: sources of a speed that is stated, or measured, and which the lines do not contradict
CONFIRMED = ("tacho", "given, refined by the spectrum")
#: lines that are looked at, share of the power of the least of them
_MOST, _LEAST = 6, 0.05
#: logarithm of the power of a line above what is beside it
_STANDS_OUT = 3.0
#: least ratio to what is there at rest: more than the load adds to the lines of gears and drives
_ABOVE_REST = 30.0
#: share of the power of all lines together from which they are chatter: where the machine was heard
#: alone, and where it was not
_TOGETHER, _TOGETHER_WITHOUT_REST = 0.3, 0.5
#: frames that show whether lines last, with and without frames at rest
_FRAMES, _FRAMES_WITHOUT_REST = 5, 10
#: s that they last at the least, for noise that shakes a mode looks steady for a while; and the
#: kurtosis of their envelope at the most
_LASTS, _STEADY = 1.0, 1.3
#: share of the power off the harmonics down to which it goes on
_GOES_ON = 0.2


class LinesOfCut(NamedTuple):
    """Lines off the harmonics that chatter makes, over some frames."""

    rows: slice
    frequencies: tuple[float, ...]  # Hz, the strongest first
    share: float  # of the power, of all lines together, median over the frames
    has_sidebands: bool = False  # at the teeth


def all_lines_of_cut(evidence: Evidence, judged: NDArray[np.bool_]) -> list[LinesOfCut]:
    """Lines that only a cut that chatters makes, of runs of those frames that are to be judged.

    Nothing is found where no lines confirm the speed, or may show that of several teeth: what is
    off those harmonics may be on the true ones.
    """
    revolution = evidence.revolution
    if revolution.source not in CONFIRMED:
        return []
    large = judged & (_shares_off_harmonics(evidence) > _GOES_ON)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], large.astype(int), [0]])))
    runs = [slice(*pair) for pair in edges.reshape(-1, 2)]
    found = [lines_of_cut(evidence, rows) for rows in runs]
    return [one for one in found if one is not None]


def _shares_off_harmonics(evidence: Evidence) -> Array:
    """Share of the power of each frame that is lines off the harmonics, far above rest, (m,)."""
    frames = evidence.frames
    shares = np.zeros(frames.time.size)
    for row, (power, above) in enumerate(zip(frames.power, frames.above, strict=True)):
        comb = evidence.comb(row)
        searched = frames.frequency > LOWEST_ORDER * comb.revolution
        lines = searched & comb.off(frames.frequency) & (above > _STANDS_OUT)
        if evidence.rest is not None:
            lines &= power > RATIO_AT_REST * evidence.rest
        shares[row] = power[lines].sum() / max(float(power[searched].sum()), 1e-300)
    return shares


def lines_of_cut(evidence: Evidence, rows: slice) -> LinesOfCut | None:
    """Lines of some frames that only a cut that chatters makes; None where there are none.

    Each keeps its amplitude as a limit cycle does, and is far above what the machine has there at
    rest; where it was not heard at rest, each wanders as no electrical line does, beside harmonics
    of the teeth that are clear. Together they have to be a large share of the power.
    """
    has_rest = _without_the_lines(evidence, rows) is not None
    frames = evidence.frames
    lasts = (rows.stop - 1 - rows.start) * (frames.time[1] - frames.time[0]) + frames.length
    if lasts < _LASTS or rows.stop - rows.start < (_FRAMES if has_rest else _FRAMES_WITHOUT_REST):
        return None
    if evidence.rest is None and cut_significance(evidence) <= CUTS_CLEARLY:
        return None
    comb = evidence.comb((rows.start + rows.stop - 1) // 2)
    found = [one for one in _candidates(evidence, rows, comb) if _is_of_cut(evidence, rows, one)]
    if not found:
        return None
    shares = _shares(evidence, rows, np.array(found), comb)
    enough = _TOGETHER if has_rest else _TOGETHER_WITHOUT_REST
    if np.sum(shares >= enough) < _FRAMES:
        return None
    return LinesOfCut(rows, tuple(found), float(np.median(shares)))


def _candidates(evidence: Evidence, rows: slice, comb: Comb) -> list[float]:
    """Frequencies of the lines off the harmonics in the mean spectrum, Hz, the strongest first."""
    frequency = evidence.frames.frequency
    power, above = mean_of(evidence.frames, rows)
    searched = frequency > LOWEST_ORDER * comb.revolution
    free = searched & comb.off(frequency)
    total = float(power[searched].sum())
    left = np.where(free, power, 0.0)
    found: list[float] = []
    for _ in range(_MOST):
        index = int(np.argmax(left))
        near = np.abs(frequency - frequency[index]) < comb.half_width
        if not total > 0.0 or power[near & free].sum() < _LEAST * total:
            break
        if above[index] > _STANDS_OUT:
            found.append(float(frequency[index]))
        left[np.abs(frequency - frequency[index]) < 2.0 * comb.half_width] = 0.0
    return found


def _is_of_cut(evidence: Evidence, rows: slice, line: float) -> bool:
    if is_low_harmonic_nearby(evidence, rows, line) or not is_limit_cycle(
        evidence, rows, line, _STEADY
    ):
        return False
    other = _without_the_lines(evidence, rows)
    if other is None:
        return line_wanders(evidence, rows, line) and not may_be_of_mains(evidence, line)
    near = np.abs(evidence.frames.frequency - line) < evidence.frames.half_width
    own = float(np.median(evidence.frames.power[rows][:, near].sum(axis=1)))
    return own > _ABOVE_REST * float(other[near].sum())


def _without_the_lines(evidence: Evidence, rows: slice) -> Array | None:
    """Power spectrum at rest, or of the other frames, (b,); None where there are none."""
    if evidence.rest is not None:
        return evidence.rest
    others = ~evidence.silent
    others[rows] = False
    if others.sum() < _FRAMES:
        return None
    return np.median(evidence.frames.power[others], axis=0)


def _shares(evidence: Evidence, rows: slice, lines: Array, comb: Comb) -> Array:
    """Share of the power of each frame that lines hold, (r,)."""
    frequency, power = evidence.frames.frequency, evidence.frames.power[rows]
    searched = frequency > LOWEST_ORDER * comb.revolution
    near = np.any(np.abs(frequency[:, None] - lines) < comb.half_width, axis=1)
    total = np.maximum(power[:, searched].sum(axis=1), 1e-300)
    return power[:, near & searched & comb.off(frequency)].sum(axis=1) / total
