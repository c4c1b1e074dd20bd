"""Kinds of measurement: everything that the checks, the search and the reports ask of one.

A kind is one module with a subclass of `Kind`, and one line in `chatter.explain.kinds.kind_list`.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.explain.criteria import (
    AT_NOISE,
    FIRST_NOISE,
    LEAST_GAIN,
    LEAST_GAIN_SHARE,
    LEAST_SHARE_IN_PART,
    NUMERICS,
)
from chatter.explain.data_checks.finding import Check, SignalFinding
from chatter.explain.measurement import Measurement, Run
from chatter.explain.next_measurement.information import information_of_signals
from chatter.explain.parameters import Parameter
from chatter.explain.residuals.channel_residual import ChannelResidual, white_level
from chatter.explain.residuals.finding import Finding
from chatter.explain.residuals.residual import Residual
from chatter.explain.residuals.variables import Condition, Form, Measure, Variable
from chatter.studies.kept_arrays import KeptArrays

Array = NDArray[np.float64]
Signals = Mapping[str, Array]
#: run -> channel -> standard deviation, SI
Noise = Mapping[str, Mapping[str, float]]

#: least noise, as a share of the signal, and least weight of a sample: none divides by zero
_LEAST_NOISE, _LEAST_WEIGHT = 1e-6, 1e-6


class Deviation(NamedTuple):
    """Noise of one channel of one run, SI: (n,) standard deviations of its samples, and the rms."""

    samples: Array
    level: float


class Trial(NamedTuple):
    """A measurement that might be made: description, run to predict, noise by channel."""

    description: str
    run: Run
    noise: Mapping[str, float]


class Cuts(NamedTuple):
    """Cuts that were measured: speeds, rad/s, depths, m, and verdicts where there are any."""

    speed: Array
    depth: Array
    stable: NDArray[np.bool_] | None = None


class Kind(ABC):
    """A kind of measurement.

    Attributes
    ----------
    name : str
        As in measurement.toml.
    table_key : str
        Key of measurement.toml that names the one file of the set; empty where it has [[run]]s.
    sections : tuple of str
        Sections of a case that predictions need.
    columns : tuple of tuple of str
        Groups of columns, of each of which a run needs one.
    checks : tuple of tuple of callable
        Checks of the data, group by group: where one finds what is fatal, the groups after it
        would only repeat it.
    diagnostics : tuple of callable
        Residual -> Finding.
    variables, forms, conditions, measures : tuple
        What the residual may depend on, and how.
    periodic_variable : str
        Name of the variable in which periods are looked for.
    sources : tuple of str
        Channels that others follow from: what explains them explains all.
    is_sampled : bool
        Whether a run is a series of samples that is drawn as such.
    estimates_noise : bool
        Whether the noise is estimated anew from the residual; else what is known of it stays.
    has_autocorrelation : bool
        Whether residuals of a channel are a series in which neighbours depend on each other.
    at_noise : float
        Rms of the normalised residual up to which a channel is at its noise.
    least_gain : (float, float)
        Fall of the sum of squares of holdout runs that is significant, and what is added to it
        for each of their samples.
    least_share_in_part : float
        Share of a misfit that an effect takes away that is named though something else is left.
    """

    name: ClassVar[str]
    table_key: ClassVar[str] = ""
    sections: ClassVar[tuple[str, ...]] = ("tool", "material", "cut", "structure")
    columns: ClassVar[tuple[tuple[str, ...], ...]]
    checks: ClassVar[tuple[tuple[Check, ...], ...]] = ()
    diagnostics: ClassVar[tuple[Callable[..., Finding], ...]] = ()
    variables: ClassVar[tuple[Variable, ...]] = ()
    forms: ClassVar[tuple[Form, ...]] = ()
    conditions: ClassVar[tuple[Condition, ...]] = ()
    measures: ClassVar[tuple[Measure, ...]] = ()
    periodic_variable: ClassVar[str] = ""
    sources: ClassVar[tuple[str, ...]] = ()
    is_sampled: ClassVar[bool] = True
    estimates_noise: ClassVar[bool] = True
    has_autocorrelation: ClassVar[bool] = True
    at_noise: ClassVar[float] = AT_NOISE
    least_gain: ClassVar[tuple[float, float]] = (LEAST_GAIN, LEAST_GAIN_SHARE)
    least_share_in_part: ClassVar[float] = LEAST_SHARE_IN_PART

    @abstractmethod
    def channels(self, run: Run) -> tuple[str, ...]:
        """Signals of a run that are predicted."""

    @abstractmethod
    def predict(self, case: Case, run: Run) -> Signals:
        """Signals of a whole run by a case with the overrides of the run, at its samples, SI."""

    def reduced(self, case: Case, run: Run) -> Case:
        """Return a case without what predictions of a run do not depend on; itself by default.

        Cases that differ in nothing else share a prediction.
        """
        del run
        return case

    def stands_alone(self, run: Run) -> bool:
        """Whether a prediction of a run is the same to the last bit whatever was predicted before.

        Only such a one is kept on disk as it is. True by default.
        """
        return True

    def keeping(self, kept: KeptArrays) -> "Kind":
        """Return the kind with what costs most kept on disk; itself where predictions are."""
        return self

    @abstractmethod
    def nuisance_parameters(self, measurement: Measurement) -> list[Parameter]:
        """Declared values that are refitted within their tolerances, by their paths."""

    def as_recorded(self, measurement: Measurement) -> tuple[Measurement, list[SignalFinding]]:
        """Measurement as its kind judges it, and what was found out about its records.

        It is made when samples and clock have been checked. InputError where a record lacks what
        is described. Unchanged by default.
        """
        return measurement, []

    def revolution(self, run: Run) -> float | None:
        """Time after which a record repeats itself, s; None where it need not."""
        return None

    def reported_channels(self, run: Run) -> tuple[str, ...]:
        """Channels whose errors are reported; all that are predicted by default."""
        return self.channels(run)

    def prepared(self, measurement: Measurement) -> Measurement:
        """Return the measurement as it is searched; unchanged by default.

        Raises InputError if a run lacks what the kind needs.
        """
        return measurement

    def searched_at_start(self, measurement: Measurement) -> list[Parameter]:
        """Declared values that are looked at around before they are refitted; none by default."""
        del measurement
        return []

    def coarse(self, case: Case, run: Run) -> Mapping[str, Any]:
        """Overrides of a run by which it costs less to predict, near enough for differences.

        None by default. The case is the declared one.
        """
        del case, run
        return {}

    def cheaper_runs(self, case: Case, runs: Sequence[Run]) -> Sequence[Run]:
        """Runs by which candidates are screened first, as the others cost far more; none.

        The case is the declared one.
        """
        del case, runs
        return ()

    def refined(self, measurement: Measurement, case: Case) -> Measurement:
        """Return the measurement as the last fits take it, by a case found; unchanged by default.

        Its samples may have other weights, or be predicted more exactly.
        """
        del case
        return measurement

    def with_records_by(self, measurement: Measurement, case: Case) -> Measurement:
        """Return the measurement with its records as a case tells them; unchanged by default."""
        del case
        return measurement

    def without_too_slow(
        self, measurement: Measurement, case: Case
    ) -> tuple[Measurement, list[SignalFinding]]:
        """Leave out records that need not have settled, by a case found; none by default."""
        del case
        return measurement, []

    def predicted_as(self, run: Run) -> str:
        """What a prediction of a run depends on beside the case and the signals; nothing."""
        del run
        return ""

    def residuals(self, run: Run, predicted: Signals, noise: Mapping[str, float]) -> Array:
        """Residuals of all channels of a run, scaled to a standard deviation of one."""
        return np.concatenate(
            [
                (predicted[channel] - run.signals[channel]) * (run.weight(channel) / noise[channel])
                for channel in self.channels(run)
            ]
        )

    def known_noise(self, run: Run) -> Mapping[str, float]:
        """Standard deviation of the noise of channels where it is known before any fit, SI."""
        return {}

    def first_noise(self, run: Run) -> Mapping[str, float]:
        """Standard deviation of every channel for the first fit, SI."""
        known = self.known_noise(run)
        return {
            channel: known[channel]
            if channel in known
            else FIRST_NOISE * float(np.sqrt(np.mean(run.signals[channel] ** 2))) + 1e-30
            for channel in self.channels(run)
        }

    def noise_beside(
        self, run: Run, predicted: Signals, noise: Mapping[str, float]
    ) -> Mapping[str, float]:
        """Standard deviation of every channel from the residual; `noise` is that used so far."""
        if not self.estimates_noise:
            return noise
        levels = {}
        for channel in self.channels(run):
            measured = run.signals[channel]
            white = white_level((measured - predicted[channel]) * run.weight(channel))
            levels[channel] = float(np.hypot(white, NUMERICS * np.sqrt(np.mean(measured**2))))
        return levels

    def deviation(
        self, run: Run, channel: str, measured: Array, predicted: Array, level: float | None
    ) -> Deviation:
        """Noise of one channel, sample by sample; estimated where its level is not given."""
        weight = np.maximum(run.weights.get(channel, np.ones(measured.size)), _LEAST_WEIGHT)
        if level is None:
            level = white_level((measured - predicted) * weight)
        least = _LEAST_NOISE * float(np.sqrt(np.mean(measured**2))) + 1e-300
        level = max(level, least)
        return Deviation(level / weight, level)

    def noise_floor(self, residuals: Sequence[ChannelResidual]) -> float:
        """Error over the signal that a model has that is right."""
        shares: dict[str, list[float]] = {}
        for one in residuals:
            if one.channel in self.reported_channels(one.run):
                level = max(one.run.level(one.channel), 1e-150)
                shares.setdefault(one.channel, []).append((one.noise / level) ** 2)
        return mean_over_channels(shares)

    def findings(self, residual: Residual) -> tuple[Finding, ...]:
        """What the diagnostics find in a residual."""
        return tuple(diagnostic(residual) for diagnostic in self.diagnostics)

    def leading(self, residual: Residual) -> Residual:
        """Return the part of a residual that is described first; all of it by default."""
        return residual

    def trials(self, measurement: Measurement, noise: Noise) -> Sequence[Trial]:
        """Measurements that might tell apart cases that fit alike; none by default."""
        return ()

    def information(
        self, trial: Trial, channel: str, weights: Array, predicted: Sequence[Array]
    ) -> float:
        """Information, bit, that a channel of a trial is expected to give of weighted cases."""
        return information_of_signals(weights, predicted, trial.noise[channel])

    def cuts(self, measurement: Measurement) -> Cuts:
        """Cuts to draw among lobes; that of the declared case by default."""
        cut = measurement.case.cut
        return Cuts(np.array([cut.spindle_speed]), np.array([cut.axial_depth]))

    def variable(self, name: str) -> Variable:
        """One of the variables, by name."""
        return next(one for one in self.variables if one.name == name)

    def require(self, measurement: Measurement) -> None:
        """Raise InputError where the case lacks a section, or a run a column, that is needed."""
        measurement.case.require(*self.sections)
        wanted = [" or ".join(group) for group in self.columns]
        problems = []
        for run in measurement.runs:
            missing = [
                words
                for words, group in zip(wanted, self.columns, strict=True)
                if not any(name in run.signals for name in group)
            ]
            if missing:
                problems.append(
                    f"{measurement.folder / run.name}: column {', '.join(missing)} is missing; "
                    f"there are {', '.join(run.signals)}; a run of kind {self.name} needs "
                    f"{', '.join(wanted)}"
                )
        if problems:
            raise InputError(problems)


def of_sections(case: Case, names: Collection[str]) -> Case:
    """Return a case with some of its sections alone, the others as where a file has none."""
    others = {
        name: field.get_default(call_default_factory=True)
        for name, field in Case.model_fields.items()
        if name not in names
    }
    return case.model_copy(update=others)


def mean_over_channels(squares: Mapping[str, Sequence[Any]]) -> float:
    """Mean over the channels of the root of the mean square of each."""
    return float(np.mean([np.sqrt(np.mean(values)) for values in squares.values()]))
