"""A slip is said at the key where it was made, in words."""

import pytest

from tests.command_line import chatter_command
from tests.first_use.shop import written


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
    ],
)
def test_a_slip_is_said_at_its_own_key(setting, told, tmp_path):
    result = chatter_command("check", written(tmp_path), "--set", setting)
    assert result.exit_code == 2
    assert told in result.stderr
