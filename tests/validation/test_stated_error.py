"""The error that limits are stated with, for tools of every kind, against much finer elements."""

import math

import numpy as np
import pytest

from chatter.description.case import Case
from chatter.description.progress import no_progress
from chatter.stability.methods.collocation import multipliers as collocation
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.model import milling_model
from chatter.stability.registry import COLLOCATION

RPM = math.pi / 30.0


def mode(frequency, damping, stiffness, direction):
    return {"frequency": frequency, "damping": damping, "stiffness": stiffness,
            "direction": direction}  # fmt: skip


TWO_MODES = [mode(900.0, 0.02, 8e6, [1, 0, 0]), mode(980.0, 0.025, 1e7, [0, 1, 0])]
THREE_MODES = [
    mode(600.0, 0.03, 2e7, [1, 0, 0]),
    mode(650.0, 0.03, 1.6e7, [0, 1, 0]),
    mode(1500.0, 0.02, 3e7, [0.6, 0, 0.8]),
]
EXPONENTIAL = {"law": "exponential", "h0": "0.1 mm", "exponent": 0.7}


def tool(kind, teeth, diameter, **others):
    return {"kind": kind, "teeth": teeth, "diameter": diameter} | others


#: tool; modes; mode of cutting and immersion; speeds, rpm; deepest cut, m; further entries
CUTS = {
    "ball": (
        tool("ball", 2, 10e-3, helix="30 deg"), TWO_MODES, ("up", 0.3), (2000, 4000, 6000), 4e-3,
        {},
    ),
    "bull nose with runout and an exponential law": (
        tool("bull nose", 2, 12e-3, helix="35 deg", corner_radius=2e-3,
             runout={"offset": "15 um", "angle": "40 deg"}),
        TWO_MODES, ("down", 0.4), (2500, 5500, 9000), 8e-3, {"material": EXPONENTIAL},
    ),
    "variable pitch and helix": (
        tool("end mill", 4, 16e-3, helix=["38 deg", "41 deg", "37 deg", "40 deg"],
             pitch=["80 deg", "98 deg", "84 deg", "98 deg"]),
        THREE_MODES, ("down", 0.5), (3000, 6000), 12e-3, {},
    ),
    "inserts that stand out": (
        tool("inserted", 3, 32e-3, cutting_edge_angle="45 deg",
             radial_error=["0 um", "12 um", "-9 um"]),
        THREE_MODES, ("down", 0.7), (2200, 5000, 9000), 8e-3, {},
    ),
    "cone": (
        tool("taper", 3, 8e-3, helix="30 deg", taper_angle="5 deg"), TWO_MODES, ("up", 0.5),
        (2000, 5000, 9000, 16000), 10e-3, {},
    ),
    "serrated": (
        tool("end mill", 2, 20e-3, helix="30 deg",
             serration={"depth": "0.03 mm", "wavelength": "2 mm"}),
        TWO_MODES, ("down", 0.5), (3000, 4500), 4e-3, {},
    ),
    "serrated, down-milling with a size effect": (
        tool("end mill", 4, 20e-3, helix="30 deg",
             serration={"depth": "0.3 mm", "wavelength": "2.5 mm"}),
        [mode(650.0, 0.03, 5e6, [1, 0, 0]), mode(680.0, 0.03, 5e6, [0, 1, 0])],
        ("down", 0.3), (3400, 6160), 9e-3, {"material": EXPONENTIAL},
    ),
    "lag of more than a pitch": (
        tool("end mill", 3, 6e-3, helix="55 deg"), TWO_MODES, ("up", 0.2),
        (3000, 7000, 12000, 19000), 15e-3, {},
    ),
    "a hundredth of immersion": (
        tool("end mill", 3, 20e-3), TWO_MODES, ("down", 0.01), (2000, 15000, 24000), 60e-3, {},
    ),
    "half a hundredth, helical": (
        tool("end mill", 4, 20e-3, helix="45 deg"), TWO_MODES, ("up", 0.005), (2000, 6000, 9000),
        60e-3, {},
    ),
    "straight edge with runout and an exponential law": (
        tool("end mill", 3, 12e-3, runout={"offset": "20 um", "angle": "40 deg"}),
        TWO_MODES, ("down", 0.3), (3000, 7000), 8e-3, {"material": EXPONENTIAL},
    ),
    "varying speed": (
        tool("end mill", 2, 16e-3, helix="20 deg"), TWO_MODES, ("up", 0.4), (3000, 5200, 8100),
        12e-3,
        {"cut": {"speed_variation": {"amplitude": 0.15, "frequency": "20 Hz",
                                     "shape": "triangle"}}},
    ),
    "process damping": (
        tool("end mill", 4, 12e-3, helix="30 deg"), TWO_MODES, ("up", 0.5),
        (700, 1500, 4000, 9000), 12e-3,
        {"process_damping": {"coefficient": 2e4, "friction": 0.3}},
    ),
    "upright inserts on a cone, at low immersion": (
        tool("inserted", 2, 20e-3, cutting_edge_angle="48.06 deg"),
        [mode(1164.254, 0.02, 2.899261e6, [1, 0, 0]), mode(1407.984, 0.02, 3.189187e6, [0, 1, 0])],
        ("up", 0.0318331), (12578.0,), 4e-3, {},
    ),
    "upright inserts with a corner": (
        tool("inserted", 2, 12e-3, cutting_edge_angle="58.7 deg", corner_radius=0.96e-3),
        [mode(867.2976, 0.02, 5.252982e6, [1, 0, 0]), mode(1217.688, 0.02, 5.778280e6, [0, 1, 0])],
        ("up", 0.0770304), (4823.6,), 4e-3, {"material": EXPONENTIAL},
    ),
}  # fmt: skip


