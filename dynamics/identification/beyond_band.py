"""Modes that stand for what lies beyond the measured band: residual compliance and residual mass.

A fit describes the modes below and above its lines by modes of its own out there and by residual
terms, powers of s. A structure that is stepped in time, and a static deflection, need them as
modes. What is not known of them is chosen so that it acts least: a compliance whose frequency the
data do not tell is quasi-static, without a resonance that could chatter; a mass line gets the
stiffest spring that the lines allow (Ewins 2000, section 4.5, on residuals).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dynamics.identification.real_modes import RealModel, ToolPointRecords
from dynamics.identification.report import covariance_of, direction_of
from dynamics.identification.residues import (
    COMPLIANCE,
    CURVATURE_TERMS,
    MASS,
    mode_shapes_in_frequency,
)
from dynamics.identification.result import BeyondBand
from dynamics.modal.modes import Band, Mode

#: power of s of the terms that follow the mass line and the compliance
_NEXT_OF_MASS, _NEXT_OF_COMPLIANCE = CURVATURE_TERMS
#: a compliance without a frequency of its own: multiple of the end of the band, and damping with
#: which the real part stays the same up to the fourth power of the frequency
_QUASI_STATIC, _NO_RESONANCE = 4.0, 0.5
#: damping of modes beyond the band where the data do not tell it
_DAMPING = 0.05
#: relative standard deviation of a damping above which the data do not tell it
_UNCERTAIN = 0.5
#: distance of a mode that stands for residual terms from the end of the band, as a factor
_NEAREST, _FURTHEST = 1.2, 10.0
#: deviation from a mass line at the lower end of the band, over the peak, and nearest frequency
_DEVIATION, _NEAREST_OF_MASS = 0.005, 1.5
#: damping of a mode that stands for a mass line
_DAMPING_OF_MASS = 0.1
#: eigenvalue of a residual matrix, over the largest compliance or mobility, that counts as none
_NONE = 1e-6


class _Oscillators(NamedTuple):
    """Modes by frequency, rad/s, damping and vector at the tool point for unit modal mass."""

    natural: NDArray[np.float64]  # (n,)
    damping: NDArray[np.float64]  # (n,)
    vectors: NDArray[np.float64]  # (n, axes), 1/sqrt(kg)

    def compliance(self) -> NDArray[np.float64]:
        """Static compliance (axes, axes), m/N."""
        return _weighted(self.vectors, self.natural**-2.0)

    def chosen(self, which: NDArray[np.bool_]) -> "_Oscillators":
        return _Oscillators(*(part[which] for part in self))


def modes_beyond(tool: ToolPointRecords, model: RealModel) -> BeyondBand:
    """Modes below and above the lines of a fit at the tool point.

    Modes of the fit itself are taken as they are, with 5 % damping where the data do not tell it,
    and residual terms as up to three modes each side: the compliance and the mass line exactly,
    their frequency by the next term where there is one. What no passive structure has, negative
    compliance or mass, is left out, and shows in the misfit.
    """
    lowest, highest = 2.0 * np.pi * tool.records.frequency[[0, -1]]
    fitted = _Oscillators(model.natural_frequency, _known_damping(model), model.vectors)
    below, above = fitted.natural < lowest, fitted.natural > highest
    inside = fitted.chosen(~(below | above))
    upper = _above(tool, model, fitted.chosen(above), highest)
    lower = _below(tool, model, fitted.chosen(below), inside, lowest)
    modes = (*_modes(tool, lower, "below"), *_modes(tool, upper, "above"))
    return BeyondBand(modes, _misfit(tool, model, (inside, lower, upper)))


def _known_damping(model: RealModel) -> NDArray[np.float64]:
    """Damping of the modes, a usual one where it is uncertain."""
    deviation = np.sqrt(np.maximum(np.diag(covariance_of(model.normal)), 0.0))
    known = deviation[model.count : 2 * model.count] < _UNCERTAIN
    return np.where(known, model.damping, np.maximum(model.damping, _DAMPING))


def _weighted(vectors: NDArray[np.float64], weight: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sum of u u^T with weights, (axes, axes)."""
    return (vectors.T * weight) @ vectors


def _term(tool: ToolPointRecords, model: RealModel, power: int) -> NDArray[np.float64]:
    """Symmetric matrix (axes, axes) of a residual term; a cross term that is not measured is 0."""
    axes = len(tool.axes)
    total, count = np.zeros((axes, axes)), np.zeros((axes, axes))
    if power not in model.terms:
        return total
    from_end = model.terms.index(power) - len(model.terms)
    for k, pair in enumerate(tool.pairs):
        if pair is not None:
            for i, j in {pair, pair[::-1]}:
                total[i, j] += model.free[k][from_end]
                count[i, j] += 1
    total /= np.maximum(count, 1)
    for i in np.flatnonzero(np.diag(count) == 0):
        # that of rank one with the other axes, as of the mode vectors
        others = [j for j in range(axes) if count[i, j] and total[j, j] > 0.0]
        total[i, i] = max((total[i, j] ** 2 / total[j, j] for j in others), default=0.0)
    return total


def _is_passive(matrix: NDArray[np.float64]) -> bool:
    values = np.linalg.eigvalsh(matrix)
    return bool(values[0] >= -_NONE * max(abs(values[-1]), 1e-300))


