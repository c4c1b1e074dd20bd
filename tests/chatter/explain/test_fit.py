"""Least squares with priors: steps that fail, values known by a factor, starts elsewhere."""

import math

import numpy as np
import pytest

from chatter.description.case import loads
from chatter.explain.fitting import LeastSquares
from chatter.explain.kinds.kind import Kind
from chatter.explain.measurement import Measurement, Run
from chatter.explain.parameters import KnownByFactor, Parameter, with_priors, within_reach
from chatter.explain.prediction import Predictions
from chatter.explain.selection.other_starts import fit_from_elsewhere
from chatter.explain.selection.problem import Problem
from chatter.explain.selection.split import split_runs

TIME = np.arange(0.0, 2.0, 1e-3)
#: frequency, Hz, that is declared, its standard deviation, and what it is
DECLARED, DEVIATION, TRUE = 20.0, 1.0, 21.7
MODE = """
[tool]
teeth = 2
diameter = "12 mm"
[[structure.mode]]
frequency = "900 Hz"
damping = 0.04
mass = "1 kg"
direction = [1, 0, 0]
"""


def test_a_fit_goes_on_where_several_steps_are_too_long():
    """An arctangent flattens so that linear steps from 40 widths away end far beyond it."""
    problem = LeastSquares(
        [Parameter("x", 2.0, 1.0, prior=False)],
        lambda x: np.full(50, 20.0) * np.arctan(x[0] / 0.05),
    )
    found = problem.fit(np.array([2.0]))
    assert found.values[0] == pytest.approx(0.0, abs=1e-3)


def test_a_near_fit_ends_within_a_standard_deviation_and_a_fit_goes_on():
    """Steps halve x where residuals grow with its square; the least sum is that of the noise."""
    noise = np.tile([1.0, -1.0], 50)
    least = noise @ noise
    near, whole = LeastSquares.near_fit, LeastSquares.fit
    asked = {near: 0, whole: 0}
    above = {}
    for method in asked:

        def residuals(x, method=method):
            asked[method] += 1
            return noise + x[0] ** 2

        problem = LeastSquares([Parameter("x", 4.0, 1.0, prior=False)], residuals)
        found = method(problem, np.array([4.0]))
        above[method] = found.cost - least
    assert 0.03 < above[near] < 1.0
    assert above[whole] < 0.03
    assert asked[near] < asked[whole]


def test_a_value_known_by_a_factor_is_pulled_by_its_logarithm():
    """One measurement of y = 3 x that is as certain as the declared x."""
    one = KnownByFactor("x", 2.0, 0.4, 0.5, 8.0)
    unit = math.log(1.2)
    target = 2.0 * 1.2**2  # two factors up: known as well from both, it ends half way
    found = LeastSquares([one], lambda x: np.log(x / target) / unit).fit(np.array([2.0]))
    assert found.values[0] == pytest.approx(2.0 * 1.2, rel=1e-4)
    assert found.pulls["x"] == pytest.approx(1.0, rel=1e-3)
    assert found.log_prior == pytest.approx(-0.5, rel=1e-3)
    # two independent values of the logarithm: half the variance
    assert math.sqrt(found.covariance[0, 0]) == pytest.approx(2.4 * unit / math.sqrt(2.0), rel=1e-3)


def test_half_a_damping_is_as_far_as_twice_of_it(tmp_path):
    case = loads(MODE, "case.toml")
    measured = Measurement("frf", "taps", tmp_path, case, (), {})
    paths = ["structure.mode[0].damping", "structure.mode[0].frequency"]
    damping, frequency = within_reach(with_priors(measured, paths))
    assert damping.counted(0.02) == pytest.approx(-damping.counted(0.08))
    assert damping.counted(0.048) == pytest.approx(1.0)
    assert frequency.counted(882.0) == pytest.approx(-1.0)


class Tone(Kind):
    """Force that is a tone of the frequency that a case holds; noise of a hundredth."""

    name = "axis"
    columns = ()
    estimates_noise = False

    def channels(self, run):
        return ("force",)

    def known_noise(self, run):
        return {"force": 0.01}

    def nuisance_parameters(self, measurement):
        return [Parameter("axis.offset", DECLARED, DEVIATION, 10.0, 30.0)]

    def predict(self, case, run):
        return {"force": np.sin(2.0 * math.pi * case.axis.offset * TIME)}


def test_a_fit_beside_a_large_misfit_leaves_its_false_minimum(tmp_path):
    """The sum of squares of two tones has a minimum every half hertz."""
    case = loads('title = "tone"\n[axis]\nmoving_mass = "20 kg"')
    random, runs = np.random.default_rng(3), []
    for number in range(3):
        force = np.sin(2.0 * math.pi * TRUE * TIME) + 0.01 * random.standard_normal(TIME.size)
        runs.append(Run(f"{number}.csv", {}, {"time": TIME, "force": force}))
    measured = Measurement("axis", "tones", tmp_path, case, tuple(runs))
    kind = Tone()
    noise = {run.name: kind.first_noise(run) for run in runs}
    problem = Problem(measured, Predictions(kind), noise)
    split = split_runs(measured)
    near = problem.fit(split.fitted, {})
    assert near.values[0] != pytest.approx(TRUE, abs=0.1)
    found = fit_from_elsewhere(problem, near, split)
    assert found.values[0] == pytest.approx(TRUE, abs=1e-3)
    # what is at the noise is left as it is
    assert fit_from_elsewhere(problem, found, split) is found


class Twofold(Tone):
    """Force that is the same for a value a below a middle and one as far above it."""

    middle = 17.0

    def predict(self, case, run):
        return {"force": (case.axis.offset - self.middle) ** 2 * np.sin(TIME)}


@pytest.mark.parametrize("true", [20.0, 20.4])
def test_declared_values_out_of_tolerance_are_put_back_where_that_fits_as_well(tmp_path, true):
    """Both roots are at the noise; one is six tolerances away from what is declared."""
    case = loads('title = "twofold"\n[axis]\nmoving_mass = "20 kg"')
    random, kind, runs = np.random.default_rng(4), Twofold(), []
    for number in range(3):
        force = (true - kind.middle) ** 2 * np.sin(TIME) + 0.01 * random.standard_normal(TIME.size)
        runs.append(Run(f"{number}.csv", {}, {"time": TIME, "force": force}))
    measured = Measurement("axis", "twofold", tmp_path, case, tuple(runs))
    noise = {run.name: kind.first_noise(run) for run in runs}
    problem, split = Problem(measured, Predictions(kind), noise), split_runs(measured)
    mirrored = problem.fit(split.fitted, {"axis.offset": 2.0 * kind.middle - true})
    assert mirrored.values[0] == pytest.approx(2.0 * kind.middle - true, abs=1e-2)
    assert abs(mirrored.pulls["axis.offset"]) > 3.0
    found = fit_from_elsewhere(problem, mirrored, split)
    assert found.values[0] == pytest.approx(true, abs=1e-2)
