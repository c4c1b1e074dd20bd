"""Where the cutting tests lie that a case judges wrongly."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from chatter.description.units import rpm
from chatter.explain.kinds.stability import stability_margins
from chatter.explain.residuals.finding import Curve, Curves, Finding, Points
from chatter.explain.residuals.normalised_residual import Residual
from chatter.explain.residuals.ranks import rank_correlation

Array = NDArray[np.float64]

#: standard deviations by which wrong verdicts outnumber those of chance
_BEYOND = 3.0
#: probability of a chance finding of a rank correlation
_ALLOWED = 5e-3
_BINS = 8


class _Tests:
    """All tests of a measurement, with what a case says of them."""

    def __init__(self, residual: Residual) -> None:
        def column(name: str) -> Array:
            return np.concatenate([part.run.signals[name] for part in residual.parts])

        self.speed, self.depth = column("spindle_speed"), column("axial_depth")
        self.stable = column("stable") > 0.5
        self.likely = np.concatenate([part.predicted for part in residual.parts])
        self.wrong = self.stable != (self.likely > 0.5)
        #: above zero where a test is more stable than the case
        self.surprise = self.stable - self.likely


def misjudged(residual: Residual) -> Finding:
    """Number of tests judged wrongly against what scatter gives, and how far from the limit."""
    tests = _Tests(residual)
    chance = np.minimum(tests.likely, 1.0 - tests.likely)
    expected, spread = float(chance.sum()), math.sqrt(float(np.sum(chance * (1.0 - chance))))
    count = int(tests.wrong.sum())
    beyond = count > expected + _BEYOND * max(spread, 0.7)
    too_careful = int(np.sum(tests.wrong & tests.stable))
    margins = stability_margins(residual.case, tests.speed, tests.depth)
    far = float(np.median(np.abs(margins[tests.wrong]))) if count else 0.0
    says = (
        f"{count} of {tests.stable.size} tests are judged wrongly ({expected:.1f} by scatter "
        f"alone): {too_careful} held stable where the case says chatter, {count - too_careful} the "
        f"other way round, half of them farther than {100.0 * far:.0f} % of the depth from the "
        f"limit."
    )
    if not beyond:
        says = (
            f"{count} of {tests.stable.size} tests are judged wrongly, as scatter near the limit "
            f"gives ({expected:.1f})."
        )
    numbers = {
        "wrong": count,
        "by_chance": expected,
        "stable_though_predicted_chatter": too_careful,
        "median_distance_from_limit": far,
    }
    return Finding("wrong verdicts", says, beyond, numbers, _map_of(tests))


def _map_of(tests: _Tests) -> Points:
    right = ~tests.wrong
    classes = {
        "stable, as judged": right & tests.stable,
        "chatter, as judged": right & ~tests.stable,
        "stable, judged chatter": tests.wrong & tests.stable,
        "chatter, judged stable": tests.wrong & ~tests.stable,
    }
    points = {
        name: (rpm(tests.speed[chosen]), tests.depth[chosen] * 1e3)
        for name, chosen in classes.items()
    }
    return Points(points, "spindle speed [rpm]", "axial depth [mm]", logarithmic="y")


def over_speed(residual: Residual) -> Finding:
    """Whether tests are more or less stable than the case at some speeds."""
    tests = _Tests(residual)
    return _over(tests, rpm(tests.speed), "spindle speed", "rpm")


def over_depth(residual: Residual) -> Finding:
    """Whether tests are more or less stable than the case at some depths."""
    tests = _Tests(residual)
    return _over(tests, tests.depth * 1e3, "axial depth", "mm")


def _over(tests: _Tests, values: Array, name: str, unit: str) -> Finding:
    """Where tests of the verdict that is foretold worst are judged wrongly.

    Tests far above any limit chatter by every case: they would hide what the others tell.
    """
    too_careful = np.sum(tests.wrong & tests.stable) >= np.sum(tests.wrong & ~tests.stable)
    verdict, foretold = ("stable", "chatter") if too_careful else ("to chatter", "stable")
    chosen = tests.stable if too_careful else ~tests.stable
    x, surprise, wrong = values[chosen], tests.surprise[chosen], tests.wrong[chosen]
    found = rank_correlation(x, surprise)
    beyond = found.probability < _ALLOWED and wrong.any() and not wrong.all()
    says = name
    if beyond:
        bad, good = (
            f"{part.size} judged {words} lie at {part.min():.4g} to {part.max():.4g} {unit}"
            for part, words in ((x[wrong], foretold), (x[~wrong], "right"))
        )
        says = (
            f"Of the {x.size} tests found {verdict}, the {bad}, the {good} (rank correlation with "
            f"the {name} {found.coefficient:+.2f})."
        )
    cuts = [cut for cut in np.array_split(np.argsort(x), _BINS) if cut.size]
    middles = np.array([float(np.mean(x[cut])) for cut in cuts])
    means = np.array([float(np.mean(wrong[cut])) for cut in cuts])
    numbers = {
        "of_tests_found": verdict,
        "rank_correlation": found.coefficient,
        "probability_of_chance": found.probability,
        "share_judged_wrongly": [[float(m), float(y)] for m, y in zip(middles, means, strict=True)],
    }
    panel = Curves(
        (Curve(middles, 100.0 * means),),
        f"{name} [{unit}]",
        f"judged wrongly of those found {verdict} [%]",
        floor=0.0,
    )
    return Finding(name, says, bool(beyond), numbers, panel)
