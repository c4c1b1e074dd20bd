"""Real modes of a linearised machine, fitted to its receptance at the tool point.

The receptance is computed, not measured: there is no noise to be told from modes, and one mode
after the other is added where the misfit is largest until none is left that matters. Loops and
dampers make the motions of a machine complex; real modes that are close to one another make up
for that as far as they can.
"""

import math
from collections.abc import Sequence

import numpy as np
import scipy
from numpy.typing import NDArray

from dynamics.modal.modes import Mode, receptance_matrix

#: misfit, over the receptance at the same line, that is left; what lies below the floor, a share
#: of the largest receptance, counts less
_LEFT, _FLOOR = 2e-3, 0.3
_MOST_FURTHER = 6
_EVEN_LINES = 150
_FIRST_DAMPING = 0.05
#: damping ratios, least and largest; the methods take modes that vibrate
_DAMPINGS = 1e-4, 0.95
#: modes that stand for all above the band lie at this multiple of its end
_ABOVE = 2.5
#: improvement of the sum of squares by a further mode below which it was the last
_NO_BETTER = 0.9
#: elements of a symmetric matrix, and their weights in its norm
_FIRST, _SECOND = np.triu_indices(3)
_WEIGHT = np.where(_FIRST == _SECOND, 1.0, math.sqrt(2.0))


def real_modes(
    frequency: NDArray[np.float64], receptance: NDArray[np.complex128], start: Sequence[Mode]
) -> tuple[Mode, ...]:
    """Fit real modes to a receptance.

    Of a receptance (m, 3, 3), m/N, at frequencies (m,), Hz, dense around the modes, the symmetric
    part is fitted, from a first guess. The last modes may lie above the band and stand for what is
    there.
    """
    omega = 2.0 * np.pi * np.asarray(frequency, dtype=np.float64)
    wanted = 0.5 * (receptance + receptance.transpose(0, 2, 1))
    size = np.linalg.norm(wanted, axis=(1, 2))
    weight = 1.0 / (size + _FLOOR * size.max())
    table = np.vstack([*(_row(mode) for mode in start), *_beyond(omega[-1], wanted[-1])])
    table, misfit = _refined(table, omega, wanted, weight)
    for _ in range(_MOST_FURTHER):
        residual = wanted - _response(table, omega)
        error = np.linalg.norm(residual, axis=(1, 2)) * weight
        worst = int(np.argmax(error))
        if error[worst] < _LEFT:
            break
        further, better = _refined(
            np.vstack([table, _guess(omega[worst], residual[worst])]), omega, wanted, weight
        )
        if better > _NO_BETTER * misfit:
            break
        table, misfit = further, better
    return tuple(_mode(row) for row in table if np.linalg.norm(row[2:]) > 0.0)


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


def _guess(omega: float, residual: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Mode at a line, along what is missing most there."""
    values, vectors = np.linalg.eigh(-residual.imag)
    size = omega * math.sqrt(2.0 * _FIRST_DAMPING * max(values[-1], 1e-3 * abs(values).max()))
    return np.array([math.log(omega), math.log(_FIRST_DAMPING), *(size * vectors[:, -1])])


def _oscillators(table: NDArray[np.float64], omega: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Response (m, n) of each oscillator of unit mass."""
    natural, damping = np.exp(table[:, 0]), np.exp(table[:, 1])
    line = omega[:, None]
    return 1.0 / (natural**2 - line**2 + 2j * damping * natural * line)


def _response(table: NDArray[np.float64], omega: NDArray[np.float64]) -> NDArray[np.complex128]:
    shape = table[:, 2:]
    return np.einsum("mn,ni,nj->mij", _oscillators(table, omega), shape, shape)


def _refined(
    table: NDArray[np.float64],
    omega: NDArray[np.float64],
    wanted: NDArray[np.complex128],
    weight: NDArray[np.float64],
) -> tuple[NDArray[np.float64], float]:
    """Table of modes of the least weighted squares near a first one, and that sum."""
    # directions in the units of a mode that makes up all of the largest receptance
    unit = np.exp(table[:, 0]) * math.sqrt(np.abs(wanted).max())
    scale = np.column_stack([np.ones_like(unit), np.ones_like(unit), *[unit * 0.1] * 3])
    aim = _flat(wanted, weight)

    def misfit(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return _flat(_response(x.reshape(-1, 5) * scale, omega), weight) - aim

    def slope(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return _slopes(x.reshape(-1, 5) * scale, omega, weight) * scale.ravel()

    least, most = np.full(table.shape, -np.inf), np.full(table.shape, np.inf)
    least[:, 0], most[:, 0] = math.log(0.5 * omega[0]), math.log(2.0 * _ABOVE * omega[-1])
    least[:, 1], most[:, 1] = map(math.log, _DAMPINGS)
    bounds = ((least / scale).ravel(), (most / scale).ravel())
    inside = np.clip((table / scale).ravel(), bounds[0] + 1e-9, bounds[1] - 1e-9)
    found = scipy.optimize.least_squares(
        misfit, inside, slope, bounds, max_nfev=60, xtol=1e-6, ftol=1e-5
    )
    return found.x.reshape(-1, 5) * scale, 2.0 * float(found.cost)


def _flat(values: NDArray[np.complex128], weight: NDArray[np.float64]) -> NDArray[np.float64]:
    """Independent elements as reals, weighted."""
    elements = values[:, _FIRST, _SECOND] * (weight[:, None] * _WEIGHT)
    return np.concatenate([elements.real.ravel(), elements.imag.ravel()])


def _slopes(
    table: NDArray[np.float64], omega: NDArray[np.float64], weight: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Slopes of the flat response by all entries of a table."""
    oscillators = _oscillators(table, omega)
    natural, damping = np.exp(table[:, 0]), np.exp(table[:, 1])
    # by the logarithms of natural frequency and damping ratio
    loss = 2j * damping * natural * omega[:, None]
    by_frequency = -(oscillators**2) * (2.0 * natural**2 + loss)
    by_damping = -(oscillators**2) * loss
    columns = []
    for k, row in enumerate(table):
        shape = row[2:]
        pair = shape[_FIRST] * shape[_SECOND]
        ways = [by_frequency[:, k, None] * pair, by_damping[:, k, None] * pair]
        for axis in range(3):
            unit = np.eye(3)[axis]
            ways.append(
                oscillators[:, k, None]
                * (unit[_FIRST] * shape[_SECOND] + shape[_FIRST] * unit[_SECOND])
            )
        for way in ways:
            scaled = way * (weight[:, None] * _WEIGHT)
            columns.append(np.concatenate([scaled.real.ravel(), scaled.imag.ravel()]))
    return np.array(columns).T
