"""Chip thickness of a rigid tool: pitch, runout, tooth errors, serration, speed variation."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from chatter import Case
from chatter.simulation.simulate import simulate

KTC, KRC, KAC = 1.0e9, 4.0e8, 2.0e8
RADIUS, DEPTH, FEED = 8e-3, 2e-3, 60e-6
TURN = 2.0 * math.pi


def run(tool=None, cut=None, material=None, **simulation):
    """Rigid tool in a slot, straight edges, no edge terms unless said otherwise."""
    return simulate(
        Case.from_dict(
            {
                "title": "rigid tool",
                "tool": {"kind": "end mill", "teeth": 4, "diameter": 2.0 * RADIUS, **(tool or {})},
                "material": {
                    "law": "linear", "Ktc": KTC, "Krc": KRC, "Kac": KAC, **(material or {}),
                },
                "cut": {
                    "mode": "slot",
                    "spindle_speed": "3000 rpm",
                    "feed_per_tooth": FEED,
                    "axial_depth": DEPTH,
                    "radial_depth": 2.0 * RADIUS,
                    **(cut or {}),
                },
                "simulation": {"revolutions": 2, "steps": 720, **simulation},
            }
        )
    )  # fmt: skip


def chips(found, tooth_angles):
    """Chip thickness (N,) of each tooth where it points along the feed, from the axial force.

    All other teeth that are in the cut must be at sin(phi) = 0 then: two teeth, or four.
    """
    thickness = []
    for angle in tooth_angles:
        place = np.mod(0.5 * math.pi - angle, TURN) + TURN
        at = np.argmin(np.abs(found.spindle_angle - place))
        assert abs(found.spindle_angle[at] - place) < 1e-9
        thickness.append(found.force[at, 2] / (KAC * DEPTH))
    return np.array(thickness)


def test_chip_is_proportional_to_the_pitch():
    # tooth 1 stands 150 deg ahead of tooth 0 and passed before it
    found = run({"teeth": 2, "pitch": ["150 deg", "210 deg"]})
    at = np.searchsorted(found.spindle_angle, TURN + 0.5 * math.pi - 1e-9)
    assert found.force[at, 2] / (KAC * DEPTH) == pytest.approx(2 * FEED * 150 / 360, rel=1e-9)
    at = np.searchsorted(found.spindle_angle, 2 * TURN + math.radians(90 - 150) - 1e-9)
    assert found.force[at, 2] / (KAC * DEPTH) == pytest.approx(2 * FEED * 210 / 360, rel=1e-9)


def test_single_tooth_takes_the_feed_of_a_turn():
    assert chips(run({"teeth": 1}), [0.0]) == pytest.approx([FEED], rel=1e-9)


@pytest.mark.parametrize("angle_deg", [0.0, 25.0, 100.0])
def test_small_runout_changes_each_chip_by_the_difference_to_the_tooth_before(angle_deg):
    offset = 8e-6
    found = run({"runout": {"offset": offset, "angle": f"{angle_deg} deg"}})
    angles = 0.5 * math.pi * np.arange(4)
    radial = offset * np.cos(math.radians(angle_deg) - angles)
    wanted = FEED + radial - np.roll(radial, -1)
    assert chips(found, angles) == pytest.approx(wanted, abs=1e-10)


def test_large_runout_leaves_the_cut_to_one_tooth():
    found = run({"runout": {"offset": "400 um", "angle": "90 deg"}})
    got = chips(found, 0.5 * math.pi * np.arange(4))
    assert got == pytest.approx([0.0, 4.0 * FEED, 0.0, 0.0], abs=1e-10)


def test_medium_runout_is_cut_by_some_teeth():
    offset = 1.2 * FEED
    found = run({"runout": {"offset": offset, "angle": 0.0}})
    radial = offset * np.array([1.0, 0.0, -1.0, 0.0])
    # the tooth at k places ahead passed k tooth periods ago
    against = [
        min(k * FEED + radial[j] - radial[(j + k) % 4] for k in (1, 2, 3, 4)) for j in range(4)
    ]
    wanted = np.maximum(against, 0.0)
    assert wanted.min() == 0.0
    assert wanted.sum() == pytest.approx(4.0 * FEED)
    assert chips(found, 0.5 * math.pi * np.arange(4)) == pytest.approx(wanted, abs=1e-10)


def test_radial_error_of_one_tooth():
    found = run({"radial_error": [0.0, "10 um", 0.0, 0.0]})
    wanted = FEED + np.array([-10e-6, 10e-6, 0.0, 0.0])
    assert chips(found, 0.5 * math.pi * np.arange(4)) == pytest.approx(wanted, abs=1e-10)


def test_axial_error_of_an_inclined_insert():
    # a tooth that stands down by d cuts d cos(kappa) more, along the normal of the edge
    tool = {"teeth": 2, "kind": "inserted", "cutting_edge_angle": "45 deg"}
    plain, set_down = run(tool), run({**tool, "axial_error": ["10 um", 0.0]})
    at = np.searchsorted(plain.spindle_angle, TURN + 0.5 * math.pi - 1e-9)
    root = math.sqrt(0.5)
    length = DEPTH / root
    gain = set_down.force[at] - plain.force[at]
    extra = 10e-6 * root
    assert gain[1] == pytest.approx(KTC * extra * length, rel=1e-9)
    assert gain[0] == pytest.approx((KAC - KRC) * root * extra * length, rel=1e-9)
    assert gain[2] == pytest.approx((KAC + KRC) * root * extra * length, rel=1e-9)


VARIANTS = {
    "small runout": {"runout": {"offset": "10 um", "angle": "25 deg"}},
    "large runout": {"runout": {"offset": "300 um", "angle": "70 deg"}},
    "unequal pitch": {"pitch": ["80 deg", "100 deg", "85 deg", "95 deg"]},
    "tooth errors": {"radial_error": ["20 um", "-90 um", 0.0, "33 um"]},
    "serration": {"serration": {"depth": "0.4 mm", "wavelength": "1 mm"}},
    "variable helix": {"helix": ["30 deg", "33 deg", "30 deg", "33 deg"]},
}


@pytest.mark.parametrize("name", list(VARIANTS))
@pytest.mark.parametrize("mode", ["slot", "up", "down"])
def test_teeth_share_one_volume(name, mode):
    """All teeth together remove feed times section, at every angle, however they share it.

    With the linear law and no edge terms the mean force and torque stay those of an even tool.
    """
    cut = {"mode": mode, "radial_depth": 0.6 * RADIUS if mode != "slot" else 2.0 * RADIUS}
    helix = {} if name == "variable helix" else {"helix": "30 deg"}
    found = run({**helix, **VARIANTS[name]}, cut)
    turn = slice(720, 1440)
    width = 0.6 * RADIUS if mode != "slot" else 2.0 * RADIUS
    torque = KTC * 4 * FEED * width * DEPTH / TURN
    assert found.torque[turn].mean() == pytest.approx(torque, rel=1e-4)
    arc = {"slot": (0.0, math.pi), "up": (0.0, math.acos(0.4))}
    arc["down"] = (math.pi - math.acos(0.4), math.pi)
    begin, end = arc[mode]
    ss = [0.5 * phi - 0.25 * math.sin(2 * phi) for phi in (begin, end)]
    sc = [0.5 * math.sin(phi) ** 2 for phi in (begin, end)]
    scale = 4 * FEED * DEPTH / TURN
    fx = scale * (-KTC * (sc[1] - sc[0]) - KRC * (ss[1] - ss[0]))
    fy = scale * (KTC * (ss[1] - ss[0]) - KRC * (sc[1] - sc[0]))
    fz = scale * KAC * (math.cos(begin) - math.cos(end))
    size = math.hypot(fx, fy, fz)
    assert found.force[turn].mean(axis=0) == pytest.approx([fx, fy, fz], abs=1e-4 * size)


def test_serrated_edges_cut_fewer_teeth_at_a_height():
    # edge force alone counts the teeth in contact: half of two deeply serrated ones
    edge = {"Ktc": 1e3, "Krc": 0.0, "Kac": 0.0, "Kte": 1e4}
    tool = {"teeth": 2, "helix": "30 deg"}
    depth = {"axial_depth": "4 mm"}
    plain = run(tool, depth, edge).torque[720:1440].mean()
    tool["serration"] = {"depth": "1.5 mm", "wavelength": "2 mm"}
    serrated = run(tool, depth, edge).torque[720:1440].mean()
    assert plain == pytest.approx(1e4 * 4e-3 * RADIUS, rel=1e-3)
    assert 0.5 * plain < serrated < 0.56 * plain


def test_variable_helix_along_the_edge():
    # chip at a height: feed speed times the time between the flutes there
    helix = np.radians([30.0, 40.0])
    tool = {"teeth": 2, "helix": [f"{math.degrees(h)!r} deg" for h in helix]}
    found = run(tool, {"axial_depth": "6 mm"}, slices=60)
    z = (np.arange(20000) + 0.5) / 20000 * 6e-3
    lag = np.tan(helix)[:, None] / RADIUS * z
    between = np.array([math.pi + lag[0] - lag[1], math.pi + lag[1] - lag[0]])
    for at in range(730, 1440, 71):
        wanted = 0.0
        for j in range(2):
            sine = np.sin(found.spindle_angle[at] + math.pi * j - lag[j])
            chip = 2.0 * FEED / TURN * between[j] * sine
            wanted += KAC * 6e-3 * np.mean(np.where(sine > 0.0, chip, 0.0))
        assert found.force[at, 2] == pytest.approx(wanted, rel=1e-5)


def angle_at(t, speed, amplitude, frequency):
    """Angle turned by a spindle whose speed varies as a sine."""
    return speed * (t + amplitude / (TURN * frequency) * (1.0 - math.cos(TURN * frequency * t)))


def test_sine_speed_variation_changes_the_chip_with_the_true_delay():
    speed, amplitude, frequency = 100.0 * math.pi, 0.3, 11.0
    found = run(
        {"teeth": 3},
        {"speed_variation": {"amplitude": amplitude, "frequency": f"{frequency} Hz"}},
        revolutions=8,
    )
    feed_speed = 3 * FEED * speed / TURN
    wanted, got, thickest = [], [], 0.0
    for at in range(1500, found.time.size, 83):
        t = found.time[at]
        theta = angle_at(t, speed, amplitude, frequency)
        assert found.spindle_angle[at] == pytest.approx(theta, rel=1e-12)
        phis = np.mod(theta + TURN * np.arange(3) / 3, TURN)
        if np.any(np.abs(np.sin(phis)) < 1e-3):
            continue
        tau = t - brentq(
            lambda s, theta=theta: angle_at(s, speed, amplitude, frequency) - theta + TURN / 3,
            t - 0.02, t, xtol=1e-16,
        )  # fmt: skip
        thickest = max(thickest, feed_speed * tau)
        wanted.append(KAC * DEPTH * feed_speed * tau * np.sum(np.maximum(np.sin(phis), 0.0)))
        got.append(found.force[at, 2])
    assert thickest > 1.2 * FEED
    assert got == pytest.approx(wanted, rel=1e-6)


def test_speed_of_the_spindle_is_the_derivative_of_its_angle():
    for shape in ("sine", "triangle"):
        found = run(cut={"speed_variation": {"amplitude": 0.2, "frequency": "20 Hz",
                                             "shape": shape}}, revolutions=6)  # fmt: skip
        rate = np.gradient(found.spindle_angle, found.time)[1:-1]
        assert np.allclose(rate, found.spindle_speed[1:-1], rtol=2e-3)
        assert np.ptp(found.spindle_speed) == pytest.approx(0.4 * 100 * math.pi, rel=1e-3)


def test_tiny_speed_variation_is_constant_speed():
    structure = [{"frequency": "600 Hz", "damping": 0.03, "mass": 0.5, "direction": [1, 0, 0]}]

    def simulated(cut):
        return simulate(
            Case.from_dict(
                {
                    "title": "tiny variation",
                    "tool": {
                        "kind": "end mill", "teeth": 3, "diameter": 2.0 * RADIUS,
                        "helix": "30 deg",
                    },
                    "material": {"law": "linear", "Ktc": KTC, "Krc": KRC, "Kac": KAC},
                    "cut": {
                        "mode": "down",
                        "spindle_speed": "3000 rpm",
                        "feed_per_tooth": FEED,
                        "axial_depth": DEPTH,
                        "radial_depth": 5e-3,
                        **cut,
                    },
                    "structure": {"mode": structure},
                    "simulation": {"revolutions": 6},
                }
            )
        )  # fmt: skip

    still = simulated({})
    varied = simulated({"speed_variation": {"amplitude": 1e-8, "frequency": "10 Hz"}})
    for name in ("force", "displacement"):
        one, other = getattr(still, name), getattr(varied, name)
        assert np.abs(one - other).max() < 2e-5 * np.abs(one).max()
