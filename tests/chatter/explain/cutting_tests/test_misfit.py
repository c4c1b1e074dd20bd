"""What an effect can gain beside a misfit that scatter may explain."""

import math
from pathlib import Path

import numpy as np
import pytest
import tomlkit

import chatter
from benchmarks.blind_sets import stability
from benchmarks.blind_sets.__main__ import FIRST, KINDS
from chatter.explain.cutting_tests.misfit import Misfit


@pytest.mark.parametrize(("numbers", "may"), [(0, True), (1, True), (4, False)])
def test_an_effect_is_tried_where_luck_and_its_numbers_leave_it_a_gain(numbers, may):
    # the right model may lose 2 x 7.5 less than the mean: 9 + 15, for a gain of 6 and n ln 400
    assert Misfit(9.0, 7.5, 400).may_fall_by(6.0, numbers) is may
    assert (6.0 + numbers * math.log(400) <= 9.0 + 15.0) is may


def test_a_misfit_no_larger_than_scatter_may_hide_an_effect():
    misfit = Misfit(0.0, 8.0, 50)
    assert misfit.is_scatter
    assert misfit.may_fall_by(6.0, 1)


def test_a_mode_shift_that_costs_no_more_than_scatter_is_found(tmp_path: Path):
    # frequencies pulled by 4 tolerances excuse it: verdicts by integration in time alone
    number = 47
    random = np.random.default_rng([2050, KINDS.index("stability"), number])
    name = f"set-{FIRST['stability'] + number - 1:04d}"
    stability.write_set(tmp_path, FIRST["stability"] + number - 1, random)
    truth = tomlkit.parse((tmp_path / "truth" / name / "truth.toml").read_text(encoding="utf-8"))
    found = chatter.explain(tmp_path / name).summary()
    assert found["verdict"] == "explained"
    assert [one["name"] for one in found["effects"]] == ["mode_shift"]
    low, high = found["effects"][0]["parameters"]["slope"]["ci95"]
    assert low < truth["expected"]["mode_shift"]["slope"] < high
