"""Delay between the force and response channels, found before any residue is fitted.

A delay of the measuring chain turns the residues of real modes in proportion to their frequency
and leaves the poles alone. With known poles a fit of real residues is linear at each delay; the
delay of least misfit is that of the chain.
"""

from dataclasses import replace

import numpy as np
import scipy
from numpy.typing import NDArray

from dynamics.identification.discrepancy import effective_samples
from dynamics.identification.refinement import ModalModel
from dynamics.identification.residues import (
    COMPLIANCE,
    MASS,
    Records,
    as_real,
    mode_shapes_in_frequency,
    residual_columns,
)

#: phase at the highest line up to which a delay is looked for, rad
_LARGEST_PHASE = 2.0

#: delays tried, both signs
_TRIALS = 81

#: share of the largest receptance that counts as error beside the noise, so that the quietest
#: lines alone do not decide
_MODEL_ERROR = 0.01


def channel_delay(records: Records, model: ModalModel, drives: NDArray[np.bool_]) -> float:
    """Lag of the response channels behind the force channel, s; 0 where the data show none.

    Residues are real: positive in FRFs of a drive point, up to one sign for a sensor turned
    round, of either sign elsewhere. Poles of a model of the same lines; `drives` (k,) tells the
    FRFs of a drive point.
    """
    if model.count == 0:
        return 0.0
    largest = _LARGEST_PHASE / (2.0 * np.pi * float(records.frequency[-1]))
    scale = np.abs(records.laplace[:, None]) ** records.derivative
    error = _MODEL_ERROR * np.max(np.abs(records.values) / scale, axis=0) * scale
    weighted = replace(records, noise=np.hypot(records.noise, error))
    trial = _RealResidues(weighted, model, drives)
    delays = np.linspace(-largest, largest, _TRIALS)
    misfit = [trial.misfit(delay) for delay in delays]
    best = int(np.argmin(misfit))
    if best in (0, _TRIALS - 1):
        return 0.0
    found = scipy.optimize.minimize_scalar(
        trial.misfit,
        bracket=(delays[best - 1], delays[best], delays[best + 1]),
        options={"xtol": 1e-4},
    )
    delay = float(found.x)
    return delay if trial.supports(delay) else 0.0


def without_delay(records: Records, delay: float) -> Records:
    """Records as they are without the lag of the response channels, s."""
    return replace(records, values=records.values * np.exp(records.laplace * delay)[:, None])


class _RealResidues:
    """Linear fits of real residues and residual terms at trial delays."""

    def __init__(self, records: Records, model: ModalModel, drives: NDArray[np.bool_]) -> None:
        shapes = mode_shapes_in_frequency(
            records.laplace, model.natural_frequency, model.damping, records.derivative
        )
        rest = residual_columns(records.laplace, (MASS, COMPLIANCE), records.derivative)
        columns = np.concatenate([shapes.unit, rest], axis=1)
        self._records, self._modes = records, model.count
        self._bases, self._signs = [], []
        for k in range(records.count):
            matrix = as_real(columns, records.noise[:, k])
            matrix = matrix / np.linalg.norm(matrix, axis=0)
            self._bases.append(np.linalg.qr(matrix))
            total = float(np.sum(model.coefficients[: model.count, k]))
            self._signs.append((np.sign(total) or 1.0) if drives[k] else 0.0)

    def misfit(self, delay: float) -> float:
        """Sum of squares at a delay, s."""
        return sum(float(np.sum(error**2)) for error in self._errors(delay))

    def supports(self, delay: float) -> bool:
        """True where the delay is worth an unknown (Schwarz 1978), errors taken as correlated."""
        errors = np.stack([_as_complex(error) for error in self._errors(delay)], axis=1)
        none = np.stack([_as_complex(error) for error in self._errors(0.0)], axis=1)
        samples = effective_samples(errors)
        power, without = np.sum(np.abs(errors) ** 2), np.sum(np.abs(none) ** 2)
        return bool(samples * np.log(without / power) > np.log(samples))

    def _errors(self, delay: float) -> list[NDArray[np.float64]]:
        turned = without_delay(self._records, delay)
        return [
            self._error(k, as_real(turned.values[:, k], turned.noise[:, k]))
            for k in range(turned.count)
        ]

    def _error(self, k: int, target: NDArray[np.float64]) -> NDArray[np.float64]:
        sign = self._signs[k]
        basis, triangle = self._bases[k]
        projected = basis.T @ target
        if not sign:
            return target - basis @ projected
        # residual terms of either sign: their columns stand twice
        free = triangle[:, self._modes :]
        columns = np.concatenate([sign * triangle[:, : self._modes], free, -free], axis=1)
        weights, _ = scipy.optimize.nnls(columns, projected, maxiter=50 * columns.shape[1])
        return target - basis @ (columns @ weights)


def _as_complex(error: NDArray[np.float64]) -> NDArray[np.complex128]:
    half = error.size // 2
    return error[:half] + 1j * error[half:]
