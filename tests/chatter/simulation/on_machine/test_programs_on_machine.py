"""Axes of a machine that follow an NC program while the tool cuts."""

import numpy as np
import pytest

from chatter import InputError, check
from chatter.description.machine.machine_file import MachineFile
from chatter.simulation.simulate import simulate
from chatter.simulation.steady_parts import steady_parts
from chatter.simulation.virtual_tests.from_file import move
from tests.chatter.simulation.on_machine.coupled_machines import (
    body,
    control,
    cut_case,
    linear_axis,
    spindle,
    spring,
    written,
)

LIMITS = {"velocity": 0.5, "acceleration": 5.0, "jerk": 400.0}
PROGRAM = "G1 X4 F1200\nG3 X8 Y4 J4\nG1 Y7\n"


def two_axes(table_moves=False, soft=False):
    """Tool on a cross slide, or a table on it; the slide soft or stiff against its carrier."""
    at, far = {"on": "slide", "at": [0.0] * 3}, {"on": "bed", "at": [0.0] * 3}
    loops = control(50.0, 1e5, 0.02)
    damped = dict.fromkeys(("x", "y", "z", "rx", "ry", "rz"), 100000.0)
    guide = {"y": 8e7} if soft else {}
    return {
        "tool_point": "tip",
        "workpiece": "work",
        "step": 5e-5,
        "body": {"bed": body(1e5), "saddle": body(80.0), "slide": body(50.0)},
        "connector": {
            "foot": spring("bed", "ground"),
            "ways": spring("saddle", "bed", damping=damped | {"y": 0.0}, y=0.0),
            "guide": spring("slide", "saddle", damping=damped | {"x": 0.0}, x=0.0, **guide),
        },
        "point": {"tip": far if table_moves else at, "work": at if table_moves else far},
        "axis": {
            "X": linear_axis((1, 0, 0), "slide", "saddle", ["slide"]) | {"control": loops},
            "Y": linear_axis((0, 1, 0), "saddle", "bed", ["saddle", "slide"]) | {"control": loops},
            "S": spindle("bed" if table_moves else "slide", inertia=0.02),
        },
    }


def programmed(folder, machine, text=PROGRAM, **further):
    (folder / "part.nc").write_text(text)
    program = {"file": str(folder / "part.nc"), **LIMITS}
    path = written(folder, machine)
    structure = {"machine": str(path), "settling": 0.2}
    stock = further.pop("stock", None)
    case = cut_case(structure, program=program, **further)
    return case if stock is None else case.patch({"stock": {"box": stock}})


def test_the_stop_at_the_end_of_a_stable_program_is_no_chatter(tmp_path):
    case = programmed(tmp_path, two_axes(), "G1 X8 F1200\n")
    # the same cut, which goes on and on
    plain = cut_case(case.structure.model_dump(exclude_unset=True), revolutions=20)
    assert simulate(plain).detection.verdict == "stable"
    assert simulate(case).detection.verdict == "stable"


def test_a_slow_block_at_the_end_is_judged_too(tmp_path):
    """4 mm at 20 mm/s, then 2 mm at 5 mm/s: the last quarter second is cut at the lower feed."""
    result = simulate(programmed(tmp_path, two_axes(), "G1 X4 F1200\nG1 X6 F300\n"))
    first, last = steady_parts(result)
    assert np.ptp(result.time[first]) > 0.15
    assert np.ptp(result.time[last]) > 0.35
    judged = result.time[last][-1]
    # 5 m/s2 and 400 m/s3: 5 mm/s are gone within 2 (0.005 / 400)^0.5 s
    assert result.time[-1] - judged < 0.1


def test_in_the_air_it_is_the_move(tmp_path):
    """Far from its stock the cut does nothing, and the axes do what the move alone does."""
    machine = two_axes(soft=True)
    machine["move"] = {
        "part": {
            "kind": "nc program",
            "file": str(tmp_path / "part.nc"),
            "axes": ["X", "Y"],
            **LIMITS,
        }
    }
    far = [{"x": [0.1, 0.12], "y": [0.1, 0.12], "z": [0.0, 0.01]}]
    result = simulate(programmed(tmp_path, machine, chip="dexel", stock=far))
    assert not np.any(result.force)
    alone = move(MachineFile.from_file(tmp_path / "machine.toml"), "part")
    for column, axis in enumerate(alone.axes):
        travelled = result.position_of(axis) - result.position_of(axis)[0]
        both = alone.time < result.time[-1]
        there = np.interp(alone.time[both], result.time, travelled)
        wanted = alone.wanted[both, column]
        size = np.abs(wanted - alone.scale[both, column]).max()
        assert size > 1e-6
        assert np.abs(there - alone.scale[both, column]).max() < 0.02 * size
    # the tool itself: its path and what it is off it
    place = result.setup.path.position_at(result.time) + result.displacement[:, :2].T
    for column in range(2):
        there = np.interp(alone.time[both], result.time, place[column])
        assert np.abs(there - alone.tool[both, column]).max() < 0.02 * size


