"""The surface that simulated cuts leave, and the pictures of runs."""

import copy
import json
import math

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import chatter
from chatter.simulation.finish import finish_from_profiles, finish_of, scallop_height
from chatter.simulation.reconstruction import WallProfiles
from chatter.simulation.simulate import simulate

RADIUS, FEED, TEETH = 10e-3, 0.1e-3, 4
CUSP = FEED**2 / (8.0 * RADIUS)

CASE = {
    "tool": {"kind": "end mill", "teeth": TEETH, "diameter": "20 mm", "helix": "0 deg"},
    "material": {"Ktc": "800 MPa", "Krc": "300 MPa", "Kte": "10 N/mm", "Kre": "15 N/mm"},
    "cut": {
        "mode": "down",
        "spindle_speed": "6000 rpm",
        "feed_per_tooth": "0.1 mm",
        "axial_depth": "1 mm",
        "radial_depth": "10 mm",
    },
    "simulation": {"revolutions": 24},
}
MODES = [
    {"frequency": "600 Hz", "damping": 0.1, "stiffness": "10 N/um", "direction": [1, 0, 0]},
    {"frequency": "700 Hz", "damping": 0.1, "stiffness": "10 N/um", "direction": [0, 1, 0]},
]


def cut(modes=None, **changes):
    case = copy.deepcopy(CASE)
    for section, values in changes.items():
        case.setdefault(section, {}).update(values)
    if modes:
        case["structure"] = {"mode": modes}
    return simulate(chatter.Case.from_dict(case))


def no_nan(value):
    json.dumps(value, allow_nan=False)
    return value


@pytest.mark.parametrize("mode", ["up", "down", "slot"])
def test_rigid_tool_leaves_the_cusps_of_its_feed(mode):
    numbers = no_nan(finish_of(cut(cut={"mode": mode, "radial_depth": "20 mm"})).summary())
    assert numbers["surface_location_error_um"] == pytest.approx(-CUSP / 3.0 * 1e6, rel=0.05)
    rough = numbers["roughness"]["wall"]
    # a parabola of height c: Ra = 4 c / (9 sqrt 3), Rq = 2 c / (3 sqrt 5)
    assert rough["Ra_um"] == pytest.approx(4.0 * CUSP / (9.0 * math.sqrt(3.0)) * 1e6, rel=0.05)
    assert rough["Rq_um"] == pytest.approx(2.0 * CUSP / (3.0 * math.sqrt(5.0)) * 1e6, rel=0.05)
    assert rough["Rz_um"] == pytest.approx(CUSP * 1e6, rel=0.06)
    assert numbers["waviness"]["wall"]["Wa_um"] < 1e-3 * rough["Ra_um"]
    sides = {"up": {"+y"}, "down": {"-y"}, "slot": {"+y", "-y"}}[mode]
    assert set(numbers["surface_location"]["walls"]) == sides
    assert numbers["roughness"]["floor"]["Ra_um"] is None


def test_runout_marks_the_wall_once_a_turn():
    result = cut(tool={"runout": {"offset": "20 um", "angle": "0 deg"}})
    numbers = finish_of(result).summary()
    once = TEETH**2 * CUSP
    assert numbers["surface_location_error_um"] == pytest.approx((20e-6 - once / 3) * 1e6, rel=5e-3)
    assert numbers["roughness"]["wall"]["Rz_um"] == pytest.approx(once * 1e6, rel=0.08)


@pytest.mark.parametrize(("mode", "side", "direction"), [("up", 1.0, 0.0), ("down", -1.0, math.pi)])
def test_wall_stands_where_the_tool_was_when_the_teeth_passed(mode, side, direction):
    """Schmitz and Ziegert 1999: the displacement at the passing is the location error."""
    result = cut(MODES, cut={"mode": mode}, simulation={"revolutions": 40})
    motion = CubicSpline(result.spindle_angle, result.displacement[:, 1])
    passing = 2.0 * math.pi * (30 + np.arange(TEETH) / TEETH) + direction
    expected = side * motion(passing).mean()
    error = finish_of(result).location_error
    assert error == pytest.approx(expected, abs=0.03 * np.ptp(result.displacement[:, 1]))
    assert abs(error) > 1e-6


def test_ball_leaves_scallops_on_the_floor():
    numbers = finish_of(cut(tool={"kind": "ball"}, cut={"axial_depth": "2 mm"})).summary()
    floor = numbers["roughness"]["floor"]
    assert floor["Rz_um"] == pytest.approx(CUSP * 1e6, rel=0.02)
    assert numbers["surface_location"]["floor_um"] == pytest.approx(-CUSP / 3.0 * 1e6, rel=0.02)


def test_scallops_between_passes_are_where_two_circles_cross():
    # a triangle of 3, 4 and 5: the scallop of a ball of radius 5 at a stepover of 8 is 2 high
    assert scallop_height(10.0, 8.0) == pytest.approx(2.0, rel=1e-12)
    assert scallop_height(10.0, 10.0) == pytest.approx(5.0, rel=1e-12)


def test_a_sharp_corner_has_a_location_of_the_floor_and_no_roughness():
    modes = [{**MODES[0], "direction": [0, 0, 1]}]
    result = cut(modes, tool={"kind": "end mill"}, material={"Kac": "300 MPa"})
    numbers = finish_of(result).summary()
    assert numbers["surface_location"]["floor_um"] is not None
    assert numbers["roughness"]["floor"]["Ra_um"] is None
    assert any("minor cutting edge" in note for note in numbers["surface_evaluation"]["notes"])


