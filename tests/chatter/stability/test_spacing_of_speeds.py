"""Speeds farther apart than lobes are said: limits between them are not seen."""

import math

import numpy as np
import pytest

import chatter
from chatter.stability.lobes import notes_on_spacing
from chatter.stability.lowest_limit import LowestLimit
from tests.places import EXAMPLES

RPM = math.pi / 30.0


@pytest.mark.parametrize(("spacing", "noted"), [(80.0, False), (120.0, True)])
def test_lobes_are_counted_by_the_waves_between_teeth(spacing, noted):
    """Two teeth at 1000 rpm, 300 Hz: nine waves from tooth to tooth, lobes a tenth of it apart."""
    case = chatter.load(EXAMPLES / "two-degrees-of-freedom" / "case.toml")
    assert case.tool.teeth == 2
    speeds = (1000.0 + spacing * np.arange(-3, 4)) * RPM
    found = notes_on_spacing(case, speeds, LowestLimit(1000.0 * RPM, 1e-3, 300.0))
    assert bool(found) == noted
    if noted:
        assert "120 rpm apart, lobes about 1000 rpm 100 rpm wide" in found[0]


def test_where_no_limit_is_there_are_no_lobes():
    case = chatter.load(EXAMPLES / "two-degrees-of-freedom" / "case.toml")
    nothing = LowestLimit(math.nan, math.nan, math.nan)
    assert notes_on_spacing(case, np.array([100.0, 200.0]), nothing) == ()
