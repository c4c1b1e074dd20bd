"""Cuts along NC programs and recorded set points: what they must be in their limits."""

import math

import numpy as np
import pytest

from chatter import Case, InputError
from chatter.simulation.simulate import simulate

STEPS = 360
MODE = {"frequency": 600.0, "damping": 0.04, "stiffness": 2e7, "direction": [1.0, 0.0, 0.0]}
#: of a program that is at its feed after a few hundredths of a millimetre
QUICK = {"acceleration": 20.0, "jerk": 5000.0}


def cut_case(structure=None, cut=None, stock=None, **simulation):
    return Case.from_dict(
        {
            "tool": {"kind": "end mill", "teeth": 3, "diameter": "16 mm", "helix": "35 deg"},
            "material": {"law": "linear", "Ktc": 8e8, "Krc": 3e8, "Kac": 1e8},
            "cut": {
                "mode": "down",
                "spindle_speed": "3000 rpm",
                "feed_per_tooth": "0.1 mm",
                "axial_depth": "1.5 mm",
                "radial_depth": "6 mm",
                **(cut or {}),
            },
            **({} if structure is None else {"structure": structure}),
            **({} if stock is None else {"stock": {"box": stock}}),
            "simulation": {"slices": 8, "steps": STEPS, **simulation},
        }
    )


def programmed(folder, text, case=cut_case, **keys):
    path = folder / "part.nc"
    path.write_text(text)
    return lambda **further: case(program={"file": str(path), **QUICK, **keys}, **further)


def at(result, time):
    """Rows of the whole revolution that begins last before a time."""
    first = int(np.searchsorted(result.time, time)) // STEPS * STEPS
    return slice(first, first + STEPS)


def when(result, axis, position):
    """Time at which the tool passes a coordinate, s."""
    path = result.setup.path.position_at(result.time)["xy".index(axis)]
    return float(result.time[int(np.argmax(path >= position))])


def block(x, y):
    return {"x": [f"{part} mm" for part in x], "y": [f"{part} mm" for part in y], "z": [0.0, 0.01]}


@pytest.mark.parametrize("structure", [None, {"mode": [MODE]}])
def test_a_straight_program_is_the_plain_cut(tmp_path, structure):
    plain = simulate(cut_case(structure, revolutions=40))
    straight = simulate(programmed(tmp_path, "G1 X20 F900\n")(structure=structure))
    last, there = slice(39 * STEPS, 40 * STEPS), at(straight, when(straight, "x", 0.015))
    size = np.abs(plain.force).max()
    assert size > 50.0
    assert np.abs(straight.force[there] - plain.force[last]).max() < 1e-6 * size
    if structure is not None:
        moved = np.abs(plain.displacement[last]).max()
        apart = np.abs(straight.displacement[there] - plain.displacement[last]).max()
        assert apart < 1e-4 * moved


