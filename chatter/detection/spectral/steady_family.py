"""Chatter that is a small share of the power: a steady line with its sidebands at the teeth.

A stable cut shakes the modes of the structure too, by the noise of its forces, and the teeth
modulate that noise: such a line has sidebands one tooth passing frequency apart as chatter has. Its
envelope is that of Gaussian noise, though, where that of chatter, a limit cycle, is steady. A line
of the machine is steady, and has no sidebands at the teeth. Only chatter has both, however small.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.detection.spectral.chatter_lines import (
    LOWEST_ORDER,
    Comb,
    sidebands_at_teeth,
    strongest_line,
)
from chatter.detection.spectral.frame_evidence import Evidence
from chatter.detection.spectral.line_of_cut import (
    CUTS_CLEARLY,
    STEADY,
    cut_significance,
    is_low_harmonic_nearby,
    kurtosis_around,
    may_be_of_mains,
)
from chatter.detection.spectral.several_lines import CONFIRMED, LinesOfCut
from chatter.detection.spectral.spectra import RATIO_AT_REST, mean_of

Array = NDArray[np.float64]

#: lines that are looked at, share of the power of the least of them, and its logarithm above what
#: is beside it
_MOST, _LEAST, _STANDS_OUT = 6, 0.01, 3.0
#: the same of the line in a single frame, from which it is there
_IS_THERE = 1.5
#: s, and frames, that the line lasts at the least
_LASTS, _FRAMES = 1.0, 5
#: standard deviations of the sidebands at the teeth
_SIDEBANDS = 8.0


class _Line(NamedTuple):
    frequency: float  # Hz
    share: float  # of the power


def steady_families(evidence: Evidence, judged: NDArray[np.bool_]) -> list[LinesOfCut]:
    """Chatter of a small share of the power in runs of those frames that are to be judged.

    Nothing is found where no lines confirm the speed, where another one is as good, or where the
    number of teeth is not known.
    """
    speed = evidence.revolution
    if evidence.teeth in (None, 1) or speed.source not in CONFIRMED:
        return []
    if evidence.other_speed is not None or cut_significance(evidence) <= CUTS_CLEARLY:
        return []
    edges = np.flatnonzero(np.diff(np.concatenate([[0], judged.astype(int), [0]])))
    found = [_in_frames(evidence, slice(*pair)) for pair in edges.reshape(-1, 2)]
    return [one for one in found if one is not None]


def _in_frames(evidence: Evidence, rows: slice) -> LinesOfCut | None:
    if not _last(evidence, rows):
        return None
    comb = evidence.comb((rows.start + rows.stop - 1) // 2)
    for line in _candidates(evidence, rows, comb):
        inside = _longest_run(evidence, rows, line.frequency)
        if _last(evidence, inside) and _is_of_cut(evidence, inside, line.frequency):
            return LinesOfCut(inside, (line.frequency,), line.share, has_sidebands=True)
    return None


def _last(evidence: Evidence, rows: slice) -> bool:
    """Whether frames are enough, and far enough apart from first to last."""
    if rows.stop - rows.start < _FRAMES:
        return False
    time = evidence.frames.time
    return float(time[rows.stop - 1] - time[rows.start]) + evidence.frames.length >= _LASTS


def _candidates(evidence: Evidence, rows: slice, comb: Comb) -> list[_Line]:
    """Lines off the harmonics that stand out in the mean spectrum, the strongest first."""
    frequency = evidence.frames.frequency
    power, above = mean_of(evidence.frames, rows)
    searched = frequency > LOWEST_ORDER * comb.revolution
    total = float(power[searched].sum())
    left = np.where(searched, power, 0.0)
    if evidence.rest is not None:
        left = np.where(power > RATIO_AT_REST * evidence.rest, left, 0.0)
    found: list[_Line] = []
    for _ in range(_MOST):
        line = strongest_line(left, above, frequency, comb)
        near = np.abs(frequency - line.frequency) < comb.half_width
        share = float(left[near].sum()) / max(total, 1e-300)
        if not share >= _LEAST:
            break
        if above[near].max() > _STANDS_OUT:
            found.append(_Line(line.frequency, share))
        left[np.abs(frequency - line.frequency) < 2.0 * comb.half_width] = 0.0
    return found


def _longest_run(evidence: Evidence, rows: slice, line: float) -> slice:
    """Longest run of the frames in which a line is there."""
    frames = evidence.frames
    near = np.abs(frames.frequency - line) < frames.half_width
    there = frames.above[rows][:, near].max(axis=1) > _IS_THERE
    edges = np.flatnonzero(np.diff(np.concatenate([[0], there.astype(int), [0]])))
    runs = edges.reshape(-1, 2)
    if not len(runs):
        return slice(rows.start, rows.start)
    first, last = max(runs, key=lambda run: run[1] - run[0])
    return slice(rows.start + int(first), rows.start + int(last))


def _is_of_cut(evidence: Evidence, rows: slice, line: float) -> bool:
    """Whether a line of some frames is steady, and has sidebands at the teeth."""
    frames = evidence.frames
    comb = evidence.comb((rows.start + rows.stop - 1) // 2)
    _, above = mean_of(frames, rows)
    if sidebands_at_teeth(above, frames.frequency, line, comb) < _SIDEBANDS:
        return False
    if may_be_of_mains(evidence, line) or is_low_harmonic_nearby(evidence, rows, line):
        return False
    return kurtosis_around(evidence, rows, line) < STEADY
