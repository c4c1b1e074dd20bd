"""What an effect can gain beside a misfit that scatter may explain."""

import math

import pytest

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
