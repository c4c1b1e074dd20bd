"""Where the cutting tests lie that a case misclassifies."""

import math

import numpy as np
from numpy.typing import NDArray

from chatter.description.units import rpm
from chatter.explain.residuals.channel_residual import ChannelResidual
from chatter.explain.residuals.finding import Curve, Curves, Finding, Points
from chatter.explain.residuals.over_runs import rank_correlation
from chatter.explain.residuals.residual import Residual
from chatter.explain.stability_margin import limits_over, response_of_tests, tests_of

Array = NDArray[np.float64]

#: standard deviations by which wrong verdicts outnumber those of chance
_BEYOND = 3.0
#: significance level of a rank correlation
_SIGNIFICANCE = 5e-3
_BINS = 8
#: points of the limit that is drawn among tests, and depths over the shallowest and deepest test
_SPEEDS, _DEPTHS, _AROUND = 80, 40, (0.5, 1.6)


class _Tests:
    """All tests of a measurement, with what a case predicts of them."""

    def __init__(self, residual: Residual) -> None:
        parts = residual.of("stable")

        def column(name: str) -> Array:
            return np.concatenate([part.run.signals[name] for part in parts])

        self.case = parts[0].case
        self.speed, self.depth = column("spindle_speed"), column("axial_depth")
        self.stable = column("stable") > 0.5
        self.likely = np.concatenate([part.predicted for part in parts])
        self.misclassified = self.stable != (self.likely > 0.5)
        #: above zero where a test is more stable than the case
        self.surprise = self.stable - self.likely


def misclassified(residual: Residual) -> Finding:
    """Number of misclassified tests against what scatter gives, and how far from the limit."""
    tests = _Tests(residual)
    chance = np.minimum(tests.likely, 1.0 - tests.likely)
    expected, spread = float(chance.sum()), math.sqrt(float(np.sum(chance * (1.0 - chance))))
    count = int(tests.misclassified.sum())
    beyond = count > expected + _BEYOND * max(spread, 0.7)
    too_careful = int(np.sum(tests.misclassified & tests.stable))
    margins = np.concatenate([margins_of(part) for part in residual.of("stable")])
    far = float(np.median(np.abs(margins[tests.misclassified]))) if count else 0.0
    description = (
        f"{count} of {tests.stable.size} tests are misclassified ({expected:.1f} by scatter "
        f"alone): {too_careful} were stable where the case predicts chatter, {count - too_careful} "
        f"the other way round, half of them farther than {100.0 * far:.0f} % of the depth from the "
        f"limit."
    )
    if not beyond:
        description = (
            f"{count} of {tests.stable.size} tests are misclassified, as scatter near the limit "
            f"gives ({expected:.1f})."
        )
    numbers = {
        "misclassified": count,
        "expected_by_scatter": expected,
        "stable_though_predicted_chatter": too_careful,
        "median_distance_from_limit": far,
    }
    return Finding("misclassified tests", description, beyond, numbers, _map_of(tests))


def margins_of(part: ChannelResidual) -> Array:
    """Margins of the tests of a run by its case."""
    return response_of_tests(part.case, tests_of(part.case, part.run.signals)).margin


def _map_of(tests: _Tests) -> Points:
    right = ~tests.misclassified
    classes = {
        "stable, as predicted": right & tests.stable,
        "chatter, as predicted": right & ~tests.stable,
        "stable, predicted chatter": tests.misclassified & tests.stable,
        "chatter, predicted stable": tests.misclassified & ~tests.stable,
    }
    points = {
        name: (rpm(tests.speed[chosen]), tests.depth[chosen] * 1e3)
        for name, chosen in classes.items()
    }
    axes = "spindle speed [rpm]", "axial depth [mm]"
    return Points(points, *axes, logarithmic="y", curve=_limit_of(tests))


def _limit_of(tests: _Tests) -> Curve:
    """Limit of the case over the speeds and depths of the tests."""
    speeds = np.linspace(tests.speed.min(), tests.speed.max(), _SPEEDS)
    depths = np.geomspace(_AROUND[0] * tests.depth.min(), _AROUND[1] * tests.depth.max(), _DEPTHS)
    limits = limits_over(tests.case, speeds, depths)
    shown = np.where(np.isfinite(limits), 1e3 * limits, np.nan)
    return Curve(rpm(speeds), shown, label="limit of the case")


def over_speed(residual: Residual) -> Finding:
    """Whether tests are more or less stable than the case at some speeds."""
    tests = _Tests(residual)
    return _over(tests, rpm(tests.speed), "spindle speed", "rpm")


def over_depth(residual: Residual) -> Finding:
    """Whether tests are more or less stable than the case at some depths."""
    tests = _Tests(residual)
    return _over(tests, tests.depth * 1e3, "axial depth", "mm")


def _over(tests: _Tests, values: Array, name: str, unit: str) -> Finding:
    """Where tests of the verdict that is predicted worst are misclassified.

    Tests far above any limit chatter by every case: they would hide what the others show.
    """
    stable = tests.stable[tests.misclassified]
    too_careful = stable.sum() >= (~stable).sum()
    verdict, predicted = ("stable", "chatter") if too_careful else ("to chatter", "stable")
    chosen = tests.stable if too_careful else ~tests.stable
    x, surprise, wrong = values[chosen], tests.surprise[chosen], tests.misclassified[chosen]
    found = rank_correlation(x, surprise)
    beyond = found.probability < _SIGNIFICANCE and wrong.any() and not wrong.all()
    description = name
    if beyond:
        bad, good = (
            f"{part.size} predicted {words} lie at {part.min():.4g} to {part.max():.4g} {unit}"
            for part, words in ((x[wrong], predicted), (x[~wrong], "rightly"))
        )
        description = (
            f"Of the {x.size} tests found {verdict}, the {bad}, the {good} (rank correlation with "
            f"the {name} {found.coefficient:+.2f})."
        )
    cuts = [cut for cut in np.array_split(np.argsort(x), _BINS) if cut.size]
    middles = np.array([float(np.mean(x[cut])) for cut in cuts])
    means = np.array([float(np.mean(wrong[cut])) for cut in cuts])
    numbers = {
        "verdict": verdict,
        "rank_correlation": found.coefficient,
        "p_value": found.probability,
        "misclassified_share": [[float(m), float(y)] for m, y in zip(middles, means, strict=True)],
    }
    panel = Curves(
        (Curve(middles, 100.0 * means),),
        f"{name} [{unit}]",
        f"misclassified of those found {verdict} [%]",
        floor=0.0,
    )
    return Finding(name, description, bool(beyond), numbers, panel)
