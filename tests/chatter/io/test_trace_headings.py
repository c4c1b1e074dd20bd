"""Headings of traces of controls: name and unit, in brackets or behind a slash."""

import pytest

from chatter.io.trace_headings import split_trace_heading


@pytest.mark.parametrize(
    ("heading", "name", "unit"),
    [
        ("t/ms", "t", "ms"),
        ("v/(mm/min)", "v", "mm/min"),
        ("motor speed/rpm", "motor speed", "rpm"),
        ("velocity mm/min", "velocity mm/min", ""),
        ("speed r/min", "speed r/min", ""),
        ("m/s", "m/s", ""),
        ("force/displacement", "force/displacement", ""),
    ],
)
def test_unit_behind_a_slash(heading, name, unit):
    assert split_trace_heading(heading) == (name, unit)


@pytest.mark.parametrize(
    ("heading", "name", "unit"),
    [
        ("time_s", "time", "s"),
        ("t_ms", "t", "ms"),
        ("X_cmd_mm", "X_cmd", "mm"),
        ("v_act_mm_min", "v_act", "mm/min"),
        ("motor_Nm", "motor", "Nm"),
        ("torque_A", "torque_A", ""),
        ("position_S", "position_S", ""),
        ("X_set [um]", "X_set", "um"),
    ],
)
def test_unit_behind_an_underscore(heading, name, unit):
    """A single letter may be an axis: the torque of A is no current."""
    assert split_trace_heading(heading) == (name, unit)
