"""Structures that depend on the spindle speed: every speed has the limits of its own modes."""

import math

import numpy as np
import pytest

import chatter
from chatter.app.live_case import LiveCase
from chatter.compile.structure import structure_of
from chatter.description.case import Case, loads
from chatter.description.errors import InputError
from chatter.description.progress import no_progress
from chatter.engine.parallel import SerialExecutor
from chatter.stability.methods.zeroth_order.limits import zero_order_of
from chatter.stability.model import milling_model
from chatter.stability.registry import METHODS
from dynamics.modal.modes import Mode, receptance_matrix

RPM = math.pi / 30.0
TEXT = """
[tool]
teeth = 2
diameter = "16 mm"
[material]
Ktc = "600 MPa"
Krc = "200 MPa"
[cut]
mode = "down"
spindle_speed = "10000 rpm"
feed_per_tooth = "0.1 mm"
axial_depth = "1 mm"
radial_depth = "8 mm"
[lobes]
speeds = {{ from = "8000 rpm", to = "16000 rpm", count = 9 }}
depths = {{ to = "6 mm", count = 30 }}
{modes}
"""
MODE = """
[[structure.mode]]
frequency = "900 Hz"
damping = 0.02
mass = "0.05 kg"
direction = [{direction}]
{more}
"""
#: splits as a gyroscopic pair does: one mode falls as the speed rises, the other climbs
FALLING = """
[structure.mode.speed_dependence]
speeds = ["0 rpm", "10000 rpm", "20000 rpm"]
frequency = ["900 Hz", "820 Hz", "700 Hz"]
damping = [0.02, 0.03, 0.05]
"""
RISING = """
[structure.mode.speed_dependence]
speeds = ["0 rpm", "20000 rpm"]
frequency = ["900 Hz", "1100 Hz"]
mass = ["0.05 kg", "0.04 kg"]
"""


def case_of(*more):
    axes = ("1, 0, 0", "0, 1, 0")
    modes = "".join(
        MODE.format(direction=axis, more=text) for axis, text in zip(axes, more, strict=False)
    )
    return loads(TEXT.format(modes=modes))


GYROSCOPIC = case_of(FALLING, RISING)


def constant_at(rpm):
    """The same cut with constant modes: those that the tables hold at a speed, by hand."""
    falling = np.interp(rpm, [0, 10000, 20000], [900, 820, 700])
    damping = np.interp(rpm, [0, 10000, 20000], [0.02, 0.03, 0.05])
    rising, mass = np.interp(rpm, [0, 20000], [900, 1100]), np.interp(rpm, [0, 20000], [0.05, 0.04])
    data = case_of("", "")
    return data.patch(
        {
            "structure.mode[0].frequency": float(falling),
            "structure.mode[0].damping": float(damping),
            "structure.mode[1].frequency": float(rising),
            "structure.mode[1].mass": float(mass),
        }
    )


def test_modes_are_linear_between_the_speeds_and_held_beyond():
    section = GYROSCOPIC.structure.mode[0]
    assert section.frequency_at(15000 * RPM) == pytest.approx(760.0)
    assert section.damping_at(5000 * RPM) == pytest.approx(0.025)
    assert section.frequency_at(30000 * RPM) == pytest.approx(700.0)
    assert section.mass_at(15000 * RPM) == pytest.approx(0.05)
    first, second = structure_of(GYROSCOPIC).modes
    assert (first.frequency, first.damping) == pytest.approx((820.0, 0.03))
    assert (second.frequency, second.mass) == pytest.approx((1000.0, 0.045))


def test_a_stiffness_of_the_table_goes_with_the_frequency_at_that_speed():
    table = FALLING.replace("damping = [0.02, 0.03, 0.05]", 'stiffness = ["1 N/um", 1.2e6, 2e6]')
    (mode,) = structure_of(case_of(table)).modes
    assert mode.mass == pytest.approx(1.2e6 / (2.0 * math.pi * 820.0) ** 2)


