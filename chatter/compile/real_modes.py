"""Real modes of a linearised machine, fitted to its receptance at the tool point.

The receptance is computed, not measured: there is no noise to be told from modes, and one mode
after the other is added where it takes most off the misfit until none is left that matters. Loops
and dampers make the motions of a machine complex; real modes that are close to one another make up
for that as far as they can.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from chatter.compile.least_squares_modes import ModeBounds, WantedReceptance, best_further, refined
from dynamics.modal.modes import Mode, receptance_matrix

#: misfit, over the receptance at the same line, that is left; what lies below the floor, a share
#: of the largest receptance, counts less
_LEFT, _FLOOR = 2e-3, 0.3
#: weight of the power that a loop feeds in: no damped mode has it, and none is to be bent for it
_FED_IN = 3.0
_MOST_FURTHER = 8
_EVEN_LINES = 150
_FIRST_DAMPING = 0.05
#: damping ratios, least and largest, of modes at first, of further ones and of those above the
#: band; the methods take modes that vibrate. Lines lie dense around the first ones alone: what is
#: narrower than their distance elsewhere, or above them all, would be a resonance that nobody sees
_DAMPINGS, _OF_FURTHER, _OF_ABOVE = (1e-4, 0.95), (0.025, 0.95), (0.3, 0.95)
#: least natural frequency, over the first line
_LOWEST = 0.5
#: damping ratios tried of further modes, every so many lines, and frequencies below the band, over
#: its first line
_DAMPINGS_TRIED, _LINES_TRIED = (0.03, 0.1, 0.3, 0.9), 4
_BELOW_TRIED = (0.55, 0.7, 0.85)
#: modes that stand for all above the band lie at this multiple of its end
_ABOVE = 2.5
#: share of the sum of squares that a further mode has to take off; so many in succession that do
#: not end the search
_GAIN, _PATIENCE = 0.03, 2
#: iterations and least gain while modes are added, and at the end
_COARSE, _FINE = (60, 1e-3), (200, 1e-5)


def real_modes(
    frequency: NDArray[np.float64], receptance: NDArray[np.complex128], start: Sequence[Mode]
) -> tuple[Mode, ...]:
    """Fit real modes to a receptance.

    Of a receptance (m, 3, 3), m/N, at frequencies (m,), Hz, dense around the modes, the symmetric
    part is fitted, from a first guess. The last modes may lie above the band and stand for what is
    there.
    """
    values = 0.5 * (receptance + receptance.transpose(0, 2, 1))
    omega = 2.0 * np.pi * np.asarray(frequency, dtype=np.float64)
    wanted = WantedReceptance(omega, values, _weight(values))
    band, above = (_LOWEST * omega[0], omega[-1]), (omega[-1], 2.0 * _ABOVE * omega[-1])
    table = np.vstack([*_beyond(omega[-1], values[-1]), *(_row(mode) for mode in start)])
    bounds = ModeBounds.of(3, above, _OF_ABOVE).with_further(
        ModeBounds.of(len(start), band, _DAMPINGS)
    )
    further = ModeBounds.of(1, band, _OF_FURTHER)
    table, bounds = _with_further(table, bounds, further, wanted)
    table, _ = refined(table, bounds, wanted, *_FINE)
    # those that stand for what is above the band come last
    table = np.roll(table, -3, axis=0)
    return tuple(_mode(row) for row in table if np.linalg.norm(row[2:]) > 0.0)


def _weight(values: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Weight (m,) of each line."""
    size = np.linalg.norm(values, axis=(1, 2))
    fed_in = np.maximum(-np.linalg.eigvalsh(-values.imag)[:, 0], 0.0)
    return 1.0 / (size + _FLOOR * size.max() + _FED_IN * fed_in)


def _with_further(
    table: NDArray[np.float64], bounds: ModeBounds, of_further: ModeBounds, wanted: WantedReceptance
) -> tuple[NDArray[np.float64], ModeBounds]:
    """Table with the further modes that matter, and its bounds."""
    table, misfit = refined(table, bounds, wanted, *_COARSE)
    best, least, in_vain = (table, bounds), misfit, 0
    candidates = _candidates(wanted.omega)
    for _ in range(_MOST_FURTHER):
        residual = wanted.residual(table)
        if np.max(np.linalg.norm(residual, axis=(1, 2)) * wanted.weight) < _LEFT:
            return table, bounds
        further = best_further(wanted, residual, candidates)
        bounds = bounds.with_further(of_further)
        table, misfit = refined(np.vstack([table, further]), bounds, wanted, *_COARSE)
        if misfit < (1.0 - _GAIN) ** (in_vain + 1) * least:
            best, least, in_vain = (table, bounds), misfit, 0
            continue
        in_vain += 1
        if in_vain == _PATIENCE:
            break
    return best


def _candidates(omega: NDArray[np.float64]) -> NDArray[np.float64]:
    """Natural frequencies and damping ratios (k, 2) of a further mode."""
    natural = np.concatenate([np.array(_BELOW_TRIED) * omega[0], omega[::_LINES_TRIED]])
    grid = np.meshgrid(natural, _DAMPINGS_TRIED, indexing="ij")
    return np.stack(grid, axis=-1).reshape(-1, 2)


def lines_around(modes: Sequence[Mode], lowest: float, highest: float) -> NDArray[np.float64]:
    """Lines (m,) over a band in Hz, dense around modes."""
    beside = np.concatenate([-np.geomspace(8.0, 0.1, 8), np.geomspace(0.1, 8.0, 8)])
    around = [mode.frequency * (1.0 + max(mode.damping, 1e-3) * beside) for mode in modes]
    # the receptance of an undamped mode is infinite at its own frequency
    around.append([mode.frequency for mode in modes if mode.damping > _DAMPINGS[0]])
    even = np.linspace(lowest, highest, _EVEN_LINES)
    lines = np.unique(np.concatenate([even, np.geomspace(lowest, highest, _EVEN_LINES), *around]))
    return lines[(lines >= lowest) & (lines <= highest)]


def largest_misfit(
    modes: Sequence[Mode], frequency: NDArray[np.float64], receptance: NDArray[np.complex128]
) -> float:
    """Largest deviation of modes from a receptance, over its largest value."""
    apart = receptance_matrix(modes, frequency) - receptance
    return float(np.abs(apart).max() / np.abs(receptance).max())


def _row(mode: Mode) -> NDArray[np.float64]:
    """Logarithms of natural frequency and damping ratio, and the mass-normalised direction."""
    shape = np.array(mode.direction) / math.sqrt(mode.mass)
    return np.array([math.log(mode.natural_frequency), math.log(mode.damping), *shape])


def _mode(row: NDArray[np.float64]) -> Mode:
    size = float(np.linalg.norm(row[2:]))
    direction = tuple((row[2:] / size).tolist())
    frequency = math.exp(row[0]) / (2.0 * math.pi)
    return Mode(frequency, math.exp(row[1]), size**-2, direction)


def _beyond(highest: float, last: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Modes along x, y and z above the band, (3, 5)."""
    natural = _ABOVE * highest
    size = natural * np.sqrt(0.1 * np.abs(np.diag(last)) + 1e-3 * np.abs(last).max())
    rows = np.zeros((3, 5))
    rows[:, 0], rows[:, 1] = math.log(natural), math.log(_FIRST_DAMPING)
    rows[:, 2:] = np.diag(size)
    return rows