def case_of(name, tolerance):
    cutter, modes, (kind, immersion), speeds, _, others = CUTS[name]
    cut = {
        "mode": kind, "spindle_speed": f"{speeds[-1]} rpm", "feed_per_tooth": 8e-5,
        "axial_depth": 1e-3, "radial_depth": immersion * cutter["diameter"],
    }  # fmt: skip
    material = {"Ktc": "800 MPa", "Krc": "300 MPa", "Kac": "150 MPa"}
    document = {"tool": cutter, "structure": {"mode": modes}, "lobes": {"tolerance": tolerance}}
    document |= others
    document["cut"] = cut | others.get("cut", {})
    document["material"] = material | others.get("material", {})
    return Case.from_dict(document)


def limits(name, tolerance):
    speeds, deepest = np.array(CUTS[name][3]) * RPM, CUTS[name][4]
    depths = np.linspace(0.0, deepest, 31)[1:]
    model = milling_model(case_of(name, tolerance))
    return COLLOCATION.limits(model, speeds, depths, None, no_progress)


@pytest.mark.parametrize("name", CUTS)
def test_limits_are_as_good_as_stated(name):
    found = {tolerance: limits(name, tolerance) for tolerance in (1e-3, 1e-4)}
    model, deepest = milling_model(case_of(name, 1e-4)), CUTS[name][4]
    fine = element_cut(model, deepest, 12, 0.3)
    limited = np.flatnonzero(np.isfinite(found[1e-4].critical_depth))
    assert limited.size
    for i in limited:
        at = found[1e-4].critical_depth[i]
        # the net of the first pass has told where the limit is
        around = np.array([0.99, 1.01]) * at
        speed = found[1e-4].spindle_speed[[i]]
        exact = collocation.limit_curve(fine, speed, around, tolerance=1e-7).critical_depth[0]
        for tolerance, curve in found.items():
            off = abs(curve.critical_depth[i] / exact - 1.0)
            assert curve.error <= tolerance
            assert off <= tolerance
            assert off <= max(curve.error, 1e-4)