def test_bull_nose_leaves_the_scallops_of_its_corner():
    tool = {"kind": "bull nose", "corner_radius": "1 mm"}
    slot = {"mode": "slot", "radial_depth": "20 mm", "axial_depth": "2 mm"}
    floor = finish_of(cut(tool=tool, cut=slot)).summary()["roughness"]["floor"]
    assert floor["Rz_um"] == pytest.approx(FEED**2 / (8.0 * 1e-3) * 1e6, rel=0.02)


def test_wall_of_a_tall_helical_cut_is_given_over_its_height():
    result = cut(MODES, tool={"helix": "30 deg"}, cut={"axial_depth": "2 mm"})
    (wall,) = finish_of(result).walls
    assert wall.profiles.height[0] < 0.1e-3
    assert wall.profiles.height[-1] > 1.9e-3
    # upper edges pass later, while the tool sways
    motion = CubicSpline(result.spindle_angle, result.displacement[:, 1])
    late = wall.profiles.height * math.tan(math.radians(30.0)) / RADIUS
    turns = np.arange(14, 22, 1.0 / TEETH)[:, None]
    sampled = -motion(2.0 * math.pi * turns + math.pi + late).mean(axis=0)
    assert wall.location_errors == pytest.approx(sampled, abs=0.05 * np.ptp(result.displacement))
    assert np.corrcoef(wall.location_errors, sampled)[0, 1] > 0.98


def test_serrated_edge_leaves_what_no_other_tooth_takes():
    wave = {"depth": "0.5 mm", "wavelength": "2 mm"}
    (wall,) = finish_of(cut(tool={"serration": wave}, cut={"axial_depth": "2 mm"})).walls
    # four waves shifted by a quarter: the one furthest out makes the wall
    phase = 2.0 * math.pi * (wall.profiles.height[:, None] / 2e-3 + np.arange(TEETH) / TEETH)
    outermost = 0.25e-3 * (np.cos(phase).max(axis=1) - 1.0)
    assert wall.profiles.deviation.max(axis=1) == pytest.approx(outermost, abs=1e-8)


def test_short_runs_say_so():
    for turns in (0.3, 1.0, 2.0):
        finish = finish_of(cut(MODES, simulation={"revolutions": turns}))
        numbers = no_nan(finish.summary())
        if numbers["surface_location_error_um"] is None:
            assert any("too short" in note for note in finish.notes)


def test_a_tool_that_overhangs_on_both_sides_leaves_no_wall():
    wide = {"mode": "face", "workpiece_width": "16 mm", "radial_depth": None}
    result = cut(MODES, cut=wide)
    assert "wall: none is left, the tool overhangs the work on both sides" in result.finish.notes
    assert not result.finish.walls
    # a floor without marks is flat in the picture, not the rounding of its numbers
    profiles = result.plot().axes[-1]
    low, high = profiles.get_ylim()
    assert high - low >= 1e-3
    beside = cut(MODES, cut={**wide, "tool_offset": "6 mm"})
    assert len(beside.finish.walls) == 1


def test_carved_profiles_are_evaluated_alike():
    x = np.arange(4000) * 4e-6
    profile = 5e-6 + 1e-6 * np.sin(2.0 * math.pi * x / 0.1e-3)
    wall = WallProfiles("+y", x, np.array([1e-3]), profile[None, :], np.ones(1))
    numbers = no_nan(finish_from_profiles([wall], None, TEETH * FEED).summary())
    assert numbers["surface_location_error_um"] == pytest.approx(5.0, rel=1e-3)
    assert numbers["roughness"]["wall"]["Ra_um"] == pytest.approx(2.0 / math.pi, rel=0.01)


@pytest.mark.parametrize(
    ("modes", "changes"),
    [
        (MODES, {}),
        (MODES, {"cut": {"mode": "slot", "radial_depth": "20 mm", "axial_depth": "8 mm"}}),
        (None, {}),
        (MODES, {"simulation": {"revolutions": 0.3}}),
        (MODES, {"tool": {"kind": "ball"}}),
    ],
)
def test_picture_names_its_axes(modes, changes, tmp_path):
    result = cut(modes, **changes)
    figure = result.plot()
    figure.savefig(tmp_path / "run.png", dpi=40)
    labels = " ".join(axes.get_xlabel() + axes.get_ylabel() for axes in figure.axes)
    surface = ("[mm]",) if result.finish.walls or result.finish.floor else ()
    for unit in ("[N]", "[µm]", "[Hz]", *surface):
        assert unit in labels
    title = figure.get_suptitle()
    assert "6000 rpm" in title
    judged = result.detection
    assert (judged.verdict if judged else "not judged") in title


def test_spectrum_gives_the_amplitude_of_a_sine():
    from chatter.plots.simulation import spectrum

    time = np.arange(4000) * 1e-4
    frequency, amplitude = spectrum(time, 3.0 + 2.5 * np.sin(2.0 * math.pi * 100.0 * time))
    assert frequency[np.argmax(amplitude)] == pytest.approx(100.0)
    assert amplitude.max() == pytest.approx(2.5, rel=1e-6)
