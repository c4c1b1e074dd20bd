"""Modes that the residual of motions or FRFs proposes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from chatter.explain.effects.effect import Signals
from chatter.explain.measurement import Measurement, Run
from chatter.simulation.simulate import through_resonance

Array = NDArray[np.float64]

#: natural frequencies tried, and damping ratios
_TRIED = 80
_DAMPING = (0.01, 0.03, 0.08)
#: modes that are proposed, further apart than a share of their frequency
_PROPOSED, _APART = 2, 0.15
#: samples of a run that are looked at: a run begins at rest, and so does every mode
_MOST_SAMPLES = 6000
#: product of its direction that an FRF shows: of x with x, x with y, y with y
_PRODUCTS = {"x": 0, "xx": 0, "xy": 1, "yx": 1, "y": 2, "yy": 2}


def resembling_modes(
    measurement: Measurement, predicted: Mapping[str, Signals], sought: tuple[float, float]
) -> list[dict[str, float]]:
    """Modes whose answer to the forces takes most of the residual of motions or FRFs away.

    Predicted signals are by run; modes are sought between two frequencies, Hz. A mode of compliance
    c along a unit vector d moves the tool by c d (d . q) where q is the force through an oscillator
    of unit stiffness: linear in the three products c dx dx, c dx dy and c dy dy, which are fitted.
    What the motion changes in the chip is left to the simulation. An FRF shows the product of its
    directions under a unit force. None where there are neither FRFs nor displacements from rest.
    """
    if not predicted:
        return []
    parts: list[_Motion | _Response] = [
        _Motion(run, predicted[run.name])
        for run in measurement.runs
        if run.record is None and _moves(run)
    ]
    parts += [_Response(run, predicted[run.name]) for run in measurement.runs if _responds(run)]
    if not parts:
        return []
    highest = min([sought[1], *(part.highest for part in parts)])
    found = []
    for frequency in np.geomspace(sought[0], highest, _TRIED):
        for damping in _DAMPING:
            gain, products = _best_products(parts, float(frequency), damping)
            size, vectors = np.linalg.eigh(products)
            if size[1] > 0.0:
                found.append((gain, float(frequency), damping, float(size[1]), vectors[:, 1]))
    found.sort(key=lambda entry: -entry[0])
    chosen: list[dict[str, float]] = []
    for _, frequency, damping, compliance, direction in found:
        if all(abs(frequency / one["frequency"] - 1.0) > _APART for one in chosen):
            angle = math.atan2(direction[1], direction[0])
            chosen.append(
                {"frequency": frequency, "damping": damping, "compliance": compliance,
                 "angle": angle}
            )  # fmt: skip
        if len(chosen) == _PROPOSED:
            break
    return chosen


def _moves(run: Run) -> bool:
    return "x" in run.signals and "y" in run.signals


class _Motion:
    """Residual displacements of a run over their level, and the forces that were predicted."""

    highest = math.inf  # natural frequency that is sought, Hz

    def __init__(self, run: Run, predicted: Signals) -> None:
        size = min(run.signals["time"].size, _MOST_SAMPLES)
        self.step = run.step
        self.force = np.column_stack([predicted[name][:size] for name in ("Fx", "Fy")])
        self.level = [float(np.std(run.signals[name])) + 1e-30 for name in ("x", "y")]
        self.residual = [
            (run.signals[name] - predicted[name])[:size] / level
            for name, level in zip(("x", "y"), self.level, strict=True)
        ]

    def normal(self, frequency: float, damping: float) -> tuple[Array, Array]:
        """Normal matrix (3, 3) and right side (3,) of the products of a mode."""
        q = through_resonance(self.force, frequency, damping, self.step)
        (xx, xy), (_, yy) = q.T @ q
        matrix, right = np.zeros((3, 3)), np.zeros(3)
        # columns (qx, qy, 0) of x and (0, qx, qy) of y
        for first, residual, level in zip((0, 1), self.residual, self.level, strict=True):
            own = slice(first, first + 2)
            matrix[own, own] += np.array([[xx, xy], [xy, yy]]) / level**2
            right[own] += q.T @ residual / level
        return matrix, right


def _responds(run: Run) -> bool:
    """Whether a run is an FRF of the free tool in the plane of the cut."""
    told = "frequency" in run.signals and run.condition != "in_cut"
    return told and run.direction in _PRODUCTS


class _Response:
    """Residual FRF of a run over its scatter."""

    def __init__(self, run: Run, predicted: Signals) -> None:
        self.frequency = run.signals["frequency"]
        self.highest = float(self.frequency.max())
        self.level = run.record.scatter
        self.product = _PRODUCTS[run.direction]
        real, imag = (run.signals[name] - predicted[name] for name in ("real", "imag"))
        self.residual = (real + 1j * imag) / self.level

    def normal(self, frequency: float, damping: float) -> tuple[Array, Array]:
        """Normal matrix (3, 3) and right side (3,) of the products of a mode."""
        ratio = self.frequency / frequency
        scaled = 1.0 / (1.0 - ratio**2 + 2j * damping * ratio) / self.level
        matrix, right = np.zeros((3, 3)), np.zeros(3)
        matrix[self.product, self.product] = np.sum(np.abs(scaled) ** 2)
        right[self.product] = np.real(np.vdot(scaled, self.residual))
        return matrix, right


def _best_products(
    parts: Sequence[_Motion | _Response], frequency: float, damping: float
) -> tuple[float, Array]:
    """Fall of the sum of squares by a mode, and its compliance times directions (2, 2), m/N."""
    normals = [part.normal(frequency, damping) for part in parts]
    matrix = np.sum([one for one, _ in normals], axis=0)
    right = np.sum([one for _, one in normals], axis=0)
    xx, xy, yy = np.linalg.pinv(matrix, hermitian=True) @ right
    return float(right @ np.array([xx, xy, yy])), np.array([[xx, xy], [xy, yy]])
