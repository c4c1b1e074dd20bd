"""Axes feed the tool; which of the two moves, and where the machine points, changes no cut."""

import numpy as np
import pytest

from chatter.simulation.simulate import simulate
from tests.chatter.simulation.on_machine.coupled_machines import (
    body,
    control,
    cut_case,
    linear_axis,
    spindle,
    spring,
    written,
)

FEED = 0.1e-3 * 4 * 50.0  # m/s
KV = 50.0


def slide(table_moves):
    """Slide that carries table or tool along x; all else is stiff, and centred at the tip."""
    on_bed, on_slide = {"on": "bed", "at": [0.0] * 3}, {"on": "slide", "at": [0.0] * 3}
    return {
        "tool_point": "tip",
        "workpiece": "work",
        "body": {"bed": body(1e5), "slide": body(50.0)},
        "connector": {"foot": spring("bed", "ground"), "guide": spring("slide", "bed", x=0.0)},
        "point": {
            "tip": on_bed if table_moves else on_slide,
            "work": on_slide if table_moves else on_bed,
        },
        "axis": {
            "X": linear_axis((1, 0, 0), "slide", "bed", ["slide"]),
            "S": spindle("bed", inertia=0.02),
        },
    }


@pytest.fixture(scope="module")
def moving_table_and_tool(tmp_path_factory):
    folder = tmp_path_factory.mktemp("slides")
    results = []
    for table in (True, False):
        path = written(folder, slide(table), f"{table}.toml")
        case = cut_case({"machine": str(path), "settling": 0.5}, revolutions=20)
        results.append(simulate(case))
    return results


def test_table_or_tool_may_move(moving_table_and_tool):
    table, tool = moving_table_and_tool
    assert table.setup.on_machine.feeds == pytest.approx({"X": -1.0})
    assert tool.setup.on_machine.feeds == pytest.approx({"X": 1.0})
    size = np.abs(tool.force).max()
    assert np.abs(table.force - tool.force).max() < 1e-5 * size
    shift = np.abs(tool.displacement).max()
    assert shift > 1e-6
    assert np.abs(table.displacement - tool.displacement)[:, 0].max() < 1e-5 * shift


def test_the_drive_bears_the_mean_force_of_the_cut(moving_table_and_tool):
    for result, sign in zip(moving_table_and_tool, (1.0, -1.0), strict=True):
        settled = result.settled
        mean = result.force[settled, 0].mean()
        assert abs(mean) > 20.0
        assert result.torque_of("X")[settled].mean() == pytest.approx(sign * mean, rel=0.01)
        travelled = np.polyfit(result.time[settled], result.position_of("X")[settled], 1)[0]
        assert travelled == pytest.approx(-sign * FEED, rel=1e-3)


def test_following_error_of_the_position_loop(tmp_path):
    """Without feedforward the axis lags by v/Kv, and gives way by F/(Kp Kv)."""
    machine = slide(True)
    machine["axis"]["X"]["control"] = control(KV, 1e5) | {"feedforward": {"velocity": 0.0}}
    path = written(tmp_path, machine)
    result = simulate(cut_case({"machine": str(path), "settling": 1.0}, revolutions=20))
    settled = result.settled
    # the axes come to speed within 0.3 s, half of which is lost
    wanted = -FEED * (1.0 + result.time - 0.15)
    error = (wanted - result.position_of("X"))[settled].mean()
    force = result.torque_of("X")[settled].mean()
    assert force > 10.0
    assert error == pytest.approx(-FEED / KV + force / (1e5 * KV), rel=1e-3)


