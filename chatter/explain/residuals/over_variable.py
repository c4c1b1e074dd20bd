"""What is left over one variable: velocity, position, tooth angle and the like."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.explain.residuals.by_channel import above_noise
from chatter.explain.residuals.dependence import Dependence, Sample, dependence, edges_of, places_in
from chatter.explain.residuals.finding import Curve, Curves, Finding
from chatter.explain.residuals.normalised_residual import Residual
from chatter.explain.residuals.periods import Period, period_in
from chatter.explain.residuals.variables import FORMS, Form, Variable, named, told_unit

View = Callable[[Residual], Finding]
Array = NDArray[np.float64]

#: noise of a mean over which a sentence tells where it is largest
_SHOWN_CHANNELS = 2


class Tie(NamedTuple):
    """How one channel hangs on a variable in one form."""

    channel: str
    form: Form
    found: Dependence
    middles: Array


def over_variable(name: str) -> View:
    """View of a residual over the variable of that name."""

    def view(residual: Residual) -> Finding:
        variable = named(residual, name)
        channels = above_noise(residual, residual.channels)
        if not channels:
            return Finding(variable.name, variable.label, False)
        ties = [best_tie(residual, channel, variable) for channel in channels]
        shown = [tie for tie in ties if tie.found.beyond_chance]
        shown.sort(key=lambda tie: -tie.found.share)
        numbers = {
            tie.channel: {
                "share": tie.found.share,
                "form": tie.form.name,
                "beyond_chance": tie.found.beyond_chance,
            }
            for tie in ties
        }
        drawn = shown[:_SHOWN_CHANNELS] or [max(ties, key=lambda t: t.found.share)]
        return Finding(
            variable.name,
            _sentence(variable, shown) if shown else variable.label,
            bool(shown),
            numbers,
            panel_of(variable, drawn),
        )

    return view


def best_tie(residual: Residual, channel: str, variable: Variable) -> Tie:
    """Form in which a channel hangs on a variable most."""
    parts = residual.of(channel)
    values = [variable.of(part) for part in parts]
    edges = edges_of(np.concatenate(values))
    places = [places_in(v, edges) for v in values]
    middles = _means(np.concatenate(values), np.concatenate(places), edges)
    ties = []
    for form in FORMS[residual.kind.name]:
        samples = [
            Sample(part.scaled, form.weight(part) / part.deviation, place)
            for part, place in zip(parts, places, strict=True)
        ]
        ties.append(Tie(channel, form, dependence(samples, edges.size - 1), middles))
    return max(ties, key=lambda tie: (tie.found.beyond_chance, tie.found.share))


def _means(values: Array, places: Array, edges: Array) -> Array:
    """Mean of a variable in every bin, its middle where it holds nothing."""
    known = places >= 0
    counts = np.bincount(places[known], minlength=edges.size - 1)
    sums = np.bincount(places[known], weights=values[known], minlength=edges.size - 1)
    return np.where(counts > 0, sums / np.maximum(counts, 1), 0.5 * (edges[1:] + edges[:-1]))


def _sentence(variable: Variable, ties: list[Tie]) -> str:
    shares = ", ".join(
        f"{100.0 * tie.found.share:.2g} % of what is left of {tie.channel}" for tie in ties
    )
    first = ties[0]
    coefficients, middles = first.found.coefficients, first.middles
    sure = np.abs(coefficients) - 2.0 * first.found.errors
    place = int(np.nanargmax(sure)) if np.any(np.isfinite(sure)) else 0
    where = f"{variable.told(middles[place]):.3g} {variable.unit}".strip()
    return (
        f"{shares} hang{'s' if len(ties) == 1 else ''} on {variable.label}: {first.channel} is "
        f"most off at {where}, by {size_of(first, place)}."
    )


def size_of(tie: Tie, place: int) -> str:
    """Coefficient of a bin, in words."""
    value = float(tie.found.coefficients[place])
    if tie.form.relative:
        return f"{100.0 * value:+.2g} % of what is predicted"
    unit, scale = told_unit(tie.channel)
    words = f"{value * scale:+.3g} {unit}"
    return f"{words} {tie.form.says}".strip()


def y_label(tie: Tie) -> str:
    """Of the coefficients of a tie."""
    if tie.form.relative:
        return f"left of {tie.channel} [% of predicted]"
    unit = told_unit(tie.channel)[0]
    return f"left of {tie.channel}{' x direction' if tie.form.name != 'added' else ''} [{unit}]"


def told_scale(tie: Tie) -> float:
    """Coefficients as told over SI."""
    return 100.0 if tie.form.relative else told_unit(tie.channel)[1]


def panel_of(variable: Variable, ties: list[Tie]) -> Curves:
    """Means over the bins of a variable."""
    label = y_label(ties[0])
    alike = [tie for tie in ties if y_label(tie).split("[")[1] == label.split("[")[1]]
    curves = tuple(
        Curve(
            variable.told(tie.middles),
            tie.found.coefficients * told_scale(tie),
            y_label(tie).split(" [")[0],
            tie.found.errors * told_scale(tie),
        )
        for tie in alike
    )
    unit = f" [{variable.unit}]" if variable.unit else ""
    words = label if len(curves) == 1 else f"left [{label.split('[')[1]}"
    scale = "x" if variable.logarithmic else ""
    return Curves(curves, f"{variable.name}{unit}", words, floor=0.0, logarithmic=scale)


# periods -----------------------------------------------------------------------------------------

#: samples a period at the speed at which most is recorded
_SAMPLES_A_PERIOD = 3.0
#: periods over the range of the variable
_MOST_PERIODS = 300.0
#: over the feed per tooth, at which the cut looks at the work
_TEETH = 2.5


def shortest_period(residual: Residual, variable: Variable) -> float:
    """Shortest period in a variable that the samples and the kind of motion can tell, m."""
    parts = residual.of(residual.channels[0])
    if variable.name == "feed way":
        return _TEETH * max(part.case.cut.feed_per_tooth for part in parts)
    longest, travelled = 0.0, []
    for part in parts:
        values = variable.of(part)
        longest = max(longest, float(np.ptp(values)))
        travelled.append(np.abs(np.diff(values)))
    steps = np.concatenate(travelled)
    moving = steps[steps > 0.05 * steps.max()]
    return max(_SAMPLES_A_PERIOD * float(np.median(moving)), longest / _MOST_PERIODS)


class PeriodTie(NamedTuple):
    """Period of a channel in a variable, in one form."""

    channel: str
    form: Form
    found: Period


def best_period(
    residual: Residual, variable: Variable, channels: Sequence[str]
) -> PeriodTie | None:
    """Channel and form with the clearest period in a variable, or None where there is none."""
    shortest = shortest_period(residual, variable)
    ties = []
    for channel in channels:
        parts = residual.of(channel)
        values = [variable.of(part) for part in parts]
        own = None
        if variable.name == "feed way":
            own = [part.case.tool.teeth * part.case.cut.feed_per_tooth for part in parts]
        for form in FORMS[residual.kind.name]:
            weight = [form.weight(part) / part.deviation for part in parts]
            found = period_in([p.scaled for p in parts], weight, values, shortest, own)
            if found is not None:
                ties.append(PeriodTie(channel, form, found))
    if not ties:
        return None
    return max(ties, key=lambda tie: (tie.found.beyond_chance, tie.found.share))


def over_period(name: str) -> View:
    """View of the periods of a residual in the variable of that name."""

    def view(residual: Residual) -> Finding:
        variable = named(residual, name)
        tie = best_period(residual, variable, above_noise(residual, residual.channels))
        view_name = f"period in {variable.name}"
        if tie is None:
            return Finding(view_name, f"a period in {variable.label}", False)
        found = tie.found
        beyond = found.beyond_chance
        form = f", taken {tie.form.says}," if tie.form.says else ""
        says = f"a period in {variable.label}"
        if beyond:
            says = (
                f"{100.0 * found.share:.2g} % of what is left of {tie.channel}{form} "
                f"repeats over {variable.label} with a period of "
                f"{found.length * variable.scale:.3g} {variable.unit}."
            )
        numbers = {
            "channel": tie.channel,
            "form": tie.form.name,
            "period": found.length,
            "share": found.share,
        }
        curve = Curve(found.lengths * variable.scale, 100.0 * found.shares)
        panel = Curves(
            (curve,),
            f"period in {variable.name} [{variable.unit}]",
            f"share of what is left of {tie.channel} [%]",
            {"period": (found.length * variable.scale,)} if beyond else {},
            floor=0.0,
            logarithmic="x",
        )
        return Finding(view_name, says, beyond, numbers, panel)

    return view