@pytest.mark.parametrize("method", [name for name in METHODS.names() if name != "time-domain"])
def test_the_limit_at_each_speed_is_that_of_its_modes(method):
    speeds, depths = np.array([9000.0, 12500.0, 15000.0]) * RPM, np.linspace(0.0, 6e-3, 31)[1:]
    found = METHODS[method].limits(milling_model(GYROSCOPIC), speeds, depths, None, no_progress)
    for place, speed in enumerate(speeds):
        own = milling_model(constant_at(speed / RPM))
        alone = METHODS[method].limits(own, np.array([speed]), depths, None, no_progress)
        assert found.crossings[place].tolist() == pytest.approx(alone.crossings[0].tolist(), 1e-9)
        assert found.chatter_frequency[place] == pytest.approx(alone.chatter_frequency[0], 1e-9)
        assert found.bifurcation[place] == alone.bifurcation[0]
    assert np.isfinite(found.critical_depth).all()


def test_the_diagram_its_grid_and_the_check_agree():
    diagram = chatter.lobes(GYROSCOPIC, grid=True)
    still = chatter.lobes(case_of("", ""))
    assert not np.allclose(diagram.limits.critical_depth, still.limits.critical_depth, rtol=0.02)
    for place in (0, 4, 8):
        speed = diagram.limits.spindle_speed[place]
        case = GYROSCOPIC.patch({"cut.spindle_speed": float(speed), "cut.axial_depth": 2e-3})
        found = chatter.check(case)
        assert diagram.limits.critical_depth[place] == pytest.approx(found.critical_depth, rel=1e-6)
        row = int(np.argmin(np.abs(diagram.grid.y_axis.values - 2.0)))
        assert diagram.grid.y_axis.values[row] == pytest.approx(2.0)
        assert diagram.grid.spectral_radius[row, place] == pytest.approx(
            found.spectral_radius, rel=1e-4
        )
        assert found.zero_order_depth == pytest.approx(
            diagram.zero_order.critical_depth[place], rel=1e-9
        )
    assert any("depends on the spindle speed" in note for note in diagram.notes)
    assert any("from 0 to 20000 rpm" in note for note in diagram.notes)
    blocks = chatter.lobes(GYROSCOPIC, grid=True, cluster=SerialExecutor()).grid
    assert blocks.spectral_radius == pytest.approx(diagram.grid.spectral_radius, rel=1e-6)


def test_the_chatter_frequency_follows_the_falling_mode():
    case = case_of(FALLING)
    depths = np.linspace(0.0, 40e-3, 41)[1:]
    speeds = np.array([3000.0, 19000.0]) * RPM
    found = METHODS["zero-order"].limits(milling_model(case), speeds, depths, None, no_progress)
    # down-milling on one mode along the feed: chatter lies a little below the mode it belongs to
    own = np.array([876.0, 712.0])
    assert found.chatter_frequency == pytest.approx(0.97 * own, rel=0.03)


def test_a_slope_and_a_table_of_the_same_line_are_the_same():
    slope = case_of("frequency_slope = -1e-4")
    ends = [900.0 * (1.0 - 1e-4 * rpm * RPM) for rpm in (0.0, 16000.0)]
    table = case_of(
        'speed_dependence = { speeds = ["0 rpm", "16000 rpm"], '
        f"frequency = [{ends[0]!r}, {ends[1]!r}] }}"
    )
    a, b = (chatter.lobes(case) for case in (slope, table))
    assert a.limits.critical_depth == pytest.approx(b.limits.critical_depth, rel=1e-6)


def test_the_live_page_takes_each_speed_with_its_modes():
    page = LiveCase(GYROSCOPIC, None)
    shown = page.diagram({}, "coarse", no_progress)
    speeds = np.array(shown["spindle_speed_rpm"]) * RPM
    place = len(speeds) // 3
    depths = np.linspace(0.0, 6e-3, 61)[1:]
    own = milling_model(constant_at(speeds[place] / RPM))
    alone = METHODS["collocation"].limits(own, speeds[[place]], depths, None, no_progress)
    assert shown["crossings_mm"][place][0] == pytest.approx(alone.critical_depth[0] * 1e3, rel=6e-3)