def _above(
    tool: ToolPointRecords, model: RealModel, own: _Oscillators, highest: float
) -> _Oscillators:
    """Modes above the band: those of the fit, and one each for the residual compliances."""
    compliance, curvature = _term(tool, model, COMPLIANCE), -_term(tool, model, _NEXT_OF_COMPLIANCE)
    if not _is_passive(compliance):
        # a negative compliance that makes up for a mode of the fit
        compliance = compliance + own.compliance()
        curvature = curvature + _weighted(own.vectors, own.natural**-4.0)
        own = own.chosen(np.zeros(own.natural.size, dtype=bool))
    scale, vectors, ratio = _principal(compliance, curvature)
    slow = ratio > (_QUASI_STATIC * highest) ** -2.0
    natural = np.full(ratio.size, _QUASI_STATIC * highest)
    natural[slow] = np.maximum(ratio[slow] ** -0.5, _NEAREST * highest)
    damping = np.where(slow, _DAMPING, _NO_RESONANCE)
    return _joined(own, _Oscillators(natural, damping, vectors * (scale * natural)[:, None]))


def _below(
    tool: ToolPointRecords, model: RealModel, own: _Oscillators, inside: _Oscillators, lowest: float
) -> _Oscillators:
    """Modes below the band: those of the fit, and one each for the residual masses that act."""
    mobility, stiffening = _term(tool, model, MASS), -_term(tool, model, _NEXT_OF_MASS)
    if not _is_passive(mobility):
        mobility = mobility + _weighted(own.vectors, np.ones(own.natural.size))
        stiffening = stiffening + _weighted(own.vectors, own.natural**2)
        own = own.chosen(np.zeros(own.natural.size, dtype=bool))
    scale, vectors, ratio = _principal(mobility, stiffening)
    # the peak along each direction: the stiffest spring that the lines do not contradict
    peaks = (inside.vectors @ vectors.T) ** 2 / (2.0 * inside.damping * inside.natural**2)[:, None]
    at_end = scale**2 / lowest**2
    share = _DEVIATION * (np.max(peaks, axis=0, initial=0.0) + at_end) / at_end
    # less than the deviation that is allowed: noise, whose static deflection would be made up
    felt = share < 1.0
    scale, vectors, ratio, share = scale[felt], vectors[felt], ratio[felt], share[felt]
    stiffest = lowest * np.sqrt(share / (1.0 + share))
    told = ratio > 0.0
    natural = np.where(told, np.sqrt(np.maximum(ratio, 0.0)), stiffest)
    nearest = np.where(told, _NEAREST, _NEAREST_OF_MASS)
    natural = np.clip(natural, lowest / _FURTHEST, lowest / nearest)
    damping = np.full(natural.size, _DAMPING_OF_MASS)
    return _joined(own, _Oscillators(natural, damping, vectors * scale[:, None]))


def _principal(
    matrix: NDArray[np.float64], following: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Sum of s^2 v v^T that is a matrix where it is positive, and the next matrix over it.

    Scales s (n,), unit vectors v (n, axes) and the ratios (n,) by which the following matrix is the
    sum of ratio s^2 v v^T as far as it acts in the same directions.
    """
    values, vectors = np.linalg.eigh(matrix)
    kept = values > _NONE * max(float(np.abs(values).max(initial=0.0)), 1e-300)
    root = vectors[:, kept] * np.sqrt(values[kept])
    inverse = vectors[:, kept] / np.sqrt(values[kept])
    ratio, turned = np.linalg.eigh(inverse.T @ following @ inverse)
    rows = (root @ turned).T
    scale = np.linalg.norm(rows, axis=1)
    return scale, rows / scale[:, None], ratio


def _joined(first: _Oscillators, second: _Oscillators) -> _Oscillators:
    return _Oscillators(*(np.concatenate(parts) for parts in zip(first, second, strict=True)))


def _modes(tool: ToolPointRecords, table: _Oscillators, band: Band) -> list[Mode]:
    return [
        Mode(
            natural / (2.0 * np.pi),
            damping,
            1.0 / float(vector @ vector),
            direction_of(tool.axes, vector),
            band=band,
        )
        for natural, damping, vector in zip(
            table.natural.tolist(), table.damping.tolist(), table.vectors, strict=True
        )
        if np.any(vector)
    ]


def _misfit(tool: ToolPointRecords, model: RealModel, tables: tuple[_Oscillators, ...]) -> float:
    """Largest deviation of modes from the fit on its lines, over the largest receptance."""
    s = tool.records.laplace
    largest, apart = 0.0, 0.0
    elastic = mode_shapes_in_frequency(s, model.natural_frequency, model.damping, 0).unit
    units = [mode_shapes_in_frequency(s, table.natural, table.damping, 0).unit for table in tables]
    for k, pair in enumerate(tool.pairs):
        if pair is None:
            continue
        i, j = pair
        fitted = elastic @ (model.vectors[:, i] * model.vectors[:, j])
        rest = zip(model.terms, model.free[k][model.free[k].size - len(model.terms) :], strict=True)
        for power, coefficient in rest:
            if power in (MASS, COMPLIANCE, *CURVATURE_TERMS):
                fitted = fitted + coefficient * s**power
        found = sum(
            unit @ (table.vectors[:, i] * table.vectors[:, j])
            for unit, table in zip(units, tables, strict=True)
        )
        largest = max(largest, float(np.abs(fitted).max()))
        apart = max(apart, float(np.abs(found - fitted).max()))
    return apart / largest if largest else 0.0