def test_a_quarter_arc_turns_the_pattern_of_the_force(tmp_path):
    """Behind a counter-clockwise quarter the feed is +y: what lay along x lies along y then."""
    turned = simulate(programmed(tmp_path, "G1 X10 F900\nG3 X20 Y10 J10\nG1 Y20\n")())
    before, behind = (
        turned.force[at(turned, when(turned, *one))] for one in (("x", 8e-3), ("y", 15e-3))
    )
    # an edge at the angle p from +y was at p + 90 degrees from the normal of the new feed
    pattern = np.roll(before, -STEPS // 4, axis=0)
    size = np.abs(before).max()
    assert np.abs(behind[:, 1] - pattern[:, 0]).max() < 1e-6 * size
    assert np.abs(-behind[:, 0] - pattern[:, 1]).max() < 1e-6 * size
    # three teeth: the unturned pattern is another one
    assert np.abs(behind - before).max() > 0.5 * size
    # on the arc the pattern lies between, at the feed of its middle
    middle = at(turned, when(turned, "x", 10e-3 + 10e-3 * math.sin(math.pi / 4)))
    mean, straight = turned.force[middle].mean(axis=0), before.mean(axis=0)
    c = math.sqrt(0.5)
    expected = [c * (straight[0] - straight[1]), c * (straight[0] + straight[1]), straight[2]]
    assert mean == pytest.approx(expected, abs=0.01 * np.linalg.norm(straight))


@pytest.mark.parametrize("course", ["G1 X-20 F900\n", "G1 Y-20 F900\n", "G1 X12 Y-12 F900\n"])
def test_in_any_direction_the_cut_is_the_same(tmp_path, course):
    plain = simulate(cut_case(revolutions=4))
    turned = simulate(programmed(tmp_path, course)())
    moving, last = at(turned, 0.5), slice(3 * STEPS, 4 * STEPS)
    size = np.linalg.norm(plain.force[last], axis=1)
    assert np.linalg.norm(turned.force[moving], axis=1).mean() == pytest.approx(size.mean(), 1e-6)
    assert turned.torque[moving].mean() == pytest.approx(plain.torque[last].mean(), rel=1e-6)
    way = turned.setup.path.position_at(turned.time[-1:])[:, 0]
    along, across = way / np.linalg.norm(way), np.array([-way[1], way[0]]) / np.linalg.norm(way)
    found = turned.force[moving, :2].mean(axis=0)
    straight = plain.force[last, :2].mean(axis=0)
    assert [found @ along, found @ across] == pytest.approx(straight, rel=1e-6)


def test_the_spindle_speed_of_a_block_holds(tmp_path):
    """At twice the speed and the same feed a tooth takes half the chip, at twice the rate."""
    text = "S3000\nG1 X10 F900\nS6000\nG1 X30\n"
    result = simulate(programmed(tmp_path, text)())
    slow, fast = (
        (result.time > 0.1) & (result.time < 0.6),
        (result.time > 0.8) & (result.time < 1.9),
    )
    assert result.spindle_speed[slow] == pytest.approx(np.full(slow.sum(), 100.0 * math.pi))
    assert result.spindle_speed[fast] == pytest.approx(np.full(fast.sum(), 200.0 * math.pi))
    ratio = result.torque[fast].mean() / result.torque[slow].mean()
    assert ratio == pytest.approx(0.5, rel=0.01)
    spectrum = np.abs(np.fft.rfft(result.torque[fast] - result.torque[fast].mean()))
    line = np.fft.rfftfreq(fast.sum(), result.time[1])[int(np.argmax(spectrum))]
    assert line == pytest.approx(300.0, abs=2.0)


def test_rapid_traverse_and_lifted_blocks_do_not_cut(tmp_path):
    text = "G0 Z5\nG0 X-5\nG1 Z0 F900\nG1 X10\nG0 X15\nG1 X25\nG0 Z5\nG0 X0\n"
    plain = simulate(cut_case(revolutions=5))
    result = simulate(programmed(tmp_path, text)())
    course = result.setup.path
    assert course.in_air.shape == (3, 2)
    for begin, end in course.in_air:
        inside = (result.time > begin + result.time[1]) & (result.time < end)
        assert not np.any(result.force[inside])
    # the chips behind a rapid traverse are those of the feed, from the first one on
    begin = course.in_air[1, 1]
    again = (result.time > begin) & (result.time < course.in_air[2, 0] - 0.1)
    size = np.abs(plain.force).max()
    assert 0.98 * size < np.abs(result.force[again]).max() < 1.001 * size
    assert any("in the air" in note for note in result.setup.notes)


def test_dexels_along_a_program_enter_and_leave_the_stock(tmp_path):
    """Through a block: air, entry, the force of the delayed chip, exit, air."""
    stock = [block((0, 30), (2, 12))]  # 6 mm of the 16 mm tool, on its left
    start = ["-15 mm", "0 mm"]
    carved = programmed(tmp_path, "G1 X45 F900\n", start=start)(
        stock=stock, chip="dexel", cut={"mode": "up"}
    )
    result = simulate(carved)
    x = result.setup.path.position_at(result.time)[0]
    reach = math.sqrt(8.0**2 - 2.0**2) * 1e-3
    outside = (x < -8.1e-3) | (x > 38.1e-3)
    assert not np.any(result.force[outside])
    # the front edge of the block is met where the circle of the tool reaches its corner
    first = x[int(np.argmax(np.any(result.force != 0.0, axis=1)))]
    assert first == pytest.approx(-reach, abs=0.15e-3)
    inside = (x > 5e-3) & (x < 20e-3)
    plain = simulate(cut_case(cut={"mode": "up"}, revolutions=5))
    mean = result.force[inside].mean(axis=0)
    assert mean == pytest.approx(plain.mean_force, abs=0.03 * np.linalg.norm(plain.mean_force))


def test_recorded_set_points_are_the_program_again(tmp_path):
    course = simulate(programmed(tmp_path, "G1 X10 F900\nG2 X20 Y-10 J-10\n")()).setup.path
    time = np.arange(0.0, course.duration, 2e-3)
    x, y = course.position_at(time) * 1e3
    rows = "\n".join(f"{t:.9f},{a:.12f},{b:.12f}" for t, a, b in zip(time, x, y, strict=True))
    (tmp_path / "trace.csv").write_text(f"time [s],X [mm],Y [mm]\n{rows}\n")
    file = str(tmp_path / "trace.csv")
    again = simulate(cut_case(program={"kind": "recorded", "file": file}))
    assert again.setup.path.feed_per_tooth == pytest.approx(1e-4, rel=0.05)
    other = simulate(programmed(tmp_path, "G1 X10 F900\nG2 X20 Y-10 J-10\n")())
    for when_ in (0.3, 1.2):
        one, two = again.force[at(again, when_)], other.force[at(other, when_)]
        assert np.abs(one - two).max() < 0.01 * np.abs(two).max()


def test_what_cannot_be_programmed(tmp_path):
    make = programmed(tmp_path, "G1 X10 F900\n")
    with pytest.raises(InputError, match=r"simulation\.program.*\[stock\]"):
        simulate(make(chip="dexel"))
    with pytest.raises(InputError, match="not both"):
        make(path=[[0.0, 0.0], [1.0, 0.0]])
    with pytest.raises(InputError, match="S0"):
        simulate(programmed(tmp_path, "S0\nG1 X10 F900\n")())
    with pytest.raises(InputError, match="velocity"):
        cut_case(program={"kind": "recorded", "file": "a.csv", "velocity": 1.0})
    with pytest.raises(InputError, match=r"none\.nc"):
        simulate(cut_case(program={"file": str(tmp_path / "none.nc")}))


def test_a_saved_case_finds_its_program(tmp_path):
    (tmp_path / "part.nc").write_text("G1 X2 F900\n")
    case = programmed(tmp_path, "G1 X2 F900\n")()
    case.save(tmp_path / "case.toml")
    (tmp_path / "deep").mkdir()
    Case.from_file(tmp_path / "case.toml").save(tmp_path / "deep" / "case.toml")
    again = Case.from_file(tmp_path / "deep" / "case.toml")
    assert simulate(again).setup.path.duration == pytest.approx(0.134, abs=0.01)


def test_the_picture_shows_path_and_feed(tmp_path):
    result = simulate(programmed(tmp_path, "G1 X2 F900\nG1 Y2\n")())
    titles = [axes.get_title(loc="left") for axes in result.plot().axes]
    assert "path of the tool" in titles
    assert "feed, and spindle speed" in titles
    assert {path.name for path in result.save(tmp_path / "out")} >= {"simulate.png", "summary.json"}
