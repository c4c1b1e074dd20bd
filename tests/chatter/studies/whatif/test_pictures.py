"""Pictures of studies: what has no value is marked apart from what failed, above every curve."""

import numpy as np
import pytest

from chatter.description.case import loads
from chatter.plots.whatif import plot_whatif
from chatter.studies.whatif.measures import MEASURES
from chatter.studies.whatif.whatif_study import WhatIf, whatif
from tests.cases import TOOL_OF_922_HERTZ

TEXT = f"""{TOOL_OF_922_HERTZ}
[lobes]
speeds = {{ from = "8000 rpm", to = "12000 rpm", count = 5 }}
depths = {{ to = "3 mm" }}
"""


@pytest.fixture(scope="module")
def study():
    """Lobes with three dampings; the greatest has no limit."""
    return whatif(loads(TEXT), ["structure.mode[0].damping=0.011,0.9"])


def lines_of(axes):
    return {line.get_label(): line for line in axes.lines}


def test_what_has_no_limit_is_marked_above_every_curve(study):
    curves, numbers = plot_whatif(study).axes
    lines = lines_of(curves)
    assert "0.9: none found" in lines
    assert "0.011" in lines
    marks = [line for line in curves.lines if line.get_marker() == "^" and len(line.get_xdata())]
    top = np.nanmax(lines["0.011"].get_ydata()) / curves.get_ylim()[1]
    for line in marks:
        if line.get_transform() == curves.get_xaxis_transform():
            assert np.min(line.get_ydata()) > top
    assert lines_of(numbers)["no limit up to 3 mm"].get_xdata().tolist() == [0.9]


def test_a_failure_is_marked_otherwise(study):
    failed = study.outcomes[0].__class__(failure="it broke")
    broken = WhatIf(**{**study.__dict__, "outcomes": (study.outcomes[0], failed)})
    curves, numbers = plot_whatif(broken).axes
    assert lines_of(curves)["0.9: failed"].get_marker() == "x"
    lines = lines_of(numbers)
    assert lines["failed"].get_xdata().tolist() == [0.9]
    assert "no limit up to 3 mm" not in lines


def test_measures_of_limits_name_how_far_was_searched():
    for name in ("lobes", "critical depth"):
        first = next(iter(MEASURES[name].quantities.values()))
        assert first.beyond == "max_axial_depth_mm"
