"""Cuts of inclined tools against points of edges that are summed up in the axes of the machine."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import chatter
from chatter.description.case import Case
from chatter.description.progress import no_progress
from chatter.stability.model import milling_model
from chatter.stability.registry import METHODS

RADIUS, DEPTH, FEED, TEETH = 5e-3, 0.5e-3, 0.1e-3, 2
HELIX = math.radians(30.0)
KTC, KRC, KAC, KTE, KRE, KAE = 1900e6, 700e6, 200e6, 20e3, 30e3, 5e3
COEFFICIENTS = np.array([[KTC, KRC, KAC], [KTE, KRE, KAE]])


def case_of(lead, tilt, mode="slot", stepover=None, **further):
    cut = {
        "mode": mode, "spindle_speed": "8000 rpm", "feed_per_tooth": FEED, "axial_depth": DEPTH,
        "lead": f"{lead} deg", "tilt": f"{tilt} deg",
    }  # fmt: skip
    if stepover is not None:
        cut["stepover"] = stepover
    keys = ("Ktc", "Krc", "Kac", "Kte", "Kre", "Kae")
    return Case.from_dict(
        {
            "tool": {"kind": "ball", "teeth": TEETH, "diameter": 2 * RADIUS, "helix": "30 deg"},
            "material": dict(zip(keys, COEFFICIENTS.ravel().tolist(), strict=True)),
            "cut": cut,
            **further,
        }
    )


class Edge:
    """One edge of the ball in many pieces, at every angle of a turn, in the axes of the machine."""

    def __init__(self, lead, tilt, mode, stepover, pieces=700, angles=720):
        turned = Rotation.from_euler("x", -math.radians(tilt)) * Rotation.from_euler(
            "y", math.radians(lead)
        )
        kappa = (np.arange(pieces) + 0.5) * 0.5 * math.pi / pieces
        self.length = RADIUS * 0.5 * math.pi / pieces
        height = RADIUS * (1.0 - np.cos(kappa))
        self.spindle = 2.0 * math.pi * np.arange(angles) / angles
        phi = self.spindle[:, None] - height * math.tan(HELIX) / RADIUS
        sk, ck = np.sin(kappa), np.cos(kappa)

        def in_machine(x, y, z):
            parts = np.stack([part + 0.0 * phi for part in (x, y, z)], axis=-1)
            return turned.apply(parts.reshape(-1, 3)).reshape(parts.shape)

        # outward normal, direction in which the edge moves, and along the meridian to the shank
        self.normal = in_machine(sk * np.sin(phi), sk * np.cos(phi), -ck)
        self.motion = in_machine(np.cos(phi), -np.sin(phi), 0.0)
        self.meridian = in_machine(ck * np.sin(phi), ck * np.cos(phi), sk)
        # a ball: points lie along the normal from its middle, the floor a radius below that
        _, y, z = np.moveaxis(RADIUS * self.normal, -1, 0)
        self.ahead = self.normal[..., 0]
        self.cuts = (self.ahead > 0.0) & (z < DEPTH - RADIUS)
        if mode != "slot":
            middle = -stepover if mode == "up" else stepover
            self.cuts &= np.hypot(y - middle, z) > RADIUS
        self.radius = RADIUS * sk

    def forces(self, feed=FEED):
        """Force (n, 3) of one edge over the turn, and torque (n,)."""
        chip = feed * self.ahead
        along = COEFFICIENTS[0, :, None, None] * chip + COEFFICIENTS[1, :, None, None]
        tangential, radial, axial = along * self.cuts * self.length
        force = (
            -tangential[..., None] * self.motion
            - radial[..., None] * self.normal
            + axial[..., None] * self.meridian
        )
        return force.sum(axis=1), (tangential * self.radius).sum(axis=1)

    def averaged(self):
        """Stiffness (3, 3) of the chip of all teeth, averaged over a turn, N/m."""
        push = -KTC * self.motion - KRC * self.normal + KAC * self.meridian
        engaged = self.cuts[..., None, None]
        whole = (engaged * push[..., :, None] * self.normal[..., None, :]).sum(axis=1)
        # the force is minus this times the motion
        return -TEETH * self.length * whole.mean(axis=0)


CUTS = [
    (15, 0, "slot", None),
    (15, 0, "up", 0.4e-3),
    (10, -15, "up", 1e-3),
    (5, 20, "down", 0.6e-3),
    (0, -25, "down", 2e-3),
    (-8, 4, "slot", None),
    (-8, 4, "up", 1e-3),
]


@pytest.mark.parametrize(("lead", "tilt", "mode", "stepover"), CUTS)
def test_forces_of_a_rigid_tool(lead, tilt, mode, stepover):
    edge = Edge(lead, tilt, mode, stepover)
    one, of_one = edge.forces()
    half = len(one) // TEETH
    wanted = one + np.roll(one, half, axis=0)
    torque = of_one + np.roll(of_one, half)
    found = chatter.simulate(case_of(lead, tilt, mode, stepover, simulation={"revolutions": 4}))
    largest = np.abs(wanted).max()
    assert found.mean_force == pytest.approx(wanted.mean(axis=0), abs=4e-3 * largest)
    assert found.mean_torque == pytest.approx(torque.mean(), rel=4e-3)
    assert np.abs(found.peak_force).max() == pytest.approx(largest, rel=1.5e-2)
    # angle by angle, in the third turn
    turn = 2.0 * math.pi
    at = found.spindle_angle - 2.0 * turn
    rows = np.flatnonzero((at >= 0.0) & (at < turn))
    for axis in range(3):
        there = np.interp(at[rows], np.append(edge.spindle, turn), np.append(wanted[:, axis],
                          wanted[0, axis]))  # fmt: skip
        assert np.mean(np.abs(found.force[rows, axis] - there)) < 6e-3 * largest


@pytest.mark.parametrize(("lead", "tilt", "mode", "stepover"), CUTS)
def test_power_is_the_force_on_the_edges_times_their_speed(lead, tilt, mode, stepover):
    # with no edge forces: Ktc times the removal rate, of the section between two circles
    z = DEPTH * (np.arange(100000) + 0.5) / 100000
    width = 2.0 * np.sqrt(z * (2.0 * RADIUS - z))
    section = DEPTH * np.mean(width if stepover is None else np.minimum(width, stepover))
    case = case_of(lead, tilt, mode, stepover, simulation={"revolutions": 4})
    sharp = case.patch({f"material.{key}": 0.0 for key in ("Kte", "Kre", "Kae")})
    rate = section * FEED * TEETH * 8000.0 / 60.0
    assert chatter.simulate(sharp).mean_power == pytest.approx(KTC * rate, rel=3e-3)


MODES = [
    {"frequency": "900 Hz", "damping": 0.02, "stiffness": "8 N/um", "direction": [1, 0, 0]},
    {"frequency": "950 Hz", "damping": 0.02, "stiffness": "8 N/um", "direction": [0, 1, 0]},
    {"frequency": "2000 Hz", "damping": 0.02, "stiffness": "20 N/um", "direction": [0, 0, 1]},
]


@pytest.mark.parametrize(("lead", "tilt", "mode", "stepover"), CUTS)
def test_averaged_stiffness_of_the_chip(lead, tilt, mode, stepover):
    model = milling_model(case_of(lead, tilt, mode, stepover, structure={"mode": MODES}))
    found = model.basis @ (model.averaged_directional * DEPTH) @ model.basis.T
    wanted = Edge(lead, tilt, mode, stepover).averaged()
    assert found == pytest.approx(wanted, abs=3e-3 * np.abs(wanted).max())


@pytest.mark.parametrize(("lead", "tilt"), [(15, 0), (6, 20)])
def test_three_methods_agree_on_the_multiplier(lead, tilt):
    case = case_of(lead, tilt, "down", 0.6e-3, structure={"mode": MODES})
    sharp = case.patch({f"material.{key}": 0.0 for key in ("Kte", "Kre", "Kae")})
    model = milling_model(sharp)
    speed, depth = np.full(2, 8000.0 * math.pi / 30.0), np.array([0.2e-3, 0.35e-3])
    found = [
        METHODS[name].radius(model, speed, depth, None, no_progress)
        for name in ("collocation", "matrix-free", "time-domain")
    ]
    assert found[1] == pytest.approx(found[0], rel=1e-3)
    assert found[2] == pytest.approx(found[0], rel=3e-3)


BULL_NOSE = {"tool.kind": "bull nose", "tool.corner_radius": "1 mm", "cut.stepover": "2 mm"}
END_MILL = {"tool.kind": "end mill", "cut.stepover": "2 mm"}
SIZE_EFFECT = {"material.law": "exponential", "material.h0": "0.1 mm", "material.exponent": 0.7}


@pytest.mark.parametrize("changed", [BULL_NOSE, END_MILL, SIZE_EFFECT])
def test_other_tools_and_laws_by_two_methods(changed):
    case = case_of(3, 2, "up", 0.6e-3, structure={"mode": MODES})
    sharp = case.patch({f"material.{key}": 0.0 for key in ("Kte", "Kre", "Kae")})
    model = milling_model(sharp.patch(changed))
    speed, depth = np.array([8000.0 * math.pi / 30.0]), np.array([0.15e-3])
    found = [
        METHODS[name].radius(model, speed, depth, None, no_progress)
        for name in ("collocation", "time-domain")
    ]
    # a size effect is not quite linear at the vibration that is followed
    assert found[1] == pytest.approx(found[0], rel=6e-3)


@pytest.mark.parametrize(
    ("tool", "lead", "tilt", "radius"),
    [
        ({"kind": "ball"}, 12.0, 0.0, 5e-3),
        ({"kind": "ball"}, 12.0, -17.0, 5e-3),
        ({"kind": "bull nose", "corner_radius": "2 mm"}, 6.0, 0.0, 2e-3),
        # about the axis, in the direction of the feed: (R - r + r sin t)/sin t
        (
            {"kind": "bull nose", "corner_radius": "2 mm"}, 0.0, 6.0,
            2e-3 + 3e-3 / math.sin(math.radians(6.0)),
        ),
    ],
)  # fmt: skip
def test_floor_has_the_feed_marks_of_its_lowest_point(tool, lead, tilt, radius):
    case = case_of(lead, tilt, "up", 1e-3, simulation={"revolutions": 40})
    case = case.patch({f"tool.{key}": value for key, value in tool.items()})
    floor = chatter.simulate(case.patch({"cut.feed_per_tooth": "0.2 mm"})).finish.floor
    assert np.ptp(floor.profile.height) == pytest.approx(0.2e-3**2 / (8.0 * radius), rel=0.05)


def test_limit_of_a_slot_by_collocation_and_simulation():
    case = case_of(15, 0, structure={"mode": MODES})
    sharp = case.patch({f"material.{key}": 0.0 for key in ("Kte", "Kre", "Kae")})
    found = chatter.check(sharp, method="collocation")
    radius = METHODS["time-domain"].radius(
        milling_model(sharp), np.full(2, 8000.0 * math.pi / 30.0),
        found.critical_depth * np.array([0.97, 1.03]), None, no_progress,
    )  # fmt: skip
    assert radius[0] < 1.0 < radius[1]
