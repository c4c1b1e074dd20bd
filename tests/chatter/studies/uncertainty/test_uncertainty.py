"""Uncertain values to a band of limits and a probability."""

import csv
import json
import math
import re
import threading

import numpy as np
import pytest
from scipy.stats import norm, truncnorm

from chatter.description.case import loads
from chatter.description.errors import InputError, RunError
from chatter.engine.parallel import SerialExecutor
from chatter.studies import executor
from chatter.studies.uncertainty import monte_carlo as module
from chatter.studies.uncertainty.latin_hypercube import samples
from chatter.studies.uncertainty.monte_carlo import uncertainty
from chatter.studies.uncertainty.uncertain_parameters import (
    UncertainParameter,
    correlation_of,
    parameters_of,
)
from tests.cases import TOOL_OF_922_HERTZ
from tests.command_line import chatter_command

ONE_DIRECTION = (
    TOOL_OF_922_HERTZ.replace('"600 MPa"', '"600 +- 60 MPa"')
    .replace('"200 MPa"', "0")
    .replace('"down"', '"up"')
)
TEXT = f"""{ONE_DIRECTION}
[lobes]
speeds = {{ from = "8000 rpm", to = "12000 rpm", count = 9 }}
depths = {{ to = "6 mm", count = 40 }}
method = "zero-order"
"""
FEW = {"speeds": 3}


@pytest.fixture
def case():
    return loads(TEXT)


def limit_of(case, **patch):
    """Limit at the speed of the cut, m."""
    fixed = {path.replace("__", "."): value for path, value in patch.items()}
    from chatter.studies.uncertainty.sample_limits import sample_limits, shared_grid

    changed = case.patch({"material.Ktc": case.get("material.Ktc"), **fixed})
    return sample_limits(changed, shared_grid(case, 3), None).operating


def test_a_force_coefficient_propagates_by_its_reciprocal(case):
    """The limit is c / Ktc: its quantiles are those of Ktc, from the other end."""
    found = uncertainty(case, 150, **FEW)
    product = limit_of(case) * 600e6
    assert found.operating == pytest.approx(product / found.values[:, 0], rel=1e-4)
    for level, got in zip((0.05, 0.5, 0.95), found.operating_quantiles(), strict=True):
        exact = product / norm.ppf(1.0 - level, 600e6, 60e6)
        assert got == pytest.approx(exact, rel=0.015)
    # P(c / Ktc > depth) = P(Ktc < c / depth)
    depth = product / 660e6
    shallow = uncertainty(case.patch({"cut.axial_depth": depth}), 150, **FEW)
    exact = norm.cdf(1.0)
    low, high = shallow.interval
    assert low < exact < high
    assert shallow.probability == pytest.approx(exact, abs=0.02)


def test_small_deviations_give_the_variance_of_first_order(case):
    """Delta method: sum of (slope times deviation) squared, by central differences."""
    deviations = {
        "material.Ktc": (600e6, 6e6),
        "structure.mode[0].damping": (0.011, 1e-4),
        "structure.mode[0].mass": (0.03993, 4e-4),
    }
    # a frequency kept while the mass varies: all three move the limit smoothly
    given = {path: f"{mean!r} +- {one!r} " for path, (mean, one) in deviations.items()}
    units = {"material.Ktc": "Pa", "structure.mode[0].damping": "", "structure.mode[0].mass": "kg"}
    uncertain = case.patch({path: text + units[path] for path, text in given.items()})
    found = uncertainty(uncertain, 200, **FEW)
    variance = 0.0
    for path, (mean, deviation) in deviations.items():
        ends = []
        for sign in (-1.0, 1.0):
            plain = {other: mid for other, (mid, _) in deviations.items()}
            changed = uncertain.patch({**plain, path: mean + sign * deviation})
            ends.append(limit_of(changed, material__Ktc=changed.get("material.Ktc")))
        variance += (0.5 * (ends[1] - ends[0])) ** 2
    assert found.operating.std(ddof=1) == pytest.approx(math.sqrt(variance), rel=0.08)
    shares = found.shares()
    assert sum(shares.values()) == pytest.approx(1.0, abs=0.1)


