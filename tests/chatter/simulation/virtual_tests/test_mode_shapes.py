"""Mode shapes of a block on springs, whose frequencies and shapes are known."""

import itertools
import json
import math

import numpy as np
import pytest

import chatter
from chatter.description.machine.machine_file import MachineFile
from tests.command_line import chatter_command
from tests.places import EXAMPLES

BLOCK = """
title = "block on springs"
[body.block]
mass = "100 kg"
size = ["400 mm", "200 mm", "100 mm"]
centre = ["0 mm", "0 mm", "50 mm"]
[connector.springs]
between = ["block", "ground"]
at = ["0 mm", "0 mm", "50 mm"]
stiffness = { x = "10 N/um", y = "40 N/um", z = "90 N/um", rx = "1e7 N*m/rad", ry = "1e7 N*m/rad", rz = "4e5 N*m/rad" }
"""  # noqa: E501


@pytest.fixture(scope="module")
def shapes():
    return chatter.mode_shapes(MachineFile.from_text(BLOCK))


def test_translations_and_a_rotation_of_a_block(shapes):
    about_z = 100.0 / 12.0 * (0.4**2 + 0.2**2)
    wanted = sorted(
        math.sqrt(k / m) / (2.0 * math.pi)
        for k, m in ((1e7, 100.0), (4e7, 100.0), (9e7, 100.0), (4e5, about_z))
    )
    assert shapes.frequency[:4] == pytest.approx(wanted, rel=1e-6)


def test_a_translation_moves_every_corner_alike(shapes):
    along_x = int(np.argmin(np.abs(shapes.frequency - math.sqrt(1e5) / (2.0 * math.pi))))
    assert np.abs(shapes.shapes[along_x]) == pytest.approx(
        np.tile([1.0, 0.0, 0.0], (8, 1)), abs=1e-6
    )


def test_a_rotation_turns_the_corners_about_the_axis(shapes):
    about_z = 100.0 / 12.0 * (0.4**2 + 0.2**2)
    turned = int(np.argmin(np.abs(shapes.frequency - math.sqrt(4e5 / about_z) / (2.0 * math.pi))))
    x, y = shapes.points[:, 0], shapes.points[:, 1]
    wanted = np.stack((-y, x), axis=1) / math.hypot(0.2, 0.1)
    found = shapes.shapes[turned][:, :2]
    assert found * np.sign(found[0, 0] * wanted[0, 0]) == pytest.approx(wanted, abs=1e-6)


def test_a_block_has_twelve_edges(shapes):
    assert shapes.lines.shape == (12, 2)
    lengths = np.linalg.norm(np.diff(shapes.points[shapes.lines], axis=1)[:, 0], axis=1)
    assert sorted(set(np.round(lengths, 9))) == [0.1, 0.2, 0.4]


def test_files(shapes, tmp_path):
    shapes.save(tmp_path)
    with np.load(tmp_path / "mode-shapes.npz", allow_pickle=False) as arrays:
        assert arrays["frequency"] == pytest.approx(shapes.frequency)
    assert (tmp_path / "mode-shapes.png").read_bytes().startswith(b"\x89PNG")


def test_numbers_below_the_shapes_of_a_large_machine_stand_apart():
    text = BLOCK.replace('["400 mm", "200 mm", "100 mm"]', '["600 mm", "3000 mm", "500 mm"]')
    figure = chatter.mode_shapes(MachineFile.from_text(text)).plot()
    figure.draw_without_rendering()
    for axes in figure.axes:
        low, high = axes.get_xlim()
        ticks = [tick for tick in axes.xaxis.get_major_ticks() if low <= tick.get_loc() <= high]
        boxes = [tick.label1.get_window_extent() for tick in ticks]
        gaps = [right.x0 - left.x1 for left, right in itertools.pairwise(boxes)]
        # at least the width of a figure, a fifth of "-1000"
        assert min(gaps) > 0.2 * boxes[0].width


def test_the_command_gives_the_frequencies_and_writes_the_shapes(tmp_path):
    path = tmp_path / "block.toml"
    path.write_text(BLOCK)
    words = chatter_command(
        "mode-shapes", path, "--out", tmp_path, "--set", "body.block.mass=400 kg"
    )
    assert words.exit_code == 0, words.output
    along_x = math.sqrt(1e7 / 400.0) / (2.0 * math.pi)
    assert f"{along_x:.2f}" in words.stdout
    assert (tmp_path / "mode-shapes.png").is_file()
    told = chatter_command("mode-shapes", path, "--out", tmp_path, "--count", 1, "--json")
    (lowest,) = json.loads(told.stdout)["frequencies_Hz"]
    assert lowest == pytest.approx(math.sqrt(1e7 / 100.0) / (2.0 * math.pi), rel=1e-6)
    with np.load(tmp_path / "mode-shapes.npz", allow_pickle=False) as arrays:
        assert arrays["shapes"].shape == (1, 8, 3)


def test_parts_of_matrices_are_drawn_by_their_points():
    """Bodies floated in the air where the crossbeam between them was imported."""
    file = chatter.load_machine(EXAMPLES / "machine-gantry" / "machine.toml")
    shapes = chatter.mode_shapes(file, count=1)
    section = file.imported["gantry"]
    place = {
        name: int(np.argmin(np.linalg.norm(shapes.points - np.array(one.at), axis=1)))
        for name, one in section.point.items()
    }
    for name, one in section.point.items():
        assert shapes.points[place[name]] == pytest.approx(one.at, abs=1e-9)
    joined = {tuple(sorted(line)) for line in shapes.lines.tolist()}
    for rail in section.rail:
        for first, second in itertools.pairwise(rail):
            assert tuple(sorted((place[first], place[second]))) in joined
    # every point hangs together with the others
    reached, waiting = set(), [place["rail_1"]]
    while waiting:
        now = waiting.pop()
        reached.add(now)
        waiting += [b if a == now else a for a, b in joined if now in (a, b)
                    and (b if a == now else a) not in reached]  # fmt: skip
    assert set(place.values()) <= reached


def test_the_frequencies_are_a_table(shapes, tmp_path):
    shapes.save(tmp_path)
    rows = (tmp_path / "frequencies.csv").read_text().splitlines()
    assert rows[0] == "mode,natural frequency [Hz]"
    along_x = math.sqrt(1e7 / 100.0) / (2.0 * math.pi)
    assert min(abs(float(row.split(",")[1]) - along_x) for row in rows[1:]) < 1e-3
