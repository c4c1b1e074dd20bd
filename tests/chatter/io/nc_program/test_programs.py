"""NC programs: modal codes, units, arcs in every plane, and what is refused."""

import math

import numpy as np
import pytest

from chatter.description.errors import InputError
from chatter.io.nc_program.program import read_program
from dynamics.trajectory.spatial_path import SpatialArc


def program(tmp_path, text, **given):
    path = tmp_path / "part.nc"
    path.write_text(text, encoding="utf-8")
    return read_program(path, **given)


def ends(found):
    """Ends of all blocks, mm."""
    at = [one.element.at(np.array(one.element.length)).position for one in found.blocks]
    return [[round(1e3 * value, 6) + 0.0 for value in one] for one in at]


def lengths(found):
    return [1e3 * one.element.length for one in found.blocks]


def test_a_program_with_comments_numbers_and_modal_codes(tmp_path):
    found = program(
        tmp_path,
        "%\nO0815 (a part)\nN10 G21 G17 G90 G94 ; metric\n\nN20 S3000 M3 F1200\n"
        "n30 g0x10y-2.5\nG01 X50.\n X60 (still G1) Y10\nM8\nG4 F0.5\nZ-.5 M9\nM30\nG1 X0\n",
    )
    assert ends(found) == [[10, -2.5, 0], [50, -2.5, 0], [60, 10, 0], [60, 10, -0.5]]
    assert [one.line for one in found.blocks] == [6, 7, 8, 11]
    assert [one.rapid for one in found.blocks] == [True, False, False, False]
    assert [one.block.feed for one in found.blocks] == [math.inf, *[pytest.approx(0.02)] * 3]
    assert [one.block.dwell for one in found.blocks] == [0.0, 0.0, 0.5, 0.0]
    assert found.blocks[0].spindle_speed == pytest.approx(3000.0 * math.pi / 30.0)
    assert found.moved == "XYZ"


def test_inches(tmp_path):
    """2 inch are 50.8 mm, 30 inch/min are 12.7 mm/s; back in millimetres F is asked for again."""
    found = program(tmp_path, "G20 F30\nG1 X2\nG3 X3 Y1 J1\nG21 F600 G1 Y0\n")
    assert ends(found) == [[50.8, 0, 0], [76.2, 25.4, 0], [76.2, 0, 0]]
    assert lengths(found)[1] == pytest.approx(25.4 * math.pi / 2.0)
    assert [one.block.feed for one in found.blocks] == pytest.approx([0.0127, 0.0127, 0.01])
    with pytest.raises(InputError, match=r"line 3: a feed F is missing"):
        program(tmp_path, "G20 F30\nG1 X2\nG21 G1 X10\n")


def test_incremental_and_absolute(tmp_path):
    found = program(
        tmp_path, "G91 F600\nG1 X5 Y1\nX5\nG90 X5\nG91 G3 X10 Y0 I5\n", start=(1e-3, 0.0, 0.0)
    )
    assert ends(found) == [[6, 1, 0], [11, 1, 0], [5, 1, 0], [15, 1, 0]]
    assert lengths(found)[3] == pytest.approx(5.0 * math.pi)


def test_words_that_are_absolute_or_incremental_by_themselves(tmp_path):
    """AC(...) and IC(...) of Siemens, in either kind of program; R1 is no comment's bracket."""
    found = program(
        tmp_path,
        'N10 MSG("arc (no words)")\nG90 G1 X=10 Y=IC(5) F600 (a comment)\n'
        "G3 X20 Y5 I=AC(15) J=AC(5)\nG91 X=AC(30) Y0 I=IC(5)\nG1 X=AC(-1.5) Y2\n"
        "G90.1 G90 G2 X8.5 Y7 I=IC(5) J=AC(7)\n",
    )
    assert ends(found) == [[10, 5, 0], [20, 5, 0], [30, 5, 0], [-1.5, 7, 0], [8.5, 7, 0]]
    assert lengths(found)[1:3] == pytest.approx([5.0 * math.pi] * 2)
    assert lengths(found)[4] == pytest.approx(5.0 * math.pi)
    # counter-clockwise from (10, 5) about (15, 5): below the line
    middle = found.blocks[1].element.at(np.array(2.5e-3 * math.pi)).position
    np.testing.assert_allclose(middle, [0.015, 0.0, 0.0], atol=1e-9)


@pytest.mark.parametrize("sense", ["G2", "G3"])
@pytest.mark.parametrize("before", ["X-10 Y5.5", "X-0.1 Y0.2 Z0.3", "X1.1 Y2.2"])
def test_full_circle_behind_increments(tmp_path, before, sense):
    """An end that is the start but for the rounding of sums is a full circle; it was no motion."""
    there = [40.0 + 3 * float(before.split()[0][1:]), 30.0 + 3 * float(before.split()[1][1:])]
    text = "G0 X40 Y30\nG91 F600\n" + 3 * f"G1 {before}\n"
    text += f"G90 {sense} X{there[0]:.4f} Y{there[1]:.4f} I-5 J0\n"
    found = program(tmp_path, text)
    assert lengths(found)[-1] == pytest.approx(10.0 * math.pi)
    assert ends(found)[-1][:2] == pytest.approx(there)