def test_a_simulation_takes_the_modes_of_its_speed():
    short = {"simulation.revolutions": 2}
    rpm = 12500.0
    found = chatter.simulate(GYROSCOPIC.patch({"cut.spindle_speed": rpm * RPM, **short}))
    own = chatter.simulate(constant_at(rpm).patch({"cut.spindle_speed": rpm * RPM, **short}))
    assert found.displacement == pytest.approx(own.displacement, abs=1e-15)


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (
            'speed_dependence = { speeds = ["1 rpm", "2 rpm"], frequency = [900] }',
            "frequency: [900] is given",
        ),
        (
            'speed_dependence = { speeds = ["1 rpm", "2 rpm", "3 rpm"], frequency = [900, 800] }',
            "frequency: has 2 values for 3 speeds",
        ),
        (
            'speed_dependence = { speeds = ["2 rpm", "1 rpm"], frequency = [900, 800] }',
            "speeds: must ascend",
        ),
        ('speed_dependence = { speeds = ["1 rpm", "2 rpm"] }', "says nothing"),
        ('speed_dependence = { speeds = ["1 rpm", "2 rpm"], damping = [0.1, 1.5] }', "less than 1"),
        (
            'speed_dependence = { speeds = ["1 rpm", "2 rpm"], mass = [1, 1], stiffness = [1, 1] }',
            "mass or stiffness, not both",
        ),
        (
            "frequency_slope = 1e-5\n"
            'speed_dependence = { speeds = ["1 rpm", "2 rpm"], frequency = [1, 2] }',
            "frequency_slope: and speed_dependence.frequency",
        ),
    ],
)
def test_wrong_tables_are_told(more, said):
    with pytest.raises(InputError) as caught:
        case_of(more)
    assert all("structure.mode[0]" in message for message in caught.value.messages)
    assert any(said in message for message in caught.value.messages), caught.value.messages


# --- measured FRFs at several speeds --------------------------------------------------------------


def written_frf(folder, name, frequency, axis="x"):
    lines = np.arange(100.0, 2000.0, 2.0)
    mode = Mode(frequency, 0.03, 0.05, (1.0, 0.0, 0.0), "tool")
    value = receptance_matrix((mode,), lines)[:, 0, 0]
    rows = [f"{f:.6g},{v.real:.12e},{v.imag:.12e}" for f, v in zip(lines, value, strict=True)]
    text = "\n".join(["frequency [Hz],real [m/N],imag [m/N]", *rows]) + "\n"
    (folder / name).write_text(text)
    return f'[[structure.frf]]\nfile = "{name}"\ndirection = "{axis}"\n'


def test_frfs_of_the_nearest_speed_stand_for_it(tmp_path):
    files = written_frf(tmp_path, "slow.csv", 900.0) + 'spindle_speed = "8000 rpm"\n'
    files += written_frf(tmp_path, "fast.csv", 700.0) + 'spindle_speed = "14000 rpm"\n'
    case = loads(TEXT.format(modes=files), folder=tmp_path)
    alone = {
        name: milling_model(
            loads(TEXT.format(modes=written_frf(tmp_path, name, f)), folder=tmp_path)
        )
        for name, f in (("slow.csv", 900.0), ("fast.csv", 700.0))
    }
    speeds = np.array([8000.0, 10900.0, 11100.0, 15000.0]) * RPM
    model = milling_model(case)
    found = zero_order_of(model, speeds).critical_depth
    assert found[:2] == pytest.approx(zero_order_of(alone["slow.csv"], speeds[:2]).critical_depth)
    assert found[2:] == pytest.approx(zero_order_of(alone["fast.csv"], speeds[2:]).critical_depth)
    assert any("8000, 14000 rpm" in note for note in model.notes)
    depths = np.linspace(0.0, 8e-3, 31)[1:]
    limit = METHODS["collocation"].limits(model, speeds[[3]], depths, None, no_progress)
    own = METHODS["collocation"].limits(alone["fast.csv"], speeds[[3]], depths, None, no_progress)
    assert limit.critical_depth == pytest.approx(own.critical_depth)


def test_other_directions_at_another_speed_are_refused(tmp_path):
    files = written_frf(tmp_path, "slow.csv", 900.0) + 'spindle_speed = "8000 rpm"\n'
    files += written_frf(tmp_path, "fast.csv", 700.0, "y") + 'spindle_speed = "14000 rpm"\n'
    model = milling_model(loads(TEXT.format(modes=files), folder=tmp_path))
    with pytest.raises(InputError, match="14000 rpm the tool point moves in other directions"):
        zero_order_of(model, np.array([8000.0, 15000.0]) * RPM)


def test_a_case_of_several_speeds_is_written_and_read_again():
    again = Case.from_text(GYROSCOPIC.to_toml())
    assert again.structure == GYROSCOPIC.structure
    moved = GYROSCOPIC.patch({"structure.mode[0].speed_dependence.frequency": [900, 850, 800]})
    assert moved.structure.mode[0].frequency_at(10000 * RPM) == pytest.approx(850.0)
