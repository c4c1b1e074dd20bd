"""Cutting tests judged stable or chatter: how likely is what each of them shows."""

from collections import OrderedDict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from threading import Lock

import numpy as np
import scipy
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.unit_system import units_of
from chatter.description.units import rpm
from chatter.explain.cutting_tests.spindle_power import cutting_power, readings
from chatter.explain.cutting_tests.wear import has_power
from chatter.explain.data_checks.power import wrong_powers
from chatter.explain.data_checks.verdicts import wrong_verdicts
from chatter.explain.kinds.kind import (
    Array,
    Cuts,
    Deviation,
    Kind,
    Noise,
    Signals,
    Trial,
    mean_over_channels,
)
from chatter.explain.kinds.milling import cutting_paths, structural_paths
from chatter.explain.measurement import Measurement, Run
from chatter.explain.next_measurement.information import information_of_verdicts
from chatter.explain.parameters import Parameter, by_factor, with_priors
from chatter.explain.residuals.channel_residual import ChannelResidual
from chatter.explain.residuals.misclassified_tests import misclassified, over_depth, over_speed
from chatter.explain.stability_margin import (
    CuttingTests,
    ResponseOfTests,
    response_of_tests,
    tests_of,
)
from chatter.studies.kept_arrays import KeptArrays, digest_of

#: scatter of a critical depth from test to test, as a share, and tests judged wrongly for no reason
SCATTER, _WRONG = 0.06, 0.02
#: scatter of chatter frequencies and of spindle powers before it is estimated, as shares
FREQUENCY_SCATTER, POWER_SCATTER = 0.01, 0.03
#: normalised residual of a frequency or a power that none exceeds
_LARGEST_RESIDUAL = 4.0
#: tolerance of a declared process damping: a factor of two
_DAMPING, _DAMPING_TOLERANCE = "process_damping.coefficient", 1.0
#: tolerance of natural frequencies of a tap test, the best known of all values
_FREQUENCY_TOLERANCE = 0.01
#: runs that the tests are dealt out to, the least of them, and verdicts that are needed
_PARTS, _LEAST_PARTS, _LEAST_VERDICTS = 6, 3, 12
#: least probability of an outcome in the scatter of a verdict
_LEAST_LIKELY = 1e-6
#: responses that are kept
_MOST_KEPT = 200
#: points of a discriminating test, a side, and noise of its verdict: outcomes are told apart where
#: their probabilities differ by most of one
_POINTS, _NOISE_OF_VERDICT = 12, 0.25


