"""A slip is said at the key where it was made, in words."""

import pytest

import chatter
from chatter import InputError
from tests.command_line import chatter_command
from tests.first_use.shop import cut, written


@pytest.mark.parametrize(
    ("setting", "told"),
    [
        # it blamed tool.helix
        ("cut.axial_depth=2", "cut.axial_depth: within 2000 mm the edge winds"),
        # it blamed cut.feed_per_tooth, which is not in the file
        ("cut.cutting_speed=60 mm/min", "cut.feed_rate: 380 mm/min at 1.194 rpm is 79.59 mm for"),
        # 300 mm were taken, and 17 kN/mm printed
        ("tool.flank_wear=0.3", "is out of range; it must be at most 10 mm"),
        ("material.Ktc=1900 MPa +- 100", "has its standard deviation behind the unit"),
        ("cut.axial_depth=3 m", "it must be at most 2 m"),
        # 1.2 W were taken: "no cut keeps within the limits"
        ("optimum.max_power=1.2", 'optimum.max_power: 1.2 has no unit; write "1.2 kW"'),
        ("optimum.max_power=1.2 W", 'max_power: "1.2 W" is out of range; it must be at least 0.02'),
        ("optimum.min_tool_life=15", 'min_tool_life: 15 has no unit; write "15 min"'),
        # 20 mm of deflection were allowed
        ("optimum.max_deflection=0.02", "0.02 (a bare number is in m) is out of range; it must be"),
        ("optimum.max_surface_error=12", "12 (a bare number is in m) is out of range; it must be"),
        # allowed modes alone were listed
        ("cut.mode=plunge", "that feeds along the tool axis, of which nothing is computed"),
        ("cut.mode=shoulder", "the width of the cut is radial_depth; allowed are"),
    ],
)
def test_a_slip_is_said_at_its_own_key(setting, told, tmp_path):
    result = chatter_command("check", written(tmp_path), "--set", setting)
    assert result.exit_code == 2
    assert told in result.stderr


def test_a_power_without_a_unit_in_a_file_is_asked_for_its_unit(tmp_path):
    path = written(tmp_path)
    path.write_text(path.read_text() + "[optimum]\nmax_power = 1.2\n", encoding="utf-8")
    result = chatter_command("optimum", path)
    assert result.exit_code == 2
    assert 'optimum.max_power: 1.2 has no unit; write "1.2 kW"' in result.stderr


@pytest.mark.parametrize(
    ("given", "read"), [(1500, 1500.0), ("1.5 kW", 1500.0), ("1500 W", 1500.0)]
)
def test_a_plausible_power_is_read(given, read):
    assert cut(optimum__max_power=given).optimum.max_power == read


def test_numbers_of_python_are_in_si():
    assert cut(optimum__min_tool_life=120).optimum.min_tool_life == 120.0
    with pytest.raises(InputError, match=r"at least 0\.02 kW"):
        cut(optimum__max_power=1.2)


def test_a_process_damping_that_nothing_feels_is_asked_about():
    """0.5 changed nothing, and nothing was said."""

    def asked_of(coefficient):
        notes = chatter.check(cut(process_damping__coefficient=coefficient)).notes
        return [one for one in notes if "meant?" in one]

    (asked,) = asked_of(0.5)
    assert asked.endswith(
        "process_damping.coefficient: is 0.5 N/m meant? edges in metals have 100 to 1e+08 N/m"
    )
    assert asked_of(2.5e5) == []


def test_the_words_of_a_mode_are_not_those_of_a_kind_of_tool(tmp_path):
    result = chatter_command("check", written(tmp_path), "--set", "tool.kind=roughing")
    assert result.exit_code == 2
    assert "radial_depth" not in result.stderr
