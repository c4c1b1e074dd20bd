"""Periods in a variable: lines of the residual that lie at the same wavelength in every run."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: draws of periods near by against which a share is held, and their share that may reach it
_DRAWS, _SIGNIFICANCE = 4000, 5e-4
#: factor in wavelength within which they are drawn, and by which a line stands out of them
_NEAR, _OUTSTANDING = 1.6, 4.0
#: periods over the range of the variable at least
_FEWEST_PERIODS = 3.0
#: and over that of a run that has a say
_LEAST_TURNS = 1.5
#: distance from a pattern that a run has by itself, in lines that its length can tell apart
_ASIDE = 1.5
#: periods examined within one over the range of the variable
_FINENESS = 4
#: the most wavelengths examined, and the most samples a run
_MOST, _MOST_SAMPLES = 900, 20000
_LEAST_SHARE = 0.01


class Period(NamedTuple):
    """A period in a variable, with phase and size free in every run."""

    length: float  # SI unit of the variable
    #: of the sum of squares over the noise; the period of a run is read from the others
    share: float
    significant: bool  # runs agree on it by more than scatter
    lengths: Array  # (m,)
    shares: Array  # (m,), over the period


def period_in(
    normalised: Sequence[Array],
    weight: Sequence[Array],
    variable: Sequence[Array],
    shortest: float,
    own: Sequence[float] | None = None,
    seed: int = 0,
) -> Period | None:
    """Period of a variable on which runs agree.

    Residual over the noise, its weight and the variable, (n,) each, one a run. None is looked for
    below `shortest`; `own` is the period that every run has by itself (feed per revolution), which
    is left out with its parts. None where the variable spans too few of the shortest periods.
    """
    longest = max(float(np.ptp(v)) for v in variable)
    if longest < 2.0 * _FEWEST_PERIODS * shortest or len(normalised) < 2:
        return None
    count = int(min(_MOST, _FINENESS * longest / shortest))
    wavenumber = np.linspace(_FEWEST_PERIODS / longest, 1.0 / shortest, count)
    total = sum(float(s @ s) for s in normalised)
    lines = np.array(
        [_lines(s, w, v, wavenumber) for s, w, v in zip(normalised, weight, variable, strict=True)]
    )
    for line, values, length in zip(lines, variable, own or (), strict=False):
        turns = wavenumber * length
        aside = np.abs(turns - np.round(turns)) / length * float(np.ptp(values))
        line[(aside < _ASIDE) & (np.round(turns) > 0)] = 0.0
    together = lines.sum(axis=0)
    chosen = np.argmax(together - lines, axis=1)  # of every run, by the others
    explained = float(lines[np.arange(len(lines)), chosen].sum())
    rng = np.random.default_rng(seed)
    near = wavenumber[chosen] * _NEAR ** rng.uniform(-1.0, 1.0, size=(_DRAWS, len(lines)))
    drawn = np.clip(np.searchsorted(wavenumber, near), 0, count - 1)
    by_chance = lines[np.arange(len(lines)), drawn].sum(axis=1)
    share = explained / max(total, 1e-300)
    rare = float(np.mean(by_chance >= explained)) <= _SIGNIFICANCE
    rare &= explained > _OUTSTANDING * float(np.median(by_chance))
    # runs agree where most of them choose the same line
    best = int(np.argmax(together))
    agreed = float(np.mean(np.abs(chosen - best) <= _FINENESS // 2)) > 0.5
    return Period(
        float(1.0 / wavenumber[best]),
        share,
        rare and agreed and share > _LEAST_SHARE,
        1.0 / wavenumber,
        together / max(total, 1e-300),
    )


def _lines(normalised: Array, weight: Array, variable: Array, wavenumber: Array) -> Array:
    """Sum of squares that a line of every wavenumber takes from one run, less that of noise."""
    stride = max(1, normalised.size // _MOST_SAMPLES)
    normalised, weight, variable = normalised[::stride], weight[::stride], variable[::stride]
    constant = (normalised @ weight) / max(float(weight @ weight), 1e-300)
    normalised = normalised - constant * weight
    taken, reach = np.empty(wavenumber.size), float(np.ptp(variable))
    # every wavenumber turns the samples on by the same angle
    wave = weight * np.exp(2j * np.pi * wavenumber[0] * variable)
    turned = np.exp(2j * np.pi * (wavenumber[1] - wavenumber[0]) * variable)
    for index, k in enumerate(wavenumber):
        if index:
            wave = wave * turned
        cosine, sine = wave.real, wave.imag
        a, b, c = cosine @ cosine, cosine @ sine, sine @ sine
        if k * reach < _LEAST_TURNS:
            taken[index] = 2.0
            continue
        p, q = cosine @ normalised, sine @ normalised
        determinant = a * c - b * b
        if determinant > 1e-9 * a * c:
            taken[index] = (c * p * p - 2.0 * b * p * q + a * q * q) / determinant
        else:
            taken[index] = 0.0
    return stride * (taken - 2.0)