class Stability(Kind):
    """Points over speed and depth with a verdict each; marginal ones do not count."""

    name = "stability"
    table_key = "points"
    columns = (("spindle_speed",), ("axial_depth",), ("stable",))
    is_sampled = False
    estimates_noise = False
    has_autocorrelation = False
    diagnostics = (misclassified, over_speed, over_depth)
    checks = ((), (wrong_verdicts, wrong_powers))
    #: deviance residuals of a model that is right are small
    at_noise = 1.0
    #: twice the logarithm of the likelihood, whatever the number of points
    least_gain = (8.0, 0.0)

    def __init__(self, kept: KeptArrays | None = None) -> None:
        self._responses = _Responses(kept or KeptArrays(None))

    def stands_alone(self, run: Run) -> bool:
        """No: tests are solved together with those that were not solved before."""
        return False

    def keeping(self, kept: KeptArrays) -> Kind:
        """Return the kind with the responses of tests kept on disk."""
        return type(self)(kept)

    def channels(self, run: Run) -> tuple[str, ...]:
        """The verdicts, the chatter frequencies or the spindle powers: one of them a run."""
        return (str(run.record),)

    def prepared(self, measurement: Measurement) -> Measurement:
        """Return the measurement whose tests are dealt out to several runs of each channel.

        Raises InputError if there are fewer than a dozen verdicts.
        """
        (run,) = measurement.runs
        judged = np.isfinite(run.signals["stable"])
        if judged.sum() < _LEAST_VERDICTS:
            raise InputError(
                f"{run.name}: {judged.sum()} verdicts; {_LEAST_VERDICTS} at least are needed"
            )
        signals, idle = dict(run.signals), measurement.idle_power
        if _has(run, "spindle_power"):
            tests = tests_of(measurement.case, signals)
            found = readings(measurement.case, tests, signals["spindle_power"], idle)
            signals["spindle_power"], idle = found.power, found.idle
        parts = _parts(run, signals, "stable", judged)
        if _has(run, "chatter_frequency"):
            heard = judged & (signals["stable"] < 0.5) & (signals["chatter_frequency"] > 0.0)
            parts += _parts(run, signals, "chatter_frequency", heard)
        if _has(run, "spindle_power"):
            parts += _parts(run, signals, "spindle_power", signals["spindle_power"] > 0.0)
        return replace(measurement.with_runs(parts), idle_power=idle)

    def noise_floor(self, residuals: Sequence[ChannelResidual]) -> float:
        """Error that a model has that is right: verdicts scatter about their probabilities."""
        shares: dict[str, list[float]] = {}
        for one in residuals:
            variance = float(np.mean(one.deviation**2))
            if one.channel == "stable":
                variance = float(np.mean(one.predicted * (1.0 - one.predicted)))
            shares.setdefault(one.channel, []).append(
                variance / max(float(np.mean(one.measured**2)), 1e-9)
            )
        return mean_over_channels(shares)

    def predict(self, case: Case, run: Run) -> Signals:
        """Probability of a stable verdict, frequency, power or multiplier of every test."""
        tests = tests_of(case, run.signals)
        if run.record == "spindle_power":
            return {"spindle_power": cutting_power(case, tests)}
        response = self._responses.of(case, tests)
        if run.record == "multiplier":
            return {"multiplier": np.exp(response.rate)}
        if run.record == "multiplier_angle":
            return {"multiplier_angle": response.angle}
        if run.record == "chatter_frequency":
            near = run.signals["chatter_frequency"]
            return {"chatter_frequency": response.chatter_frequency(near)}
        return {"stable": likely_stable(response.margin, SCATTER), "margin": response.margin}

    def first_noise(self, run: Run) -> Mapping[str, float]:
        """Scatter of limits as a share; of frequencies in Hz; of powers as a share."""
        (channel,) = self.channels(run)
        if channel == "chatter_frequency":
            whole = (run.whole or run).signals[channel]
            return {channel: FREQUENCY_SCATTER * float(np.median(whole))}
        return {channel: SCATTER if channel == "stable" else POWER_SCATTER}

    def residuals(self, run: Run, predicted: Signals, noise: Mapping[str, float]) -> Array:
        """Deviance residuals: their squares are twice the lost logarithm of likelihood.

        Frequencies and powers that nothing explains are limited: one reading decides nothing.
        """
        (channel,) = self.channels(run)
        if channel == "stable":
            stable = likely_stable(predicted["margin"], noise[channel])
            verdict = run.signals["stable"] > 0.5
            likely = np.where(verdict, stable, 1.0 - stable)
            return np.where(verdict, 1.0, -1.0) * np.sqrt(-2.0 * np.log(likely))
        left = predicted[channel] - run.signals[channel]
        if channel == "spindle_power":
            left = left / run.signals[channel]
        return limited(left / noise[channel])

    def deviation(
        self, run: Run, channel: str, measured: Array, predicted: Array, level: float | None
    ) -> Deviation:
        """Scatter of every verdict by its own probability, of every reading by its level."""
        if channel != "stable":
            level = level or self.first_noise(run)[channel]
            samples = np.full(measured.size, level)
            if channel == "spindle_power":
                samples = level * np.abs(measured)
            return Deviation(samples, float(np.sqrt(np.mean(samples**2))))
        likely = np.clip(predicted, _LEAST_LIKELY, 1.0 - _LEAST_LIKELY)
        variance = likely * (1.0 - likely)
        return Deviation(np.sqrt(variance), float(np.sqrt(np.mean(variance))))

    def nuisance_parameters(self, measurement: Measurement) -> list[Parameter]:
        """Cutting coefficients, modal parameters and process damping.

        Process damping is known by a factor, of two at the best where nothing else is said
        (Ahmadi and Altintas 2014, CIRP J. Manuf. Sci. Technol. 7:235). Natural frequencies repeat
        within a percent from tap test to tap test.
        """
        coefficients = ("Ktc", "Krc", "Kte") if has_power(measurement) else ("Ktc", "Krc")
        declared = measurement.case.deviations()
        tolerances = dict(measurement.tolerances)
        damped = measurement.case.process_damping
        known = _DAMPING in declared or "coefficient" in tolerances
        if damped is not None and damped.coefficient and not known:
            tolerances.setdefault(_DAMPING, _DAMPING_TOLERANCE)
        if "frequency" not in tolerances:
            for path in structural_paths(measurement.case):
                if path.endswith(".frequency") and path not in declared:
                    tolerances.setdefault(path, _FREQUENCY_TOLERANCE)
        with_damping = replace(measurement, tolerances=tolerances)
        found = with_priors(with_damping, cutting_paths(measurement.case, coefficients))
        return [by_factor(one) if one.name == _DAMPING else one for one in found]

    def cuts(self, measurement: Measurement) -> Cuts:
        """The tests, with their verdicts."""
        judged = [run for run in measurement.runs if run.record in (None, "stable")]
        speed, depth, stable = (
            np.concatenate([run.signals[name] for run in judged])
            for name in ("spindle_speed", "axial_depth", "stable")
        )
        return Cuts(speed, depth, stable > 0.5)

    def information(
        self, trial: Trial, channel: str, weights: Array, predicted: Sequence[Array]
    ) -> float:
        """Information, bit, that the verdict of a test is expected to give."""
        return information_of_verdicts(weights, np.array([float(one[0]) for one in predicted]))

    def trials(self, measurement: Measurement, noise: Noise) -> list[Trial]:
        """Verdicts at single points over the speeds and depths that were tested."""
        speeds, depths, _ = self.cuts(measurement)
        trials = []
        length = units_of(measurement.case).length
        for speed in np.geomspace(speeds.min(), speeds.max(), _POINTS):
            for depth in np.geomspace(depths.min(), depths.max(), _POINTS):
                words = f"a cut at {rpm(speed):.0f} rpm and {length.text(depth, '.3g')}"
                point = {"spindle_speed": np.array([speed]), "axial_depth": np.array([depth])}
                run = Run("trial", {}, point, record="stable")
                trials.append(Trial(words, run, {"stable": _NOISE_OF_VERDICT}))
        return trials


