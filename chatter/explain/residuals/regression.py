"""Regression of a residual on one variable or on a period in it, in the form that suits best."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.description.formatting import signed
from chatter.explain.residuals.channel_residual import ChannelResidual
from chatter.explain.residuals.dependence import Dependence, Sample, bins_of, dependence, edges_of
from chatter.explain.residuals.finding import Curve, Curves
from chatter.explain.residuals.periods import Period, period_in
from chatter.explain.residuals.residual import Residual
from chatter.explain.residuals.variables import Form, Variable, reported_unit

Array = NDArray[np.float64]

#: samples a period at the speed at which most is recorded
_SAMPLES_A_PERIOD = 3.0
#: periods over the range of the variable
_MOST_PERIODS = 300.0
#: over the feed per tooth, the interval at which a cut samples the workpiece
_TEETH = 2.5


class Target(NamedTuple):
    """What is regressed: a channel in a form; how its coefficients are reported."""

    channel: str
    form: Form

    @property
    def unit(self) -> str:
        """Unit in which coefficients are reported."""
        return "% of predicted" if self.form.relative else reported_unit(self.channel)[0]

    @property
    def scale(self) -> float:
        """Coefficients as reported over SI."""
        return 100.0 if self.form.relative else reported_unit(self.channel)[1]

    @property
    def name(self) -> str:
        """Of the coefficients, in pictures."""
        along = "" if self.form.relative or self.form.name == "added" else " x direction"
        return f"residual of {self.channel}{along}"

    @property
    def label(self) -> str:
        """Name with the unit."""
        return f"{self.name} [{self.unit}]"

    @property
    def phrase(self) -> str:
        """In sentences: "the residual of Fx, as a share of what is predicted,"."""
        form = f", {self.form.description}," if self.form.description else ""
        return f"the residual of {self.channel}{form}"

    def sample(self, part: ChannelResidual, bins: NDArray[np.intp]) -> Sample:
        """One run, for a dependence."""
        return Sample(part.normalised, self.form.weight(part) / part.deviation, bins)


class Regression(NamedTuple):
    """How a channel depends on a variable in one form."""

    target: Target
    found: Dependence
    middles: Array  # (bins,), mean of the variable in every bin, SI

    def coefficient(self, index: int) -> str:
        """Coefficient of a bin, in words."""
        target, value = self.target, float(self.found.coefficients[index])
        if target.form.relative:
            return f"{signed(target.scale * value, 2)} % of what is predicted"
        return f"{signed(target.scale * value, 3)} {target.unit} {target.form.description}".strip()

    def curve(self, variable: Variable) -> Curve:
        """Coefficients over the variable, with their standard errors, as reported."""
        return Curve(
            variable.reported(self.middles),
            self.found.coefficients * self.target.scale,
            self.target.name,
            self.found.errors * self.target.scale,
        )


class PeriodRegression(NamedTuple):
    """Period of a channel in a variable, in one form."""

    target: Target
    found: Period


def best_regression(residual: Residual, channel: str, variable: Variable) -> Regression:
    """Regression of a channel on a variable in the form that explains most."""
    parts = residual.of(channel)
    values = [variable.of(part) for part in parts]
    edges = edges_of(np.concatenate(values))
    bins = [bins_of(v, edges) for v in values]
    middles = _means(np.concatenate(values), np.concatenate(bins), edges)
    regressions = []
    for form in residual.kind.forms:
        target = Target(channel, form)
        samples = [target.sample(part, own) for part, own in zip(parts, bins, strict=True)]
        regressions.append(Regression(target, dependence(samples, edges.size - 1), middles))
    return max(regressions, key=lambda one: (one.found.significant, one.found.share))


def _means(values: Array, bins: NDArray[np.intp], edges: Array) -> Array:
    """Mean of a variable in every bin, its middle where it holds nothing."""
    known = bins >= 0
    counts = np.bincount(bins[known], minlength=edges.size - 1)
    sums = np.bincount(bins[known], weights=values[known], minlength=edges.size - 1)
    return np.where(counts > 0, sums / np.maximum(counts, 1), 0.5 * (edges[1:] + edges[:-1]))


def panel_of(variable: Variable, regressions: Sequence[Regression], x_label: str = "") -> Curves:
    """Coefficients of regressions whose units are those of the first."""
    first = regressions[0].target
    alike = [one for one in regressions if one.target.unit == first.unit]
    return Curves(
        tuple(one.curve(variable) for one in alike),
        x_label or variable.heading,
        first.label if len(alike) == 1 else f"residual [{first.unit}]",
        floor=0.0,
        logarithmic="x" if variable.logarithmic and not x_label else "",
    )


def best_period(
    residual: Residual, variable: Variable, channels: Sequence[str]
) -> PeriodRegression | None:
    """Channel and form with the clearest period in a variable, or None where there is none."""
    shortest = _shortest_period(residual, variable)
    regressions = []
    for channel in channels:
        parts = residual.of(channel)
        values = [variable.of(part) for part in parts]
        own = [variable.own_period(part) for part in parts] if variable.own_period else None
        for form in residual.kind.forms:
            weight = [form.weight(part) / part.deviation for part in parts]
            found = period_in([p.normalised for p in parts], weight, values, shortest, own)
            if found is not None:
                regressions.append(PeriodRegression(Target(channel, form), found))
    return max(regressions, key=lambda one: (one.found.significant, one.found.share), default=None)


def _shortest_period(residual: Residual, variable: Variable) -> float:
    """Shortest period in a variable that the samples and the kind of motion resolve, m."""
    parts = residual.of(residual.channels[0])
    if variable.own_period is not None:
        return _TEETH * max(variable.own_period(part) / part.case.tool.teeth for part in parts)
    values = [variable.of(part) for part in parts]
    longest = max(float(np.ptp(one)) for one in values)
    steps = np.concatenate([np.abs(np.diff(one)) for one in values])
    moving = steps[steps > 0.05 * steps.max()]
    return max(_SAMPLES_A_PERIOD * float(np.median(moving)), longest / _MOST_PERIODS)