def test_the_same_seed_gives_the_same_samples_and_another_does_not(case):
    parameters = parameters_of(case)
    first = samples(parameters, 120, 3)
    assert np.array_equal(first, samples(parameters, 120, 3))
    # more samples go on where fewer ended
    assert np.array_equal(first, samples(parameters, 300, 3)[:120])
    assert not np.array_equal(first, samples(parameters, 120, 4))


def test_signs_and_bounds_hold():
    case = loads(TEXT.replace("damping = 0.011", 'damping = "0.011 +- 0.02"'))
    found = {one.path: one for one in parameters_of(case)}
    damping = found["structure.mode[0].damping"]
    assert (damping.low, damping.high) == (0.0, 1.0)
    values = samples([damping], 1000, 1)[:, 0]
    assert values.min() > 0.0
    exact = truncnorm(-0.011 / 0.02, (1.0 - 0.011) / 0.02, 0.011, 0.02)
    assert values.mean() == pytest.approx(exact.mean(), rel=0.015)
    assert values.std() == pytest.approx(exact.std(), rel=0.02)
    negative = UncertainParameter("a", -1.0, 1.0, -np.inf, 0.0)
    assert samples([negative], 100, 1).max() < 0.0


def test_probability_converges_at_least_as_one_over_the_root_of_the_count():
    """Error of P(a + b < 1) over seeds, against that of independent samples."""
    parameters = [UncertainParameter(name, 0.0, 1.0) for name in "ab"]
    exact = norm.cdf(1.0 / math.sqrt(2.0))
    spread = {}
    for count in (50, 800):
        shares = [
            float(np.mean(samples(parameters, count, seed).sum(axis=1) < 1.0)) for seed in range(60)
        ]
        spread[count] = float(np.sqrt(np.mean((np.array(shares) - exact) ** 2)))
        independent = math.sqrt(exact * (1.0 - exact) / count)
        assert spread[count] < independent
    # 16 times the samples: a quarter of the error, within what 60 seeds tell of it
    assert spread[50] / spread[800] == pytest.approx(4.0, rel=0.35)


def test_files_and_resumption(case, tmp_path, monkeypatch):
    real, calls = module.sample_limits, []

    def limits(*args):
        if len(calls) == 7:
            raise KeyboardInterrupt
        calls.append(args)
        return real(*args)

    with monkeypatch.context() as patch:
        patch.setattr(module, "sample_limits", limits)
        with pytest.raises(RunError, match=r"[1-7] of 30 samples are finished") as interrupted:
            uncertainty(case, 30, folder=tmp_path, **FEW)
    finished = int(re.search(r"(\d) of 30", str(interrupted.value))[1])
    told = []
    found = uncertainty(case, 30, folder=tmp_path, resumed=lambda *a: told.append(a), **FEW)
    assert told == [(finished, 30)]
    assert np.array_equal(found.limits, uncertainty(case, 30, **FEW).limits)
    found.save(tmp_path)
    rows = list(csv.DictReader((tmp_path / "uncertainty.csv").read_text().splitlines()))
    assert [float(row["spindle_speed [rpm]"]) for row in rows] == [8000.0, 10000.0, 12000.0]
    for row, limits in zip(rows, found.quantiles().T * 1e3, strict=True):
        got = [float(row[f"limit_{level}_percent [mm]"]) for level in (5, 50, 95)]
        assert got == pytest.approx(limits, rel=1e-6)
        assert got == sorted(got)
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["operating_point"]["probability_of_stability"] == found.probability
    assert summary["convergence"][-1]["samples"] == 30
    assert len((tmp_path / "samples.csv").read_text().splitlines()) == 31
    assert (tmp_path / "uncertainty.png").stat().st_size > 10_000


def test_samples_are_computed_side_by_side(case, monkeypatch):
    """Sweeps of one sample after the other left a processor idle between them."""
    together = threading.Barrier(2, timeout=60.0)
    real = module.sample_limits

    def limits(*args):
        together.wait()
        return real(*args)

    monkeypatch.setattr(executor, "worker_count", lambda: 2)
    monkeypatch.setattr(module, "sample_limits", limits)
    side_by_side = uncertainty(case, 4, **FEW)
    monkeypatch.setattr(module, "sample_limits", real)
    one_by_one = uncertainty(case, 4, cluster=SerialExecutor(), **FEW)
    assert np.array_equal(side_by_side.limits, one_by_one.limits)


