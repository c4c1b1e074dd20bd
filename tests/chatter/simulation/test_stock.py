"""Carved workpieces in the time domain: the window about the tool, blocks, corners, passes."""

import math

import numpy as np
import pytest

from chatter import Case, InputError
from chatter.engine.loop import run as compiled_run
from chatter.simulation import workpiece as stock_module
from chatter.simulation.carved_workpiece import FollowingStock, carved_walls
from chatter.simulation.setup import set_up
from chatter.simulation.simulate import run_setup, simulate

KTC, RADIUS, DEPTH, FEED, TEETH = 8e8, 4e-3, 2e-3, 0.1e-3, 4
SPEED = 100.0 * math.pi  # rad/s
FEED_RATE = FEED * TEETH * SPEED / (2.0 * math.pi)
A_TOOTH = 180  # steps
MODES = [
    {"frequency": "700 Hz", "damping": 0.04, "stiffness": "2e7 N/m", "direction": [0, 1, 0]},
    {"frequency": "500 Hz", "damping": 0.04, "stiffness": "3e7 N/m", "direction": [1, 0, 0]},
]


def case(
    chip="dexel", cut=None, material=None, tool=None, structure=None, stock=None, **simulation
):
    """Two layers of straight teeth, coarse; a slot where `cut` does not say otherwise."""
    content = {
        "tool": {"kind": "end mill", "teeth": TEETH, "diameter": 2.0 * RADIUS, **(tool or {})},
        "material": {"Ktc": KTC, "Krc": 3e8},
        "cut": {
            "mode": "slot",
            "spindle_speed": "3000 rpm",
            "feed_per_tooth": FEED,
            "axial_depth": DEPTH,
            "radial_depth": 2.0 * RADIUS,
            **(cut or {}),
        },
        "simulation": {"chip": chip, "slices": 2, "steps": 720, **simulation},
    }
    if structure:
        content["structure"] = {"mode": structure}
    if stock:
        content["stock"] = {"box": stock}
    return Case.from_dict(content)


def block(x, y, z=(0.0, 5e-3), **more):
    """Box of a stock, m."""
    return {"x": list(x), "y": list(y), "z": list(z), **more}


def stock_of(found):
    return found.setup.groups[0].stock


def memory(found):
    return sum(part.nbytes for part in stock_of(found) if isinstance(part, np.ndarray))


def removed(found):
    return float(found.setup.groups[0].removed[0])


