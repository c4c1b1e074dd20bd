"""Long FRFs on fewer lines that say the same of every mode.

Where a block of lines follows a polynomial of degree P - 1 within its noise, its least-squares
values at the P zeros of the next orthogonal polynomial stand for it: they are uncorrelated, their
variances are the noise over the Gauss weights (Golub and Welsch 1969), and what they leave out is
the same for every model that is as smooth. Blocks are joined as long as the joined polynomial costs
no more than noise would; near a resonance they stay a fraction of its bandwidth.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dynamics.identification.residues import Records

#: lines below which nothing is gained
LEAST_CONDENSED = 4000
#: values that stand for a block, lines of the smallest and of the largest block
_VALUES, _SMALLEST, _LARGEST = 6, 32, 1024
#: standard deviations that a joined polynomial may cost beyond its share of the noise
_MOST_COST = 3.0
#: ratio of the noise of the lines of a block, at the most: they count alike
_MOST_UNEVEN = 1.5
#: variance over that of the noise at least and at most: the noise is an estimate
_LEAST_SCATTER, _MOST_SCATTER = 0.25, 1.2


@dataclass(frozen=True)
class SearchRecords:
    """Lines on which modes are looked for."""

    lines: Records  # all of them, by which a mode is judged
    fewer: Records  # condensed, to which models are fitted

    @classmethod
    def of(cls, records: Records) -> SearchRecords:
        """Condense records where they are long."""
        return cls(records, condensed(records))


class _Blocks(NamedTuple):
    """Values that stand for adjoining blocks of as many lines each."""

    frequency: NDArray[np.float64]  # (b, P), Hz
    values: NDArray[np.complex128]  # (b, P, k)
    noise: NDArray[np.float64]  # (b, P, k)
    remainder: NDArray[np.float64]  # (b, k), sum of squares over the noise that they do not hold


def condensed(records: Records) -> Records:
    """Records on fewer lines, with the chi-square of every model that is smooth within the blocks.

    Records of few lines come back as they are.
    """
    lines = _SMALLEST
    if records.frequency.size < LEAST_CONDENSED:
        return records
    halves = _blocks(records, lines // 2)
    joined = _blocks(records, lines)
    sound = _joinable(records, halves, joined, lines)
    single = np.ones(records.frequency.size, dtype=bool)
    single[: sound.size * lines] = ~np.repeat(sound, lines)
    kept = []
    while lines < _LARGEST and np.any(sound):
        lines *= 2
        larger = _blocks(records, lines)
        both = np.all(sound[: 2 * larger.frequency.shape[0]].reshape(-1, 2), axis=1)
        both &= _joinable(records, joined, larger, lines)
        sound[: 2 * both.size] &= ~np.repeat(both, 2)
        kept.append(_chosen(joined, sound))
        joined, sound = larger, both
    kept.append(_chosen(joined, sound))
    return _put_together(records.lines(single), kept)


def _blocks(records: Records, lines: int) -> _Blocks:
    """Gauss values of all blocks of some lines; lines beyond the last whole block are left out."""
    count = records.frequency.size // lines
    frequency = records.frequency[: count * lines].reshape(count, lines)
    values = records.values[: count * lines].reshape(count, lines, -1)
    noise = records.noise[: count * lines].reshape(count, lines, -1)
    middle = 0.5 * (frequency[:, :1] + frequency[:, -1:])
    half = 0.5 * (frequency[:, -1:] - frequency[:, :1])
    nodes, weight, basis = _gauss((frequency - middle) / half)
    projected = basis.transpose(0, 2, 1) @ values
    level = 1.0 / np.sqrt(np.mean(noise**-2.0, axis=1))
    error = np.sum(np.abs(values - basis @ projected) ** 2, axis=1)
    return _Blocks(
        middle + half * nodes,
        projected / weight[:, :, None],
        level[:, None, :] / weight[:, :, None],
        error / level**2,
    )


def _gauss(
    x: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Gauss rule of the lines x (b, n) of each block, by Lanczos steps.

    Nodes (b, P), square roots of their weights (b, P), which sum to n, and the orthonormal
    polynomials (b, n, P) that are zero at all nodes but one.
    """
    count, lines = x.shape
    basis = np.zeros((count, lines, _VALUES))
    jacobi = np.zeros((count, _VALUES, _VALUES))
    basis[:, :, 0] = 1.0 / np.sqrt(lines)
    for k in range(_VALUES):
        vector = x * basis[:, :, k]
        jacobi[:, k, k] = np.sum(vector * basis[:, :, k], axis=1)
        if k + 1 == _VALUES:
            break
        for _ in range(2):  # the second pass restores what cancellation lost
            along = basis[:, :, : k + 1].transpose(0, 2, 1) @ vector[:, :, None]
            vector = vector - (basis[:, :, : k + 1] @ along)[:, :, 0]
        size = np.linalg.norm(vector, axis=1)
        jacobi[:, k, k + 1] = jacobi[:, k + 1, k] = size
        basis[:, :, k + 1] = vector / size[:, None]
    nodes, turn = np.linalg.eigh(jacobi)
    turn = turn * np.where(turn[:, :1] < 0.0, -1.0, 1.0)
    return nodes, turn[:, 0] * np.sqrt(lines), basis @ turn


def _joinable(records: Records, halves: _Blocks, joined: _Blocks, lines: int) -> NDArray[np.bool_]:
    """Blocks whose two halves one polynomial describes as well, in every FRF."""
    count = joined.frequency.shape[0]
    apart = halves.remainder[: 2 * count].reshape(count, 2, -1).sum(axis=1)
    freedom = lines - 2 * _VALUES
    scatter = np.maximum(apart / freedom, _LEAST_SCATTER)
    # more than noise is a resonance between the lines, which no block of this size may hold
    smooth = scatter < _MOST_SCATTER + _MOST_COST / np.sqrt(freedom)
    cost = (joined.remainder - apart) / scatter  # of noise alone: P, and deviates by its root
    noise = records.noise[: count * lines].reshape(count, lines, -1)
    even = np.max(noise, axis=1) < _MOST_UNEVEN * np.min(noise, axis=1)
    cheap = cost < _VALUES + _MOST_COST * np.sqrt(_VALUES)
    return np.all(smooth & cheap & even, axis=1)


def _chosen(blocks: _Blocks, which: NDArray[np.bool_]) -> _Blocks:
    return _Blocks(*(part[: which.size][which] for part in blocks))


def _put_together(single: Records, kept: list[_Blocks]) -> Records:
    """Lines that stand for themselves and the values of blocks, by rising frequency."""
    columns = single.count
    frequency = np.concatenate([single.frequency, *(b.frequency.ravel() for b in kept)])
    values = np.concatenate([single.values, *(b.values.reshape(-1, columns) for b in kept)])
    noise = np.concatenate([single.noise, *(b.noise.reshape(-1, columns) for b in kept)])
    order = np.argsort(frequency)
    return replace(
        single,
        frequency=frequency[order],
        values=values[order],
        noise=noise[order],
        remainder=single.remainder + sum(float(np.sum(b.remainder)) for b in kept),
    )