def test_limits_that_are_not_found_stay_above_all_others():
    limits = np.array([[1.0], [2.0], [3.0], [np.inf]])
    low, middle, high = module._quantiles(limits, (0.0, 0.5, 0.95))[:, 0]
    assert (low, middle, high) == (1.0, 2.5, np.inf)


def test_wrong_input_is_told(case):
    with pytest.raises(InputError, match="no value is uncertain"):
        uncertainty(case.patch({"material.Ktc": "600 MPa"}), 10)
    with pytest.raises(InputError, match="--samples 1"):
        uncertainty(case, 1)


def test_the_command(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(TEXT)
    words = ["uncertainty", path, "--samples", 20, "--speeds", 3, "--out", tmp_path / "out"]
    result = chatter_command(*words)
    assert result.exit_code == 0, result.output
    assert "is stable with a probability of" in result.stdout
    # 1 / Ktc is nearly straight
    assert re.search(r"material.Ktc: (9\d|100) % of its variance", result.stdout)
    wrong = chatter_command("uncertainty", path, "--set", "material.Ktc=600 MPa", "--out", tmp_path)
    assert wrong.exit_code == 2
    assert "no value is uncertain" in wrong.stderr


BOTH = {
    "material.Krc": "200 +- 30 MPa",
    "uncertainty.correlation": [{"between": ["material.Ktc", "material.Krc"], "coefficient": 0.8}],
}


@pytest.mark.parametrize("coefficient", [-0.6, 0.8])
def test_correlated_samples(case, coefficient):
    """Correlation as asked for, and each value's hypercube as without."""
    pair = {"between": ["material.Ktc", "material.Krc"], "coefficient": coefficient}
    both = case.patch({**BOTH, "uncertainty.correlation": [pair]})
    parameters = parameters_of(both)
    matrix = correlation_of(both, parameters)
    found = samples(parameters, 1000, 3, matrix)
    assert np.corrcoef(found.T)[0, 1] == pytest.approx(coefficient, abs=0.03)
    apart = samples(parameters, 1000, 3)
    assert abs(np.corrcoef(apart.T)[0, 1]) < 0.1
    assert np.sort(found, axis=0) == pytest.approx(np.sort(apart, axis=0))


def test_correlation_widens_the_band(case):
    """The zeroth-order limit falls as 1/Kt at a fixed ratio Kr/Kt: what goes together adds up."""
    wide = uncertainty(case.patch(BOTH), 100, seed=1, **FEW)
    apart = uncertainty(case.patch({"material.Krc": "200 +- 30 MPa"}), 100, seed=1, **FEW)
    assert np.std(wide.operating) > 1.05 * np.std(apart.operating)


@pytest.mark.parametrize(
    ("pairs", "words"),
    [
        (
            [{"between": ["material.Ktc", "cut.axial_depth"], "coefficient": 0.5}],
            ["uncertainty.correlation[0].between[1]", "cut.axial_depth", "material.Krc"],
        ),
        (
            [{"between": ["material.Ktc", "material.Ktc"], "coefficient": 0.5}],
            ["uncertainty.correlation[0].between", "twice"],
        ),
        (
            [
                {"between": ["material.Ktc", "material.Krc"], "coefficient": 0.9},
                {"between": ["material.Krc", "structure.mode[0].damping"], "coefficient": 0.9},
                {"between": ["material.Ktc", "structure.mode[0].damping"], "coefficient": -0.9},
            ],
            ["uncertainty.correlation", "no distribution"],
        ),
    ],
)
def test_correlations_that_cannot_be(case, pairs, words):
    damping = {"structure.mode[0].damping": "0.011 +- 0.001"}
    with pytest.raises(InputError) as error:
        uncertainty(case.patch({**BOTH, **damping, "uncertainty.correlation": pairs}), 10, **FEW)
    for word in words:
        assert word in str(error.value)


def test_a_coefficient_beyond_one(case):
    pair = {"between": ["material.Ktc", "material.Krc"], "coefficient": 1.2}
    with pytest.raises(InputError, match=r"correlation\[0\]\.coefficient.*less than 1"):
        case.patch({**BOTH, "uncertainty.correlation": [pair]})