@pytest.mark.parametrize(
    ("block", "length", "middle"),
    [
        # from (0, 0): a quarter to the left about (0, 10), and the rest of that circle
        ("G3 X10 Y10 J10", 5.0 * math.pi, [7.0710678, 2.9289322, 0]),
        ("G2 X10 Y10 J10", 15.0 * math.pi, [-7.0710678, 17.0710678, 0]),
        ("G3 X10 Y10 R10", 5.0 * math.pi, [7.0710678, 2.9289322, 0]),
        ("G2 X10 Y10 R10", 5.0 * math.pi, [2.9289322, 7.0710678, 0]),
        ("G3 X10 Y10 R-10", 15.0 * math.pi, [17.0710678, -7.0710678, 0]),
        ("G3 X10 Y10 CR=10", 5.0 * math.pi, [7.0710678, 2.9289322, 0]),
        ("G90.1 G3 X10 Y10 I0 J10", 5.0 * math.pi, [7.0710678, 2.9289322, 0]),
        ("G2 I10", 20.0 * math.pi, [20, 0, 0]),
        ("G2 X20 R10", 10.0 * math.pi, [10, 10, 0]),
        # half a turn from -x: z to x is counter-clockwise in ZX, y to z in YZ
        ("G18 G3 X20 I10", 10.0 * math.pi, [10, 0, 10]),
        ("G18 G2 X20 I10", 10.0 * math.pi, [10, 0, -10]),
        ("G19 G3 Y20 J10", 10.0 * math.pi, [0, 10, -10]),
        # a helix, one turn and 3 mm down
        ("G3 Z-3 I10", math.hypot(20.0 * math.pi, 3.0), [20, 0, -1.5]),
    ],
)
def test_arcs_by_hand(tmp_path, block, length, middle):
    found = program(tmp_path, f"F600\n{block}\n")
    (one,) = found.blocks
    assert isinstance(one.element, SpatialArc)
    assert 1e3 * one.element.length == pytest.approx(length, rel=1e-9)
    half = one.element.at(np.array(0.5 * one.element.length)).position
    assert 1e3 * half == pytest.approx(middle, abs=1e-6)


def test_an_arc_whose_centre_is_rounded_meets_both_ends(tmp_path):
    found = program(tmp_path, "F600\nG3 X10.001 Y10 I0 J10\nG1 X0\n")
    arc = found.blocks[0].element
    assert ends(found)[0] == [10.001, 10, 0]
    assert arc.at(np.array(0.0)).position == pytest.approx(np.zeros(3), abs=1e-12)


def test_feed_of_a_revolution_and_exact_stops(tmp_path):
    found = program(tmp_path, "G95 S1200 F0.2\nG1 X5\nG9 X6\nX7\nG61 X8\nX9\nG64 X10\n")
    assert found.blocks[0].block.feed == pytest.approx(0.2e-3 * 20.0)
    assert [one.block.stops for one in found.blocks] == [False, True, False, True, True, False]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("G1 X5", "line 1: a feed F is missing"),
        ("F100\nX5", "line 2: a position before any of G0, G1, G2, G3"),
        ("G1 F100 X5 A30", "line 1: A30: the letter A is not known here"),
        ("G1 F100 X5\nG41 X9", "line 2: G41: tool radius compensation is not taken"),
        ("G28 X0", "line 1: G28: moves to a reference point"),
        ("G33 X5", "line 1: G33: is not known here"),
        ("M98 P5", "line 1: "),
        ("M19\nG0 X1", "line 1: M19: is not known here"),
        ("G0 X1 X2", "line 1: X1 and X2 are both there"),
        ("G0 G1 X1", "line 1: G1: a second code of motion"),
        ("G17 G18 X1", "line 1: G18: a second code of plane"),
        ("/G0 X1", "line 1: a block that may be skipped"),
        ("G0 X#1", "is no word such as"),
        ("G0 X=R1+5", "is no word such as"),
        ("G0 X1,5", "line 1: X1,5 has a decimal comma; write a point"),
        ("G0 X1 (open", "line 1: a bracket is open"),
        ("F0 G1 X1", "line 1: F0: a feed above 0"),
        ("G95 F0.1 G1 X1", "line 1: G95: a feed for a revolution needs a spindle speed"),
        ("F100 G2 X5 Y5", "line 1: the centre and the radius of the arc are both missing"),
        ("F100 G2 X5 Y5 I5 R5", "line 1: the centre and the radius of the arc are both there"),
        ("F100 G2 X5 K5", "line 1: K is no centre in the plane XY"),
        ("F100 G2 X5 Y0 I3", "arc: the start is 3 mm from the centre and the end 2 mm"),
        ("F100 G2 X5 R2", "arc: the radius is 2 mm, but half the way to the end is 2.5 mm"),
        ("F100 G2 X0 R2", "arc: a full circle has no radius alone"),
        ("F100 G2 X5 I0", "arc: the centre is the start of the arc"),
        ("F100 G90.1 G2 X5 I2.5", "G90.1: I and J are both needed"),
        ("F100 G1 X5 I2", "line 1: a centre or a radius in a straight block"),
        ("G4 P100", "line 1: G4: the time of a dwell is in seconds"),
        ("G90 G21\nM30", "nothing moves in this program"),
        ("G0 X1.2.3", "is no word such as"),
    ],
)
def test_what_is_not_known_is_refused_with_file_and_line(tmp_path, text, told):
    with pytest.raises(InputError) as refused:
        program(tmp_path, text + "\n")
    assert str(refused.value).startswith(f"{tmp_path / 'part.nc'}: ")
    assert told in str(refused.value)


def test_a_file_that_is_no_text_is_refused(tmp_path):
    path = tmp_path / "part.nc"
    path.write_bytes(bytes(range(256)) * 8)
    with pytest.raises(InputError, match="is not text"):
        read_program(path)
    with pytest.raises(InputError, match="no such file"):
        read_program(tmp_path / "none.nc")