def likely_stable(margin: Array, scatter: float | Array) -> Array:
    """Probability of a stable verdict at a margin, by the scatter of limits from test to test."""
    return _WRONG + (1.0 - 2.0 * _WRONG) * scipy.special.ndtr(margin / scatter)


def limited(scaled: Array) -> Array:
    """Residuals of readings in their standard deviations, limited: one reading decides nothing."""
    return scaled / np.sqrt(1.0 + (scaled / _LARGEST_RESIDUAL) ** 2)


def _has(run: Run, column: str) -> bool:
    return column in run.signals and bool(np.isfinite(run.signals[column]).any())


def _parts(run: Run, signals: Signals, channel: str, chosen: NDArray[np.bool_]) -> list[Run]:
    """The tests that have a channel, dealt out to runs that are predicted together."""
    own = {name: values[chosen] for name, values in signals.items()}
    parts = _PARTS
    if channel == "stable":
        order = np.arange(chosen.sum())
        if any(not np.any(own["stable"][part::parts] > 0.5) for part in range(parts)):
            # an error over the signal needs a stable test in every part
            order = np.argsort(-own["stable"], kind="stable")
            parts = int(np.clip(np.sum(own["stable"] > 0.5), _LEAST_PARTS, _PARTS))
        own = {name: values[order] for name, values in own.items()}
    words = channel if channel != "stable" else "points"
    whole = replace(run, name=words.replace("_", " "), signals=own, record=channel)
    return [
        replace(
            whole,
            name=f"{whole.name} {part + 1}",
            signals={name: values[part::parts] for name, values in own.items()},
            whole=whole,
            part=slice(part, None, parts),
        )
        for part in range(parts)
        if part < int(chosen.sum())
    ]


class _Responses:
    """Responses of tests, kept by what of a case they depend on: edge forces are not of it.

    Every test is computed once: those whose chatter frequency is known are some of the verdicts.
    """

    def __init__(self, kept: KeptArrays) -> None:
        self._on_disk = kept
        self._kept: OrderedDict[Case, dict[tuple[float, ...], tuple[float, ...]]] = OrderedDict()
        self._lock = Lock()

    def of(self, case: Case, tests: CuttingTests) -> ResponseOfTests:
        """Response of tests."""
        case = _without_edge_forces(case)
        columns = [tests.speed, tests.depth, *tests.varied.values()]
        keys = list(zip(*(values.tolist() for values in columns), strict=True))
        with self._lock:
            known = self._kept.setdefault(case, {})
            self._kept.move_to_end(case)
            while len(self._kept) > _MOST_KEPT:
                self._kept.popitem(last=False)
        unknown = np.array([key not in known for key in keys])
        if unknown.any():
            parts = self._solved(case, tests.at(unknown))
            found = zip(*(part.tolist() for part in parts), strict=True)
            known.update(zip((keys[k] for k in np.flatnonzero(unknown)), found, strict=True))
        return ResponseOfTests(*np.array([known[key] for key in keys]).T)

    def _solved(self, case: Case, tests: CuttingTests) -> Iterable[Array]:
        """Fields of the response of tests that are solved together, or what is kept of it."""
        if self._on_disk.path is None:
            return response_of_tests(case, tests)
        columns = {"speed": tests.speed, "depth": tests.depth, **tests.varied}
        return self._on_disk.made(
            f"{digest_of(columns)} {case.content}", lambda: response_of_tests(case, tests)._asdict()
        ).values()


def _without_edge_forces(case: Case) -> Case:
    if case.material.law != "linear" or case.tool.runout is not None:
        return case
    if case.process_damping is not None and case.process_damping.coefficient is None:
        return case  # of a flank that ploughs
    none = {"edge_tangential": 0.0, "edge_radial": 0.0}
    material = case.material.model_copy(update={"Kte": 0.0, "Kre": 0.0, "Kae": 0.0})
    wear = case.wear
    if wear is not None:
        chipping = wear.chipping and wear.chipping.model_copy(update=none)
        wear = wear.model_copy(update={**none, "chipping": chipping})
    return case.model_copy(update={"material": material, "wear": wear})
