"""Tables of cutting tests: a unit that is not said is asked for, not taken for m and rad/s."""

import numpy as np
import pytest

import chatter
from chatter import InputError
from chatter.learning.cuts import read_cuts
from chatter.learning.learn import _depths, _speeds
from tests.chatter.learning.test_learn import case_of


@pytest.mark.parametrize(
    ("heading", "row", "said"),
    [
        ("spindle_speed,axial_depth [mm]", "9000,1", "column spindle_speed has no unit; .*rpm"),
        ("speed;axial_depth [mm]", "9000;1", "column speed has no unit"),
        (
            "spindle_speed [rpm],axial_depth", "9000,1",
            r"axial_depth, row 1: 1000 mm are 62\.5 diameters of the tool; .*axial_depth \[mm\]",
        ),
    ],
)  # fmt: skip
def test_a_column_without_its_unit(tmp_path, heading, row, said):
    case = chatter.load(case_of(tmp_path, 900.0))
    mark = ";" if ";" in heading else ","
    path = tmp_path / "cuts.csv"
    path.write_text(f"{heading}{mark}stable\n{row}{mark}1\n", encoding="utf-8")
    with pytest.raises(InputError, match=said):
        read_cuts(path, case)


def test_a_table_with_its_units_is_read(tmp_path):
    case = chatter.load(case_of(tmp_path, 900.0))
    path = tmp_path / "cuts.csv"
    path.write_text("speed [1/min],depth [mm],stable\n9000,1.5,1\n", encoding="utf-8")
    (run,) = read_cuts(path, case).runs
    assert run.signals["axial_depth"] == pytest.approx([1.5e-3])
    assert run.signals["spindle_speed"] == pytest.approx([9000.0 * np.pi / 30.0])


def test_limits_below_all_depths_that_were_looked_at_leave_a_diagram():
    """Tests far deeper than every limit ended with "Geometric sequence cannot include zero"."""
    for limits in (np.zeros(3), np.array([0.0, 2e-3, 1e-3]), np.zeros(0)):
        depths = _depths(0.5, limits)
        assert np.all(np.diff(depths) > 0.0)
        assert 0.0 < depths[0] < depths[-1] == pytest.approx(0.5)
    assert _depths(0.5, np.array([0.0, 1e-3]))[0] < 1e-3


def test_remarks_of_the_operator_are_passed_over(tmp_path):
    case = chatter.load(case_of(tmp_path, 900.0))
    path = tmp_path / "cuts.csv"
    rows = "1,9000,1.5,1,good surface\n2,9500,2.5,0,loud\n3,9800,2,1,\n"
    heading = "No,spindle_speed [rpm],axial_depth [mm],stable,remark\n"
    path.write_text(heading + rows, encoding="utf-8")
    runs = read_cuts(path, case).runs
    depths = np.concatenate([run.signals["axial_depth"] for run in runs])
    assert depths == pytest.approx([1.5e-3, 2.5e-3, 2e-3])


def test_a_cell_of_words_in_a_column_of_numbers_is_still_named(tmp_path):
    case = chatter.load(case_of(tmp_path, 900.0))
    path = tmp_path / "cuts.csv"
    heading = "spindle_speed [rpm],axial_depth [mm],stable,level\n"
    path.write_text(heading + "9000,1.5,1,0.4\n9500,2.5,0,loud\n", encoding="utf-8")
    with pytest.raises(InputError, match='line 3: level: "loud" is not a number'):
        read_cuts(path, case)


def test_every_lobe_has_speeds_of_the_diagram():
    """Lobes of 700 Hz and four teeth lie at 60 700/(4 k) rpm: those of k = 7 to 1 are in range."""
    speeds = _speeds(1500.0, 10500.0)
    assert speeds[[0, -1]] == pytest.approx([1500.0, 10500.0])
    for number in range(1, 7):
        slower, faster = (60.0 * 700.0 / (4.0 * k) for k in (number + 1, number))
        assert np.sum((speeds >= 0.999 * slower) & (speeds <= 1.001 * faster)) >= 4
    alone = _speeds(1000.0, 1000.0)
    assert alone[[0, -1]] == pytest.approx([700.0, 1300.0])
