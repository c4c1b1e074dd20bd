"""Residual over one variable: velocity, position, tooth angle and the like; periods in it."""

from collections.abc import Callable, Sequence

import numpy as np

from chatter.description.formatting import to_digits
from chatter.explain.residuals.finding import Curve, Curves, Finding
from chatter.explain.residuals.regression import Regression, best_period, best_regression, panel_of
from chatter.explain.residuals.residual import Residual
from chatter.explain.residuals.variables import Variable

Diagnostic = Callable[[Residual], Finding]

#: channels that are drawn
_SHOWN_CHANNELS = 2


def over_variable(name: str) -> Diagnostic:
    """Diagnostic of a residual over the variable of that name."""

    def diagnostic(residual: Residual) -> Finding:
        variable = residual.kind.variable(name)
        if not residual.above_noise:
            return Finding(variable.name, variable.label, False)
        found = [best_regression(residual, one, variable) for one in residual.above_noise]
        found.sort(key=lambda one: -one.found.share)
        shown = [one for one in found if one.found.significant]
        numbers = {
            one.target.channel: {
                "share": one.found.share,
                "form": one.target.form.name,
                "significant": one.found.significant,
            }
            for one in found
        }
        drawn = shown[:_SHOWN_CHANNELS] or found[:1]
        words = _sentence(variable, shown) if shown else variable.label
        return Finding(variable.name, words, bool(shown), numbers, panel_of(variable, drawn))

    return diagnostic


def _sentence(variable: Variable, regressions: Sequence[Regression]) -> str:
    shares = ", ".join(
        f"{to_digits(100.0 * one.found.share)} % of the residual of {one.target.channel}"
        for one in regressions
    )
    first = regressions[0]
    sure = np.abs(first.found.coefficients) - 2.0 * first.found.errors
    index = int(np.nanargmax(sure)) if np.any(np.isfinite(sure)) else 0
    where = f"{variable.reported(first.middles[index]):.3g} {variable.unit}".strip()
    depend = "depends" if len(regressions) == 1 else "depend"
    return (
        f"{shares} {depend} on {variable.label}: {first.target.channel} is most off at {where}, by "
        f"{first.coefficient(index)}."
    )


def over_period(name: str) -> Diagnostic:
    """Diagnostic of the periods of a residual in the variable of that name."""

    def diagnostic(residual: Residual) -> Finding:
        variable = residual.kind.variable(name)
        regression = best_period(residual, variable, residual.above_noise)
        title, words = f"period in {variable.name}", f"a period in {variable.label}"
        if regression is None:
            return Finding(title, words, False)
        target, found = regression
        length = found.length * variable.scale
        if found.significant:
            words = (
                f"{to_digits(100.0 * found.share)} % of {target.phrase} repeats over "
                f"{variable.label} with a period of {length:.3g} {variable.unit}."
            )
        numbers = {
            "channel": target.channel,
            "form": target.form.name,
            "period": found.length,
            "share": found.share,
        }
        panel = Curves(
            (Curve(found.lengths * variable.scale, 100.0 * found.shares),),
            f"period in {variable.heading}",
            f"share of the residual of {target.channel} [%]",
            {"period": (length,)} if found.significant else {},
            floor=0.0,
            logarithmic="x",
        )
        return Finding(title, words, found.significant, numbers, panel)

    return diagnostic