def turned(rotation):
    """Saddle and table under an elastic head, off all centres, in any orientation."""
    rotation = np.asarray(rotation, dtype=float)

    def at(*place):
        return (rotation @ np.array(place)).tolist()

    def block(mass, centre, inertia):
        tensor = rotation @ np.diag(inertia) @ rotation.T
        six = [tensor[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
        return {"mass": mass, "inertia": six, "centre": at(*centre)}

    def joint(first, second, place, free=None, size=1.0):
        stiffness = {"x": 2e8, "y": 3e8, "z": 4e8, "rx": 3e7, "ry": 2e7, "rz": 3e7}
        kept = {way: size * k for way, k in stiffness.items() if way != free}
        return {
            "between": [first, second],
            "at": at(*place),
            "axes": rotation.T.tolist(),
            "stiffness": kept,
            "damping": {way: 1e-4 * k for way, k in kept.items()},
        }

    def axis(way, moving, carrying, carries):
        return linear_axis(at(*way), moving, carrying, carries)

    tip = at(0.05, -0.03, 0.3)
    return {
        "tool_point": "tip",
        "workpiece": "work",
        "body": {
            "bed": block(500.0, (0, 0.1, -0.4), (30.0, 40.0, 35.0)),
            "saddle": block(120.0, (0, 0, 0.0), (4.0, 3.0, 5.0)),
            "table": block(90.0, (0, 0.02, 0.15), (2.0, 3.0, 4.0)),
            "head": block(60.0, (0.1, 0.3, 0.6), (1.2, 1.5, 0.9)),
        },
        "connector": {
            "feet": joint("bed", "ground", (0.1, 0, -0.6)),
            "guide_y": joint("saddle", "bed", (0, 0, -0.1), "y"),
            "guide_x": joint("table", "saddle", (0, 0, 0.05), "x"),
            "neck": joint("head", "bed", (0, 0.4, 0.4), None, 0.5),
        },
        "point": {"tip": {"on": "head", "at": tip}, "work": {"on": "table", "at": tip}},
        "axis": {
            "X": axis((1, 0, 0), "table", "saddle", ["table"]),
            "Y": axis((0, 1, 0), "saddle", "bed", ["saddle", "table"]),
            "S": spindle("head", at(0, 0, -1), inertia=0.02),
        },
    }


def cutting(folder, rotation, feed, upwards=None):
    path = written(folder, turned(rotation))
    structure = {"machine": str(path), "feed": feed, "settling": 0.4}
    if upwards is not None:
        structure["tool_axis"] = upwards
    return simulate(cut_case(structure, revolutions=6))


#: z to x, x to y, y to z; and any other
CYCLIC = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
SKEW = np.linalg.qr(np.array([[0.3, 0.5, -0.2], [0.7, -0.1, 0.4], [0.2, 0.6, 0.9]]))[0]
SKEW = SKEW * np.sign(np.linalg.det(SKEW))
OBLIQUE = [0.6, -0.8, 0.0]


@pytest.mark.parametrize("rotation", [CYCLIC, SKEW])
def test_turning_machine_and_cut_together_changes_nothing(tmp_path, rotation):
    assert np.linalg.det(rotation) == pytest.approx(1.0)
    upright = cutting(tmp_path, np.eye(3), OBLIQUE)
    laid = cutting(tmp_path, rotation, (rotation @ OBLIQUE).tolist(), rotation[:, 2].tolist())
    assert upright.setup.on_machine.feeds == pytest.approx({"X": -0.6, "Y": 0.8}, abs=1e-9)
    for name in ("displacement", "force", "spindle_speed"):
        one, other = getattr(upright, name), getattr(laid, name)
        size = np.abs(one).max(axis=0)
        # the last digits of coordinates decide on which side of an entry the instant of a row is
        apart = np.abs(one - other) > 1e-5 * size
        assert apart.mean() < (0.02 if name == "force" else 1e-9)


@pytest.mark.parametrize(
    ("feed", "axes"),
    [
        ([1, 0, 0], {"X": -1}),
        ([-1, 0, 0], {"X": 1}),
        ([0, 1, 0], {"Y": -1}),
        ([0, -1, 0], {"Y": 1}),
    ],
)
def test_the_mean_feed_is_the_one_commanded(tmp_path, feed, axes):
    result = cutting(tmp_path, np.eye(3), feed)
    assert result.setup.on_machine.feeds == pytest.approx(axes, abs=1e-9)
    settled = result.settled
    for name in ("X", "Y"):
        speed = np.polyfit(result.time[settled], result.position_of(name)[settled], 1)[0]
        assert speed == pytest.approx(FEED * axes.get(name, 0.0), abs=0.01 * FEED)
    # a stiff machine cuts with the forces of a rigid tool, whichever way it is fed
    rigid = simulate(cut_case(None, steps=400, revolutions=6))
    mean = rigid.force[rigid.settled].mean(axis=0)
    assert result.force[settled].mean(axis=0) == pytest.approx(mean, rel=0.02)
