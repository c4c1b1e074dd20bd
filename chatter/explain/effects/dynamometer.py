"""Effects of the force sensor: one resonance, one along each axis, or two along each."""

import itertools
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.explain.effects.effect import Effect, Patch, Reported, Signals, Values, free
from chatter.explain.measurement import Measurement, Run
from chatter.explain.parameters import Parameter
from chatter.simulation.simulate import through_resonance

Array = NDArray[np.float64]

#: start frequencies of a resonance of one axis beside that of another, lowest of them, Hz, and the
#: highest over the highest that is recorded
_STARTS_AN_AXIS, _LOWEST, _BEYOND = 10, 400.0, 1.2
#: frequencies at which the residual is asked what a resonance would do, and damping there
_ASKED, _ASKED_DAMPING = 36, 0.04
#: starts that are proposed
_PROPOSED = 2
#: share of the force that goes through the first of two resonances, where nothing is known
_HALF = 0.5


class Dynamometer(Effect):
    """Resonance of the force sensor."""

    name = "dynamometer"
    label = "dynamometer resonance"
    help = "the force sensor has a resonance of its own"
    kinds = ("milling",)
    section = "dynamometer"

    @property
    def variants(self) -> tuple[Effect, ...]:
        """One resonance of all axes, or one of each."""
        return (self, DynamometerOfAxes())

    @property
    def richer(self) -> tuple[Effect, ...]:
        """Two resonances along each axis."""
        return (DynamometerOfTwo(),)

    def applies(self, measurement: Measurement) -> bool:
        """Of forces measured by a sensor without a declared resonance."""
        measured = any("Fx" in run.signals for run in measurement.runs)
        return measured and measurement.case.dynamometer is None

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Frequency and damping."""
        return [
            free("frequency", 2000.0, 30.0, "Hz", lower=100.0, upper=5e4),
            Parameter("damping", 0.03, 0.02, 0.002, 0.7, True, ""),
        ]

    def starts(self, measurement: Measurement) -> list[Values]:
        """Frequencies up to beyond the highest that is recorded."""
        return [{"frequency": float(f)} for f in _frequencies(measurement, 14)]


class DynamometerOfAxes(Dynamometer):
    """A resonance of the force sensor along each axis."""

    @property
    def variants(self) -> tuple[Effect, ...]:
        """None: it is one of a family."""
        return (self,)

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Frequency and damping along each axis that is measured."""
        found = []
        for axis in _axes(measurement):
            size = {"lower": 100.0, "upper": 5e4}
            found.append(free(f"frequency_{axis}", 2000.0, 30.0, "Hz", **size))
            found.append(Parameter(f"damping_{axis}", 0.03, 0.02, 0.002, 0.7, True, ""))
        return found

    def patch(self, case: Case, values: Values) -> Patch:
        """Resonances by axis."""
        axes = [key.removeprefix("frequency_") for key in values if key.startswith("frequency_")]
        return {
            "dynamometer": {
                "resonance": [
                    {
                        "frequency": float(values[f"frequency_{axis}"]),
                        "damping": float(values[f"damping_{axis}"]),
                        "axis": axis,
                    }
                    for axis in axes
                ]
            }
        }

    def starts(self, measurement: Measurement) -> list[Values]:
        """Frequencies of the first two axes apart, a third one as the first.

        None where the residual proposes some: forces from rest, before the sensor.
        """
        if _from_rest(measurement):
            return []
        grid = _frequencies(measurement, _STARTS_AN_AXIS)
        axes = _axes(measurement)
        return [
            {f"frequency_{axis}": float(pair[k % 2]) for k, axis in enumerate(axes)}
            for pair in itertools.product(grid, repeat=2)
        ]

    def proposed(self, measurement: Measurement, predicted: Mapping[str, Signals]) -> list[Values]:
        """Frequencies by axis at which a resonance makes predicted forces most like measured ones.

        The axes are independent of each other.
        """
        if not _from_rest(measurement) or not predicted:
            return []
        ranked = {
            axis: sorted(seen.alone(), key=lambda entry: entry[0])[:_PROPOSED]
            for axis, seen in _seen_along(measurement, predicted).items()
        }
        return [
            {f"frequency_{axis}": entries[place][1] for axis, entries in ranked.items()}
            for place in range(_PROPOSED)
        ]