@pytest.mark.parametrize("table_moves", [False, True])
def test_stiff_axes_cut_as_a_rigid_tool_does(tmp_path, table_moves):
    """Whichever part moves, the tool goes along the program against the workpiece."""
    case = programmed(tmp_path, two_axes(table_moves), steps=400)
    result = simulate(case)
    sign = -1.0 if table_moves else 1.0
    assert result.setup.on_machine.travels["x"] == pytest.approx({"X": sign})
    assert result.setup.on_machine.travels["y"] == pytest.approx({"Y": sign})
    travelled = [result.position_of(axis)[-1] - result.position_of(axis)[0] for axis in "XY"]
    assert travelled == pytest.approx([sign * 8e-3, sign * 7e-3], abs=5e-5)
    rigid = simulate(case.patch({"structure": None}))
    for begin in (0.12, 0.38, 0.6):
        # whole revolutions, in which the axes have the feed that is commanded
        means = [
            one.force[(one.time >= begin) & (one.time < begin + 0.06)].mean(axis=0)
            for one in (result, rigid)
        ]
        assert means[0] == pytest.approx(means[1], abs=0.03 * np.linalg.norm(means[1]))


def test_a_spindle_under_control_takes_the_speeds_of_the_program(tmp_path):
    text = "S3000\nG1 X4 F1200\nS4500\nG1 Y6\n"
    result = simulate(programmed(tmp_path, two_axes(), text))
    begin = result.setup.path.spindle.begins[1]
    slow, fast = result.time < begin - 0.02, result.time > begin + 0.1
    assert result.spindle_speed[slow].mean() == pytest.approx(100.0 * np.pi, rel=2e-3)
    assert result.spindle_speed[fast].mean() == pytest.approx(150.0 * np.pi, rel=2e-3)


def test_a_direction_that_no_axis_moves(tmp_path):
    machine = two_axes()
    del machine["axis"]["Y"]
    machine["connector"]["ways"] = spring("saddle", "bed")
    with pytest.raises(InputError, match=r"simulation\.program.*along y"):
        simulate(programmed(tmp_path, machine))


CORNERS = {
    "corner near the end": "G1 X8 F1200\nG1 Y8\nG1 X10\n",
    "dwell near the end": "G1 X8 F1200\nG4 F0.3\nG1 X10\n",
    "stairs": "G1 X5 F1200\nG1 Y5\nG1 X10\nG1 Y10\nG1 X11\n",
}
#: a slot by a tool of four straight teeth, in a material that a soft slide bears to a few mm
SLOT = {
    "tool": {"helix": "0 deg"},
    "cut": {"mode": "slot", "radial_depth": "16 mm"},
    "material": {"Ktc": 1.8e9, "Krc": 6e8, "Kac": 0.0},
}


@pytest.mark.parametrize("program", CORNERS)
def test_a_program_with_corners_chatters_as_the_plain_cut_does(tmp_path, program):
    """Transients of axes behind corners and stops are no chatter; the limit is of the modes."""
    machine = two_axes(soft=True)
    machine["connector"]["guide"]["stiffness"]["y"] = 2e7
    machine["connector"]["guide"]["damping"]["y"] = 5e3
    case = programmed(tmp_path, machine, CORNERS[program], **SLOT)
    structure = case.structure.model_dump(exclude_unset=True)
    plain = cut_case({**structure, "feed": [1.0, 0.0, 0.0]}, revolutions=20, **SLOT)
    limit = 1e-3 * check(plain).summary()["critical_depth_mm"]
    assert 1e-3 < limit < 0.02
    for share, verdict in ((0.5, "stable"), (1.4, "chatter")):
        found = simulate(case, {"cut.axial_depth": share * limit}).detection
        assert found.verdict == verdict, found.reason


def test_a_program_without_a_long_line_is_not_judged(tmp_path):
    result = simulate(programmed(tmp_path, two_axes(), "G1 X2 F1200\nG1 Y2\nG1 X4\nG1 Y4\n"))
    assert result.detection is None
    assert result.why_no_verdict.startswith("no part of the program at a constant feed")
