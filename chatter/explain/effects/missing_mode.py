"""A mode that the structure lacks, and where the residual of the displacements proposes it."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.explain.effects.effect import Effect, Patch, Reported, Signals, Values, free
from chatter.explain.effects.structure import has_modes, stiffness_of
from chatter.explain.fitting import Parameter
from chatter.explain.measurement import Measurement, Run
from chatter.simulation.simulate import through_resonance

Array = NDArray[np.float64]

#: natural frequencies tried, from and to which share of the known ones, and damping ratios
_TRIED, _LOWEST, _HIGHEST = 80, 0.3, 2.5
_DAMPING = (0.01, 0.03, 0.08)
#: compliance of a mode that is not small, as a share of that of the most compliant known one
_SIZABLE = 0.5
#: modes that are proposed, further apart than a share of their frequency
_PROPOSED, _APART = 2, 0.15
#: samples of a run that are looked at: a run begins at rest, and so does every mode
_MOST_SAMPLES = 6000


class MissingMode(Effect):
    """One mode more, in the plane of the cut."""

    name = "missing_mode"
    label = "missing mode"
    help = "the structure has a mode more"
    kinds = ("milling", "frf", "stability")

    def applies(self, measurement: Measurement) -> bool:
        """Of a structure of modes."""
        return has_modes(measurement)

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Frequency, damping, compliance and direction; no compliance: no mode."""
        modes = measurement.case.structure.mode
        compliance = max(1.0 / stiffness_of(m.frequency, m.modal_mass) for m in modes)
        return [
            free("frequency", 300.0, 5.0, "Hz", lower=5.0, upper=2e4),
            Parameter("damping", 0.03, 0.01, 0.002, 0.3, True, ""),
            free("compliance", 0.01 * compliance, 0.02 * compliance, "m/N", lower=0.0),
            free("angle", 0.0, 0.3, "rad"),
        ]

    def nothing(self, measurement: Measurement) -> Values:
        """No compliance."""
        return {"compliance": 0.0}

    def patch(self, case: Case, values: Values) -> Patch:
        """Modes of the structure."""
        known = [mode.model_dump(exclude_none=True) for mode in case.structure.mode]
        angle = float(values["angle"])
        added = {
            "frequency": float(values["frequency"]),
            "damping": float(values["damping"]),
            "mass": self._mass(values),
            "direction": [math.cos(angle), math.sin(angle), 0.0],
            "side": "tool",
        }
        return {"structure.mode": [*known, added]}

    def starts(self, measurement: Measurement) -> list[Values]:
        """Frequencies around and between the known modes, along x and y."""
        known = sorted(mode.frequency for mode in measurement.case.structure.mode)
        frequencies = np.geomspace(0.3 * known[0], 2.5 * known[-1], 14)
        return [
            {"frequency": float(frequency), "angle": angle}
            for angle in (0.0, 0.5 * math.pi)
            for frequency in frequencies
        ]

    def sizable_starts(self, measurement: Measurement) -> list[Values]:
        """The same, half as compliant as the most compliant mode."""
        modes = measurement.case.structure.mode
        most = max(1.0 / stiffness_of(one.frequency, one.modal_mass) for one in modes)
        return [{**one, "compliance": _SIZABLE * most} for one in self.starts(measurement)]

    def proposed(
        self, measurement: Measurement, predicted: Mapping[str, Signals]
    ) -> Sequence[Values]:
        """Modes whose answer to the forces resembles what is left of the displacements."""
        return resembling_modes(measurement, predicted)

    def reported(self, values: Values) -> Reported:
        """Frequency, damping, mass, and the direction as an angle from x within half a turn."""
        return {
            "frequency": (values["frequency"], "Hz"),
            "damping": (values["damping"], ""),
            "mass": (self._mass(values), "kg"),
            "direction": (values["angle"] % math.pi, "rad"),
        }

    @staticmethod
    def _mass(values: Values) -> float:
        compliance = max(float(values["compliance"]), 1e-16)
        return 1.0 / compliance / (2.0 * math.pi * float(values["frequency"])) ** 2


def resembling_modes(
    measurement: Measurement, predicted: Mapping[str, Signals]
) -> list[dict[str, float]]:
    """Modes whose answer to the predicted forces takes most of the residual displacement away.

    Predicted signals are by run. A mode of compliance c along a unit vector d moves the tool by
    c d (d . q) where q is the force through an oscillator of unit stiffness: linear in the three
    products c dx dx, c dx dy and c dy dy, which are fitted. What the motion changes in the chip is
    left to the simulation. None where there are no displacements from rest.
    """
    runs = [run for run in measurement.runs if run.record is None and _moves(run)]
    if not runs or not predicted:
        return []
    parts = [_Part(run, predicted[run.name]) for run in runs]
    known = sorted(mode.frequency for mode in measurement.case.structure.mode)
    found = []
    for frequency in np.geomspace(_LOWEST * known[0], _HIGHEST * known[-1], _TRIED):
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


class _Part:
    """Residual displacements of a run over their level, and the forces that were predicted."""

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
        zero = np.zeros(len(q))
        matrix, right = np.zeros((3, 3)), np.zeros(3)
        columns = ((q[:, 0], q[:, 1], zero), (zero, q[:, 0], q[:, 1]))
        for residual, level, three in zip(self.residual, self.level, columns, strict=True):
            scaled = np.column_stack(three) / level
            matrix += scaled.T @ scaled
            right += scaled.T @ residual
        return matrix, right


def _best_products(parts: Sequence[_Part], frequency: float, damping: float) -> tuple[float, Array]:
    """Fall of the sum of squares by a mode, and its compliance times directions (2, 2), m/N."""
    normals = [part.normal(frequency, damping) for part in parts]
    matrix = np.sum([one for one, _ in normals], axis=0)
    right = np.sum([one for _, one in normals], axis=0)
    xx, xy, yy = np.linalg.pinv(matrix, hermitian=True) @ right
    return float(right @ np.array([xx, xy, yy])), np.array([[xx, xy], [xy, yy]])