class DynamometerOfTwo(DynamometerOfAxes):
    """Two resonances of the force sensor along each axis, that share the force."""

    @property
    def richer(self) -> tuple[Effect, ...]:
        """None that has more."""
        return ()

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Frequencies and dampings along each axis, and the share of the first."""
        found = []
        for axis in _axes(measurement):
            for k in (1, 2):
                bounds = {"lower": 100.0, "upper": 5e4}
                found.append(free(f"frequency_{axis}_{k}", 2000.0, 30.0, "Hz", **bounds))
                found.append(Parameter(f"damping_{axis}_{k}", 0.03, 0.02, 0.002, 0.7, True, ""))
            found.append(free(f"share_{axis}_1", _HALF, 0.1, "", lower=0.01, upper=0.99))
        return found

    def patch(self, case: Case, values: Values) -> Patch:
        """Resonances by axis and share."""
        axes = [key[len("share_")] for key in values if key.startswith("share_")]
        resonances = []
        for axis in axes:
            share = float(values[f"share_{axis}_1"])
            for k, own in ((1, share), (2, 1.0 - share)):
                one = {key: float(values[f"{key}_{axis}_{k}"]) for key in ("frequency", "damping")}
                resonances.append({**one, "axis": axis, "share": own})
        return {"dynamometer": {"resonance": resonances}}

    def starts(self, measurement: Measurement) -> list[Values]:
        """Frequencies apart, of all axes alike; none where the residual proposes some."""
        if _from_rest(measurement):
            return []
        grid, axes = _frequencies(measurement, _STARTS_AN_AXIS), _axes(measurement)
        return [
            {f"frequency_{axis}_{k}": float(one) for axis in axes for k, one in ((1, a), (2, b))}
            for a, b in itertools.combinations(grid, 2)
        ]

    def proposed(self, measurement: Measurement, predicted: Mapping[str, Signals]) -> list[Values]:
        """Pairs of frequencies, with their share, that make predicted forces like measured ones."""
        if not _from_rest(measurement) or not predicted:
            return []
        start: dict[str, float] = {}
        for axis, seen in _seen_along(measurement, predicted).items():
            first, second, share = seen.best_pair()
            start |= {f"frequency_{axis}_1": first, f"frequency_{axis}_2": second}
            start[f"share_{axis}_1"] = share
        return [start]

    def reported(self, values: Values) -> Reported:
        """Frequencies, dampings and both shares."""
        found = {}
        for key, value in values.items():
            found[key] = (value, "Hz" if key.startswith("frequency") else "")
            if key.startswith("share"):
                found[f"{key[:-1]}2"] = (1.0 - value, "")
        return found


class _Seen:
    """Forces along one axis through resonances, as sums of products over all runs."""

    def __init__(self, frequencies: Array, runs: list[tuple[Run, Signals]], axis: str) -> None:
        self.frequencies = frequencies
        count = frequencies.size
        self.products, self.with_measured, self.measured = np.zeros((count, count)), 0.0, 0.0
        name = f"F{axis}"
        for run, predicted in runs:
            level = float(np.std(run.signals[name])) + 1e-300
            force = predicted[name][:, None]
            through = np.array(
                [through_resonance(force, f, _ASKED_DAMPING, run.step)[:, 0] for f in frequencies]
            )
            # what differs from the force itself: the static share is all of it
            through, measured = (
                (one - force[:, 0]) / level for one in (through, run.signals[name])
            )
            self.products = self.products + through @ through.T
            self.with_measured = self.with_measured + through @ measured
            self.measured += float(measured @ measured)

    def alone(self) -> list[tuple[float, float]]:
        """Sum of squares with each resonance, and its frequency."""
        own = np.diag(self.products)
        costs = self.measured - 2.0 * self.with_measured + own
        return list(zip(costs.tolist(), self.frequencies.tolist(), strict=True))

    def best_pair(self) -> tuple[float, float, float]:
        """Two frequencies and the share of the first with the least sum of squares."""
        best = (np.inf, 0.0, 0.0, _HALF)
        for i, j in itertools.combinations(range(self.frequencies.size), 2):
            both = self.products[np.ix_((i, j), (i, j))]
            right = self.with_measured[[i, j]]
            # cost of s and 1 - s: a parabola
            across = both[0, 0] - 2.0 * both[0, 1] + both[1, 1]
            slope = right[0] - right[1] - both[0, 1] + both[1, 1]
            share = float(np.clip(slope / max(across, 1e-300), 0.05, 0.95))
            weights = np.array([share, 1.0 - share])
            cost = self.measured - 2.0 * weights @ right + weights @ both @ weights
            if cost < best[0]:
                best = (cost, float(self.frequencies[i]), float(self.frequencies[j]), share)
        return best[1:]


def _seen_along(measurement: Measurement, predicted: Mapping[str, Signals]) -> dict[str, _Seen]:
    """What resonances would do to predicted forces, by axis."""
    frequencies = _frequencies(measurement, _ASKED)
    runs = [(run, predicted[run.name]) for run in measurement.runs]
    return {axis: _Seen(frequencies, runs, axis) for axis in _axes(measurement)}


def _frequencies(measurement: Measurement, count: int) -> Array:
    """Frequencies, Hz, up to beyond the highest that is recorded."""
    highest = 0.5 / float(np.median(np.diff(measurement.runs[0].signals["time"])))
    return np.geomspace(_LOWEST, _BEYOND * highest, count)


def _from_rest(measurement: Measurement) -> bool:
    return all(run.record is None for run in measurement.runs)


def _axes(measurement: Measurement) -> list[str]:
    """Axes along which every run has a force."""
    return [axis for axis in "xyz" if all(f"F{axis}" in run.signals for run in measurement.runs)]
