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
