"""Moves of an NC program and of recorded set points, on a small machine."""

import numpy as np
import pytest

from chatter.description.errors import InputError
from chatter.description.machine.machine_file import load_machine
from chatter.simulation.virtual_tests.courses import course_of
from chatter.simulation.virtual_tests.from_file import move
from tests.chatter.simulation.virtual_tests.conftest import FILE

PROGRAM = """
[move.part]
kind = "nc program"
file = "part.nc"
axes = ["Y"]
velocity = "0.2 m/s"
acceleration = "3 m/s^2"
jerk = "100 m/s^3"
standstill = "10 ms"
"""
RECORD = """
[move.again]
kind = "recorded"
file = "set.csv"
axes = ["Y"]
velocity = "0.12 m/s"
"""
LENGTH, FEED = 0.03, 0.1
#: a second axis, whose position loop samples every 5 ms
SLOW_AXIS = """
[body.probe]
mass = "20 kg"
size = ["0.1 m", "0.1 m", "0.1 m"]
centre = ["0 mm", "0 mm", "0 mm"]

[connector.rail]
between = ["probe", "bed"]
at = ["0 mm", "0 mm", "0 mm"]
stiffness = { y = 1e9, z = 1e9, rx = 1e9, ry = 1e9, rz = 1e9 }

[axis.X]
direction = "x"
moving = "probe"
carrying = "bed"
at = ["0 mm", "0 mm", "0 mm"]
drive = { kind = "linear motor" }

[axis.X.control]
position = { gain = "10 1/s", sample_time = "5 ms" }
velocity = { proportional_gain = "2 kN*s/m", integral_time = "50 ms", sample_time = "200 us" }
current = { sample_time = "100 us" }

[move.steady]
kind = "constant speed"
axes = ["Y"]
travel = ["60 mm"]
velocity = "100 mm/s"
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "small.toml").write_text(FILE + PROGRAM + RECORD, encoding="utf-8")
    (tmp_path / "part.nc").write_text("G21 G90 F6000\nG1 Y30\nG4 F0.1\nG0 Y10\n", encoding="utf-8")
    time = np.linspace(0.0, 0.5, 251)
    way = 10.0 * (1.0 - np.cos(2.0 * np.pi * time))
    table = np.column_stack((1e3 * time, way))
    np.savetxt(tmp_path / "set.csv", table, "%.9g", ",", header="time [ms],Y [mm]", comments="")
    return tmp_path


def test_a_program_moves_the_axis_to_its_end(folder):
    result = move(load_machine(folder / "small.toml"), "part")
    # v j = 10 > a^2 = 9: L / v + v / a + a / j at the feed, and in rapid traverse v^2 j > a^3
    forward = LENGTH / FEED + FEED / 3.0 + 3.0 / 100.0
    back = 0.02 / 0.2 + 0.2 / 3.0 + 3.0 / 100.0
    wanted = 0.01 + forward + 0.1 + back + 0.1
    assert result.time[-1] == pytest.approx(wanted, abs=3e-3)
    assert result.wanted[-1, 0] == pytest.approx(0.01, abs=1e-12)
    assert result.wanted.max() == pytest.approx(LENGTH, abs=1e-12)
    assert result.motor[-1, 0] == pytest.approx(0.01, abs=2e-4)
    # along a line nothing is off the path but what lies beyond its ends
    beyond = np.maximum(result.tool[:, 0] - LENGTH, 0.0) + np.maximum(-result.tool[:, 0], 0.0)
    assert result.contour == pytest.approx(beyond, abs=1e-12)


def test_the_program_may_begin_elsewhere_and_name_other_letters(folder):
    file = load_machine(folder / "small.toml")
    other = file.patch({"move.part.addresses": ["X"], "move.part.start": ["5 mm"]})
    (folder / "part.nc").write_text("F600 G1 X7.5\n", encoding="utf-8")
    course = course_of(other.move["part"])
    ends = course.trajectory.at(np.array([0.0, course.trajectory.duration])).position
    assert ends == pytest.approx(np.array([[0.005], [0.0075]]))


def test_recorded_set_points_are_what_the_axis_is_to_do(folder):
    result = move(load_machine(folder / "small.toml"), "again")
    time = np.minimum(result.time + 1e-3, 0.5)
    wanted = 0.01 * (1.0 - np.cos(2.0 * np.pi * time))
    assert np.max(np.abs(result.wanted[:, 0] - wanted)) < 0.01 * 2.0 * np.pi * 1.5e-3
    assert result.wanted[-1, 0] == pytest.approx(0.02, abs=1e-9)
    assert result.contour is None


def test_a_slow_loop_of_another_axis_does_not_hold_the_set_points_of_a_fast_one(tmp_path):
    (tmp_path / "two.toml").write_text(FILE + SLOW_AXIS, encoding="utf-8")
    result = move(load_machine(tmp_path / "two.toml"), "steady")
    steady = (result.time > 0.45) & (result.time < 0.58)
    # velocity fed forward in full leaves no lag; set points held for 5 ms leave 2 ms of it, 200 um
    assert np.max(np.abs(result.wanted - result.scale)[steady]) < 5e-6
    # with a stated cycle they are held, as stated
    file = load_machine(tmp_path / "two.toml").patch({"move.steady.cycle": "5 ms"})
    held = move(file, "steady")
    steady = (held.time > 0.45) & (held.time < 0.58)
    lag = np.mean((held.wanted - held.scale)[steady])
    assert lag == pytest.approx(0.1 * 2e-3, rel=0.03)


def test_a_held_axis_beside_a_free_direction_is_refused(folder):
    # as many free motions as the axes have, but along x, where nothing guides the table
    stiffness = {"y": 1e9, "z": 1e9, "rx": 1e9, "ry": 1e9, "rz": 1e9}
    blocked = load_machine(folder / "small.toml").patch({"connector.guide.stiffness": stiffness})
    with pytest.raises(InputError, match="axes Y cannot move freely: something holds them"):
        move(blocked, "fast")


def test_what_a_move_wrote_moves_again(folder):
    file = load_machine(folder / "small.toml")
    move(file, "fast").save(folder)
    again = file.patch({"move.again.file": str(folder / "move.csv"), "move.again.velocity": 1.0})
    found = course_of(again.move["again"]).trajectory
    assert found.at(found.duration).position == pytest.approx([0.02], abs=1e-7)


@pytest.mark.parametrize(
    ("name", "patch", "text", "told"),
    [
        ("part", {}, "F600 G1 X5\n", "part.nc: line 1: X moves, but the move has Y"),
        ("part", {}, "G1 Y5\n", "part.nc: line 1: a feed F is missing"),
        ("part", {"file": "no.nc"}, "", "no.nc: no such file"),
        ("part", {"start": ["1 mm", "2 mm"]}, "", "move.part.start: 2 for 1 axes; one each"),
        ("part", {"addresses": ["A"]}, "", "move.part.addresses"),
        ("part", {"travel": ["1 mm"]}, "", "move.part.travel"),
        ("again", {"velocity": "50 mm/s"}, "", "Y has velocity 0.06283 m/s at 0.25 s; 0.05 are"),
        ("again", {"acceleration": "0.1 m/s^2"}, "", "Y has acceleration 0.39"),
        ("again", {"jerk": "1 m/s^3"}, "", "m/s^3 at 0.2"),
        ("again", {}, "time [s],Z [mm]\n0,0\n1,1\n2,2\n3,2\n", 'no column "Y"'),
        ("again", {}, "time [s],Y\n0,0\n1,1\n2,2\n3,2\n", '"Y" has no unit'),
    ],
)
def test_wrong_files_and_sections_are_refused(folder, name, patch, text, told):
    if text:
        (folder / ("part.nc" if name == "part" else "set.csv")).write_text(text, encoding="utf-8")
    file = load_machine(folder / "small.toml")
    with pytest.raises(InputError) as refused:
        move(file.patch({f"move.{name}.{key}": value for key, value in patch.items()}), name)
    assert told in str(refused.value)


def test_a_machine_saved_elsewhere_still_finds_its_program(folder):
    other = folder / "other" / "small.toml"
    other.parent.mkdir()
    load_machine(folder / "small.toml").patch({"title": "moved"}).save(other)
    assert course_of(load_machine(other).move["part"]).trajectory.duration > 0.3


def test_axes_of_other_names_need_their_letters(folder):
    text = (folder / "small.toml").read_text(encoding="utf-8").replace('["Y"]', '["cross"]')
    text = text.replace("axis.Y", "axis.cross").replace('"Y"', '"cross"')
    (folder / "small.toml").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=r"move.part.addresses: is missing; cross are not all X"):
        load_machine(folder / "small.toml")