def torque_a_tooth(found):
    """Place of the axis (2, n), m, and mean torque, N m, over every tooth period."""
    count = (len(found.rows) - 1) // A_TOOTH
    mean = found.torque[1 : count * A_TOOTH + 1].reshape(count, A_TOOTH).mean(axis=1)
    middle = found.time[A_TOOTH // 2 :: A_TOOTH][:count]
    return found.setup.path.position_at(middle), mean


def torque_of(width):
    """Mean torque (N m) that removes a width across the feed: Ktc times volume rate over speed.

    True but for the feed against the speed of the edge, to which the chip thickness answers.
    """
    return KTC * DEPTH * np.asarray(width) * FEED_RATE / SPEED


#: feed against the speed of the edge, and half the chip against the radius
FEED_SHARE = FEED_RATE / (SPEED * RADIUS) + 0.5 * FEED / RADIUS


# --- window about the tool -----------------------------------------------------------------------


def in_one_stock(given, monkeypatch):
    """Run a case through one stock that is long enough for all of it."""
    steps = int((given.simulation.revolutions + 4) * given.simulation.steps)
    with monkeypatch.context() as patch:
        patch.setattr(stock_module, "STEPS_A_CHUNK", steps)
        patch.setattr(stock_module, "_LONGEST_WAY", 1e3)
        patch.setattr(FollowingStock, "follow", lambda self, x: self.cut)
        return run_setup(set_up(given))[0]


@pytest.mark.parametrize("chip", ["dexel", "voxel"])
@pytest.mark.parametrize("mode", ["slot", "down", "up"])
def test_window_cuts_as_one_large_stock_does(chip, mode, monkeypatch):
    width = {"slot": 2.0 * RADIUS, "down": 0.4 * RADIUS, "up": 1.3 * RADIUS}[mode]
    given = case(
        chip,
        {"mode": mode, "radial_depth": width},
        # no edge at exactly 45 deg, where rounding chooses the lines that are read
        tool={"helix": "30 deg"},
        structure=MODES,
        revolutions=14,
        resolution="30 um",
    )
    large = in_one_stock(given, monkeypatch)
    monkeypatch.setattr(stock_module, "STEPS_A_CHUNK", 333)
    moved = run_setup(set_up(given))[0]
    assert memory(moved) < 0.85 * memory(large)
    tolerance = 0.0 if chip == "voxel" else 1e-12 * np.abs(large.force).max()
    assert np.abs(moved.force - large.force).max() <= tolerance
    assert np.abs(moved.displacement).max() > 1e-6
    assert removed(moved) == pytest.approx(removed(large), rel=1e-12)


@pytest.mark.parametrize("mode", ["slot", "down", "up"])
def test_walls_are_kept_of_what_falls_off(mode, monkeypatch):
    given = case(
        "dexel",
        {"mode": mode, "radial_depth": 2.0 * RADIUS if mode == "slot" else 0.4 * RADIUS},
        structure=MODES,
        revolutions=60,
        resolution="40 um",
    )
    large = in_one_stock(given, monkeypatch)
    monkeypatch.setattr(stock_module, "STEPS_A_CHUNK", 1500)
    moved = run_setup(set_up(given))[0]
    assert stock_of(moved).box[0] > moved.setup.path.position_at(moved.time[moved.settled])[0, 0]
    found, wanted = carved_walls(moved), carved_walls(large)
    assert len(found) == len(wanted) == (2 if mode == "slot" else 1)
    for one, other in zip(found, wanted, strict=True):
        assert one.x == pytest.approx(other.x, rel=1e-12)
        assert np.ptp(one.deviation) > 1e-8
        assert np.abs(one.deviation - other.deviation).max() < 1e-14


@pytest.mark.parametrize("chip", ["dexel", "voxel"])
def test_memory_of_the_stock_does_not_grow_with_the_run(chip):
    given = case(chip, {"mode": "down", "radial_depth": RADIUS}, resolution="50 um", slices=1)
    short = simulate(given.patch({"simulation.revolutions": 10}))
    long = simulate(given.patch({"simulation.revolutions": 200}))
    assert memory(short) == memory(long)
    for found, turns in ((short, 10), (long, 200)):
        swept = DEPTH * RADIUS * FEED * TEETH * turns
        assert removed(found) == pytest.approx(swept, rel=1e-3)
    tooth = torque_a_tooth(long)[1]
    assert np.allclose(tooth[4:], torque_of(RADIUS), rtol=2e-2)


def test_memory_stays_bounded_where_the_tool_goes_far_in_few_steps():
    given = case(
        cut={"feed_per_tooth": "1 mm", "mode": "down", "radial_depth": RADIUS},
        resolution="0.1 mm", slices=1, steps=180, revolutions=60,
    )  # fmt: skip
    found = simulate(given)
    x0, x1, *_ = stock_of(found).box
    # the window ends around the tool, after 60 times 4 mm
    assert x0 < 0.24 - RADIUS
    assert x1 > 0.24 + RADIUS
    assert x1 - x0 < 9.0 * RADIUS
    assert removed(found) == pytest.approx(0.24 * RADIUS * DEPTH, rel=2e-3)


def test_moving_window_compiles_nothing_anew(monkeypatch):
    given = case(revolutions=2, resolution="0.1 mm")
    simulate(given)
    compiled = len(compiled_run.signatures)
    monkeypatch.setattr(stock_module, "STEPS_A_CHUNK", 200)
    simulate(given)
    assert len(compiled_run.signatures) == compiled


def test_given_stock_is_held_as_a_whole():
    found = simulate(
        case(
            stock=[block((0.0, 30e-3), (-5e-3, 5e-3))],
            path=[[-5e-3, 0.0], [50e-3, 0.0]], revolutions=60, resolution="0.1 mm",
        )
    )  # fmt: skip
    assert stock_of(found).box == pytest.approx((0.0, 30e-3, -5e-3, 5e-3))


# --- blocks --------------------------------------------------------------------------------------


@pytest.mark.parametrize("chip", ["dexel", "voxel"])
def test_way_through_a_block(chip):
    """In and out again from the side: the torque is that of the front within the block."""
    length = 7e-3
    found = simulate(
        case(
            chip,
            stock=[block((0.0, length), (-6e-3, 6e-3))],
            path=[[-5e-3, 0.0], [50e-3, 0.0]], revolutions=46, resolution="25 um",
        )
    )  # fmt: skip
    axis = found.setup.path.position_at(found.time)[0]
    size = np.linalg.norm(found.force, axis=1)
    assert size.max() > 100.0
    assert np.all(size[axis + RADIUS < -1e-6] == 0.0)
    # an edge leaves with the wall at its side, half a turn and the feed late
    assert np.all(size[axis > length + 2.0 * FEED * TEETH] < 1e-3 * size.max())
    (x, _), torque = torque_a_tooth(found)
    # half the width of the front before the block, and beyond it
    before = np.sqrt(np.maximum(RADIUS**2 - np.minimum(x, 0.0) ** 2, 0.0))
    beyond = np.sqrt(np.maximum(RADIUS**2 - np.maximum(length - x, 0.0) ** 2, 0.0))
    beyond[length - x > RADIUS] = 0.0
    width = 2.0 * np.maximum(before - beyond, 0.0)
    width[(x < -RADIUS) | (x > length)] = 0.0
    full = torque_of(2.0 * RADIUS)
    # a tooth removes what has come to it since the one before, within an arc of the turn
    assert np.abs(torque - torque_of(width)).max() < 0.16 * full
    entering = (x > -RADIUS) & (x < -0.3 * RADIUS)
    assert np.all(np.diff(torque[entering]) > -0.01 * full)
    assert torque[(x > 0.3e-3) & (x < 2.7e-3)] == pytest.approx(full, rel=FEED_SHARE)
    assert torque.sum() == pytest.approx(torque_of(width).sum(), rel=FEED_SHARE)
    assert removed(found) == pytest.approx(length * 2.0 * RADIUS * DEPTH, rel=1e-3)


@pytest.mark.parametrize("chip", ["dexel", "voxel"])
@pytest.mark.parametrize("step", ["z", "y"])
def test_step_in_the_stock(chip, step):
    """Half the depth, or half the width, up to x = 6 mm, and all of it behind."""
    y, z = (-5e-3, 5e-3), (0.0, 5e-3)
    low = block((-6e-3, 6e-3), y, (0.0, 1e-3)) if step == "z" else block((-6e-3, 6e-3), (-5e-3, 0))
    hole = block((-20e-3, 0.0), y, z, remove=True)
    found = simulate(
        case(
            chip,
            stock=[low, hole, block((6e-3, 20e-3), y, z)],
            path=[[-5e-3, 0.0], [50e-3, 0.0]], revolutions=45, resolution="40 um",
        )
    )  # fmt: skip
    (x, _), torque = torque_a_tooth(found)
    first, second = (x > 0.4e-3) & (x < 6e-3 - RADIUS - 0.2e-3), (x > 6.6e-3) & (x < 12e-3)
    assert np.count_nonzero(first) > 10
    half, full = (torque_of(share * 2.0 * RADIUS) for share in (0.5, 1.0))
    assert torque[first].mean() == pytest.approx(half, rel=FEED_SHARE)
    assert torque[second].mean() == pytest.approx(full, rel=FEED_SHARE)


def corner_stock(width, corner):
    """Pocket with walls at the right hand and ahead, of which a width is to be removed."""
    far = corner + RADIUS + 1e-3
    return [
        block((0.0, far), (-RADIUS - 1e-3, -RADIUS + width)),
        block((corner + RADIUS - width, far), (-RADIUS - 1e-3, 14e-3)),
    ]


@pytest.mark.parametrize("chip", ["dexel", "voxel"])
def test_corner_of_a_pocket(chip):
    width, corner = 0.6e-3, 12e-3
    given = case(
        chip,
        stock=corner_stock(width, corner),
        path=[[-3e-3, 0.0], [corner, 0.0], [corner, 30e-3]],
        revolutions=55, resolution="25 um",
    )  # fmt: skip
    found = simulate(given)
    (x, y), torque = torque_a_tooth(found)
    straight = (x > 4e-3) & (x < corner - 3e-3)
    after = (y > 0.5e-3) & (y < 6e-3)
    assert np.count_nonzero(after) > 30
    assert torque[straight].mean() == pytest.approx(torque_of(width), rel=1.1 * FEED_SHARE)
    assert torque[after].mean() == pytest.approx(torque_of(width), rel=1.1 * FEED_SHARE)
    # in the corner the front is in the wall ahead as well, on both sides of the axis
    ahead = 2.0 * math.sqrt(2.0 * RADIUS * width - width**2)
    peak = torque[(x > corner - 0.2e-3) & (y < 1e-4)].max()
    assert peak == pytest.approx(torque_of(width + ahead), rel=0.06)
    before = found.setup.path.position_at(found.time)[0] < corner - 3e-3
    size = np.linalg.norm(found.force, axis=1)
    assert size.max() > 1.5 * size[before].max()
    # the edge force alone counts the edges in contact; voxels miss the thinnest chips
    close = 0.04 if chip == "dexel" else 0.1
    edge = {"Ktc": 1e4, "Krc": 0.0, "Kte": 1e4}
    (x, y), contact = torque_a_tooth(
        simulate(given.patch({f"material.{k}": edge[k] for k in edge}))
    )
    arc = contact / (1e4 * DEPTH * RADIUS * TEETH / (2.0 * math.pi))
    straight = (x > 4e-3) & (x < corner - 3e-3)
    engaged = math.acos(1.0 - width / RADIUS)
    assert arc[straight].mean() == pytest.approx(engaged, rel=close)
    assert arc[(x > corner - 0.2e-3) & (y < 1e-4)].max() == pytest.approx(
        3.0 * engaged, rel=1.5 * close
    )


# --- second pass ---------------------------------------------------------------------------------

SLAB = block((0.0, 6e-3), (-7e-3, 7e-3))
STRAIGHT = [[-5e-3, 0.0], [50e-3, 0.0]]


@pytest.fixture(scope="module", params=["dexel", "voxel"])
def first_pass(request):
    given = case(request.param, stock=[SLAB], path=STRAIGHT, revolutions=40, resolution="40 um")
    return simulate(given)


def test_second_pass_finds_nothing_left(first_pass):
    again = simulate(first_pass.case, workpiece=first_pass)
    assert removed(again) == pytest.approx(0.0, abs=1e-3 * removed(first_pass))
    assert np.abs(again.force).max() < 5e-3 * np.abs(first_pass.force).max()


def test_second_pass_cuts_what_the_first_has_left(first_pass):
    aside = 1e-3
    given = first_pass.case.patch(
        {
            "simulation.path": [[-5e-3, -aside], [50e-3, -aside]],
            "simulation.resolution": None,
            "stock": None,
        }
    )
    before = stock_of(first_pass)
    held = [part.copy() for part in before if isinstance(part, np.ndarray)]
    second = simulate(given, workpiece=first_pass)
    (x, _), torque = torque_a_tooth(second)
    # the front of the cut lies up to this far ahead of the axis
    ahead = math.sqrt(RADIUS**2 - (RADIUS - aside) ** 2)
    middle = (x > 0.5e-3) & (x < 6e-3 - ahead)
    assert np.count_nonzero(middle) > 20
    assert torque[middle].mean() == pytest.approx(torque_of(aside), rel=FEED_SHARE)
    assert removed(second) == pytest.approx(6e-3 * aside * DEPTH, rel=5e-3)
    after = [part for part in stock_of(first_pass) if isinstance(part, np.ndarray)]
    assert all(np.array_equal(one, other) for one, other in zip(held, after, strict=True))
    third = simulate(given.patch({"simulation.resolution": "40 um"}), workpiece=second)
    assert np.abs(third.force).max() < 5e-3 * np.abs(second.force).max()


def test_second_pass_with_other_teeth(first_pass):
    given = first_pass.case.patch(
        {"tool.teeth": 2, "simulation.path": [[-5e-3, -1e-3], [50e-3, -1e-3]]}
    ).patch({"simulation.revolutions": 70})
    second = simulate(given, workpiece=first_pass)
    assert removed(second) == pytest.approx(6e-3 * 1e-3 * DEPTH, rel=5e-3)


@pytest.mark.parametrize(
    ("changed", "wanted"),
    [
        ({"cut.axial_depth": "1 mm"}, "layers"),
        ({"simulation.slices": 3}, "layers"),
        ({"simulation.resolution": "20 um"}, "resolution"),
        ({"simulation.chip": "delay", "stock": None, "simulation.path": None}, "simulation.chip"),
        ({"stock.box[0].x": ["0 mm", "7 mm"]}, "stock"),
    ],
)
def test_second_pass_that_does_not_fit_is_refused(first_pass, changed, wanted):
    with pytest.raises(InputError, match=wanted) as caught:
        simulate(first_pass.case.patch(changed), workpiece=first_pass)
    assert len(caught.value.messages) == 1


def test_workpiece_that_was_not_held_is_refused():
    found = simulate(case(revolutions=1, resolution="0.1 mm"))
    with pytest.raises(InputError, match=r"needs \[stock\]"):
        simulate(found.case, workpiece=found)
