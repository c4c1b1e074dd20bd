"""Ordinary jobs with other numbers than the documents have, against hand calculations made here."""

import math

import numpy as np
import pytest

import chatter
from chatter.description.case import loads

RIGID = """\
title = "Other numbers"
[tool]
kind = "end mill"
teeth = 3
diameter = "10 mm"
helix = "35 deg"
[material]
Ktc = "2100 MPa"
Krc = "900 MPa"
Kte = "18 N/mm"
Kre = "30 N/mm"
[cut]
mode = "up"
cutting_speed = "90 m/min"
feed_per_tooth = "0.05 mm"
axial_depth = "2 mm"
radial_depth = "3 mm"
"""
MODES = """
[structure]
mode = [
    { frequency = "1200 Hz", damping = 0.02, stiffness = "20 N/um", direction = "x" },
    { frequency = "1300 Hz", damping = 0.025, stiffness = "18 N/um", direction = "y" },
]
"""
#: of the file: N/mm^2, N/mm, mm, teeth, mm/s
KTC, KRC, KTE, KRE, FEED, TEETH, SPEED = 2100.0, 900.0, 18.0, 30.0, 0.05, 3, 1500.0
SLICES = (np.arange(200_000) + 0.5) / 200_000


def job(text=RIGID, **values):
    """The cut with values set; dots of their paths as double underscores."""
    return loads(text).patch({path.replace("__", "."): value for path, value in values.items()})


def rows(**values):
    """Table of `chatter check`."""
    return dict(chatter.check(job(RIGID + MODES, **values)).rows())


def settled(**values):
    """Summary of the rigid cut in time."""
    return chatter.simulate(job(**values)).summary()


def mean_power(**values):
    return settled(**values)["power"]["mean_W"]


def by_hand(area, swept, diameter, teeth=TEETH, feed=FEED):
    """Mean power, W: of the chip, of an area across the feed, mm^2, and of the edge.

    `swept` is the integral along the edge of radius times arc, mm^2.
    """
    turns = SPEED / (math.pi * diameter)
    chip = KTC * area * feed * teeth * turns
    return (chip + teeth * turns * KTE * swept) * 1e-3


def arc(width, radius):
    return np.arccos(1.0 - width / radius)


# feeds and speeds


@pytest.mark.parametrize(
    ("values", "speed", "feed_rate"),
    [
        ({}, "90 m/min", 3 * 0.05 * 90e3 / (math.pi * 10.0)),
        (
            {"tool__teeth": 5, "cut__cutting_speed": "2.5 m/s"},
            "150 m/min",
            5 * 0.05 * 150e3 / (math.pi * 10.0),
        ),
        (
            {"tool__diameter": "0.5 in", "cut__cutting_speed": "400 ft/min"},
            "121.9 m/min",
            3 * 0.05 * 400.0 * 304.8 / (math.pi * 12.7),
        ),
    ],
)
def test_speeds_and_feeds(values, speed, feed_rate):
    found = rows(**values)
    assert found["cutting speed"] == speed
    assert float(found["feed rate"].removesuffix(" mm/min")) == pytest.approx(feed_rate, rel=5e-4)


@pytest.mark.parametrize(("rate", "teeth"), [(600.0, 3), (1250.0, 7)])
def test_a_feed_rate_is_a_feed_per_tooth(rate, teeth):
    case = job(cut__feed_rate=f"{rate} mm/min", tool__teeth=teeth)
    turns = 90e3 / (math.pi * 10.0)
    assert 1e3 * case.cut.feed_per_tooth == pytest.approx(rate / (teeth * turns), rel=1e-12)


# engagement


@pytest.mark.parametrize("offset", [0.0, 8.0, -6.0])
@pytest.mark.parametrize("width", [45.0, 21.0])
def test_angles_of_a_face_mill_over_a_workpiece(width, offset):
    face = {"tool__diameter": "63 mm", "cut__mode": "face", "cut__radial_depth": None}
    sides = {"cut__workpiece_width": f"{width} mm", "cut__tool_offset": f"{offset} mm"}
    found = rows(**face, **sides)
    ends = [math.degrees(math.acos((side - offset) / 31.5)) for side in (width / 2, -width / 2)]
    assert found["width of cut"] == f"{width:g} mm"
    assert found["tooth in the cut"] == f"{ends[0]:.4g} to {ends[1]:.4g} deg from +y"


@pytest.mark.parametrize(("width", "offset"), [(70.0, 20.0), (30.0, -25.0)])
def test_a_face_mill_that_overhangs_the_work(width, offset):
    face = {"tool__diameter": "63 mm", "cut__mode": "face", "cut__radial_depth": None}
    sides = {"cut__workpiece_width": f"{width} mm", "cut__tool_offset": f"{offset} mm"}
    found = rows(**face, **sides)
    high, low = min(width / 2 - offset, 31.5), max(-width / 2 - offset, -31.5)
    ends = [math.degrees(math.acos(side / 31.5)) for side in (high, low)]
    assert found["width of cut"] == f"{high - low:g} mm"
    assert found["tooth in the cut"] == f"{ends[0]:.4g} to {ends[1]:.4g} deg from +y"


@pytest.mark.parametrize(
    ("entry", "leave", "largest"), [(20, 75, 75), (40, 150, 90), (100, 140, 100)]
)
def test_width_and_chip_of_entry_and_exit_angles(entry, leave, largest):
    angles = {"cut__entry_angle": f"{entry} deg", "cut__exit_angle": f"{leave} deg"}
    found = rows(tool__diameter="50 mm", cut__mode="face", cut__radial_depth=None, **angles)
    width = 25.0 * (math.cos(math.radians(entry)) - math.cos(math.radians(leave)))
    assert found["width of cut"] == f"{width:.4g} mm"
    # the chip is thickest where the arc comes nearest to the feed axis
    chip = FEED * math.sin(math.radians(largest))
    assert found["thickest chip"] == f"{chip:.3g} mm"


@pytest.mark.parametrize(("share", "mode"), [(8.0, "up"), (35.0, "down"), (62.0, "up")])
def test_radial_chip_thinning(share, mode):
    found = rows(cut__radial_depth=f"{share} %", cut__mode=mode)
    angle = math.degrees(math.acos(1.0 - share / 50.0))
    ends = (0.0, angle) if mode == "up" else (180.0 - angle, 180.0)
    assert found["tooth in the cut"] == f"{ends[0]:.4g} to {ends[1]:.4g} deg from +y"
    # h = 2 f_z sqrt(a_e/D (1 - a_e/D)) below half immersion, f_z above it
    thin = 2.0 * math.sqrt(share / 100.0 * (1.0 - share / 100.0)) if share < 50.0 else 1.0
    assert found["thickest chip"] == f"{FEED * thin:.3g} mm"


@pytest.mark.parametrize(("diameter", "depth", "step"), [(8.0, 0.25, 0.3), (6.0, 1.2, 0.5)])
def test_effective_diameter_and_arc_of_a_ball(diameter, depth, step):
    found = rows(
        tool__kind="ball", tool__diameter=f"{diameter} mm", cut__radial_depth=None,
        cut__axial_depth=f"{depth} mm", cut__stepover=f"{step} mm",
    )  # fmt: skip
    effective = 2.0 * math.sqrt(depth * (diameter - depth))
    there = 90.0 * effective / diameter
    assert found["effective diameter"] == f"{effective:.4g} mm, {there:.4g} m/min there"
    angle = math.degrees(math.acos(1.0 - 2.0 * step / effective))
    assert found["tooth in the cut"] == f"0 to {angle:.4g} deg from +y"


@pytest.mark.parametrize(("lead", "tilt"), [(10, 0), (0, 20), (12, 15), (30, -10), (75, 0)])
def test_effective_diameter_of_a_ball_that_leans(lead, tilt):
    found = rows(
        tool__kind="ball", tool__diameter="6 mm", cut__radial_depth=None, cut__axial_depth="0.2 mm",
        cut__stepover="0.25 mm", cut__lead=f"{lead} deg", cut__tilt=f"{tilt} deg",
    )  # fmt: skip
    cosines = math.cos(math.radians(lead)) * math.cos(math.radians(tilt))
    reached = math.acos(cosines) + math.acos(1.0 - 2.0 * 0.2 / 6.0)
    effective = 6.0 * math.sin(min(reached, 0.5 * math.pi))
    assert found["effective diameter"].startswith(f"{effective:.4g} mm, ")


def test_effective_diameter_of_a_ball_that_leans_away():
    """2.441 mm: angles about the axis were looked at in steps of half a degree."""
    found = rows(
        tool__kind="ball", tool__diameter="6 mm", cut__radial_depth=None, cut__axial_depth="0.2 mm",
        cut__stepover="0.25 mm", cut__lead="-12 deg",
    )  # fmt: skip
    # it cuts ahead of the plane across the feed, where cos a = cos(lead) (1 - 2 a_p/D)
    angle = math.acos(math.cos(math.radians(12.0)) * (1.0 - 2.0 * 0.2 / 6.0))
    assert found["effective diameter"].startswith(f"{6.0 * math.sin(angle):.4g} mm, ")
    # it was "-90 to 270 deg"
    assert found["tooth in the cut"] == "all around, 360 deg, about the inclined axis"


def test_an_angle_of_zero_is_written_as_zero():
    """4.657e-10 to 21.69 deg."""
    found = rows(
        tool__kind="ball", tool__diameter="6 mm", cut__radial_depth=None, cut__axial_depth="0.2 mm",
        cut__stepover="0.25 mm", cut__tilt="20 deg",
    )  # fmt: skip
    assert found["tooth in the cut"].startswith("0 to ")


def test_effective_diameter_of_a_bull_nose():
    found = rows(
        tool__kind="bull nose", tool__diameter="12 mm", tool__corner_radius="1.5 mm",
        cut__axial_depth="0.8 mm", cut__stepover="5 mm", cut__radial_depth=None,
    )  # fmt: skip
    wide = 2.0 * (4.5 + math.sqrt(1.5**2 - 0.7**2))
    assert found["effective diameter"].startswith(f"{wide:.4g} mm, ")


# power


@pytest.mark.parametrize(
    ("mode", "depth", "width"), [("up", 2.0, 3.0), ("down", 1.5, 0.8), ("slot", 0.7, 10.0)]
)
def test_power_of_an_end_mill(mode, depth, width):
    engaged = {"cut__mode": mode, "cut__radial_depth": None if mode == "slot" else f"{width} mm"}
    found = mean_power(cut__axial_depth=f"{depth} mm", **engaged)
    swept = depth * 5.0 * float(arc(width, 5.0))
    assert found == pytest.approx(by_hand(depth * width, swept, 10.0), rel=5e-4)


@pytest.mark.parametrize(
    ("wear", "pressure", "rubbing"),
    [("0.2 mm", "300 MPa", 0.3 * 300.0 * 0.2), ("0.15 mm", None, 0.3 * 210.0 * 0.15)],
)
def test_power_of_a_worn_tool(wear, pressure, rubbing):
    worn = {"tool__flank_wear": wear}
    if pressure is not None:
        worn["wear__flank_pressure"] = pressure
    # N/mm more on the edge, 0.3 of what presses on the land; without a pressure a tenth of Ktc
    swept = 2.0 * 5.0 * float(arc(3.0, 5.0))
    more = TEETH * SPEED / (math.pi * 10.0) * rubbing * swept * 1e-3
    assert mean_power(**worn) == pytest.approx(by_hand(6.0, swept, 10.0) + more, rel=5e-4)


def test_power_of_a_taper():
    slope = math.tan(math.radians(5.0))
    z = 3.0 * SLICES
    width, radius = 2.0 + z * slope, 3.0 + z * slope
    swept = 3.0 / math.cos(math.radians(5.0)) * float(np.mean(radius * arc(width, radius)))
    found = mean_power(
        tool__kind="taper", tool__diameter="6 mm", tool__taper_angle="5 deg",
        cut__radial_depth="2 mm", cut__axial_depth="3 mm",
    )  # fmt: skip
    assert found == pytest.approx(by_hand(3.0 * float(width.mean()), swept, 6.0), rel=5e-4)


def test_power_of_a_face_mill_with_an_edge_at_60_degrees():
    out = 1.5 * SLICES / math.tan(math.radians(60.0))
    swept = float(np.mean((20.0 + out) * arc(10.0 + out, 20.0 + out)))
    swept *= 1.5 / math.sin(math.radians(60.0))
    found = mean_power(
        tool__kind="inserted", tool__diameter="40 mm", tool__cutting_edge_angle="60 deg",
        tool__helix="0 deg", cut__radial_depth="10 mm", cut__axial_depth="1.5 mm",
    )  # fmt: skip
    wanted = by_hand(1.5 * float(np.mean(10.0 + out)), swept, 40.0)
    assert found == pytest.approx(wanted, rel=5e-4)


def test_power_of_a_bull_nose():
    angle = math.acos(1.0 - 0.8 / 1.5)
    radius = 4.5 + 1.5 * np.sin(angle * SLICES)
    swept = 1.5 * angle * float(np.mean(radius * arc(5.0, radius)))
    found = mean_power(
        tool__kind="bull nose", tool__diameter="12 mm", tool__corner_radius="1.5 mm",
        cut__axial_depth="0.8 mm", cut__stepover="5 mm", cut__radial_depth=None,
    )  # fmt: skip
    assert found == pytest.approx(by_hand(0.8 * 5.0, swept, 12.0), rel=5e-4)


def test_power_and_scallops_of_a_finishing_ball():
    z = 0.25 * SLICES
    area = 0.25 * float(np.mean(np.minimum(0.3, 2.0 * np.sqrt(8.0 * z - z**2))))
    angle = math.acos(1.0 - 0.25 / 4.0)
    radius = 4.0 * np.sin(angle * SLICES)
    beside = np.where(2.0 * radius <= 0.3, np.pi, arc(np.minimum(0.3, 2.0 * radius), radius))
    swept = 4.0 * angle * float(np.mean(radius * beside))
    ball = {"tool__kind": "ball", "tool__diameter": "8 mm", "cut__axial_depth": "0.25 mm"}
    found = settled(**ball, cut__stepover="0.3 mm", cut__radial_depth=None)
    assert found["power"]["mean_W"] == pytest.approx(by_hand(area, swept, 8.0), rel=1e-3)
    scallops = 1e3 * (4.0 - math.sqrt(16.0 - 0.15**2))
    assert found["scallop_height_um"] == pytest.approx(scallops, rel=1e-6)


def test_power_by_kienzle():
    """Inconel 718 by its name: 3300 MPa, exponent 0.76 at 1 mm."""
    text = RIGID.replace('Ktc = "2100 MPa"', 'name = "Inconel 718"')
    for key in ("Krc", "Kte", "Kre"):
        text = "\n".join(line for line in text.splitlines() if not line.startswith(key))
    case = job(text, cut__cutting_speed="30 m/min")
    assert case.material.values["exponent"] == 0.76
    angle = math.acos(1.0 - 2.0 * 3.0 / 10.0)
    sines = float(np.mean(np.sin(angle * SLICES) ** 0.76)) * angle
    force = 3300.0 * FEED**0.76 * 2.0 * TEETH / (2.0 * math.pi) * sines
    assert chatter.simulate(case).summary()["power"]["mean_W"] == pytest.approx(
        0.5 * force, rel=5e-4
    )


# forces


def test_mean_forces_of_a_slot():
    found = settled(
        cut__mode="slot", cut__axial_depth="1 mm", material__Kac="400 MPa", material__Kae="5 N/mm"
    )["mean_force_N"]
    # Altintas 2012, 2.52
    assert found["Fx"] == pytest.approx(-3.0 * (FEED * KRC / 4.0 + KRE / math.pi), rel=1e-4)
    assert found["Fy"] == pytest.approx(3.0 * (FEED * KTC / 4.0 + KTE / math.pi), rel=1e-4)
    assert found["Fz"] == pytest.approx(3.0 * (FEED * 400.0 / math.pi + 5.0 / 2.0), rel=1e-4)


@pytest.mark.parametrize("mode", ["up", "down"])
def test_mean_forces_of_a_pass_beside_a_wall(mode):
    turn = math.acos(1.0 - 2.0 * 3.0 / 10.0)
    ends = (0.0, turn) if mode == "up" else (math.pi - turn, math.pi)
    phi = ends[0] + (ends[1] - ends[0]) * SLICES
    tangential = KTC * FEED * np.sin(phi) + KTE
    radial = KRC * FEED * np.sin(phi) + KRE
    share = TEETH * 2.0 * turn / (2.0 * math.pi)
    along = share * np.mean(-tangential * np.cos(phi) - radial * np.sin(phi))
    across = share * np.mean(tangential * np.sin(phi) - radial * np.cos(phi))
    found = settled(cut__mode=mode)["mean_force_N"]
    assert (found["Fx"], found["Fy"]) == pytest.approx((along, across), rel=1e-3)


def test_peak_of_a_tool_out_of_true():
    found = settled(
        tool__teeth=2, tool__helix="0 deg", cut__mode="down", cut__radial_depth="5 mm",
        tool__runout__offset="5 um",
    )  # fmt: skip
    # two teeth are 2 e apart; one of them enters with f_z + 2 e
    assert found["power"]["peak_W"] == pytest.approx((KTC * 0.06 + KTE) * 2.0 * 1.5, rel=1e-3)


def test_a_depth_at_which_the_helix_cuts_evenly():
    depth = 2.0 * math.pi * 5.0 / (3.0 * math.tan(math.radians(35.0)))
    power = settled(cut__axial_depth=f"{depth:.9f} mm")["power"]
    swept = depth * 5.0 * float(arc(3.0, 5.0))
    assert power["peak_W"] == pytest.approx(power["mean_W"], rel=1e-3)
    assert power["mean_W"] == pytest.approx(by_hand(3.0 * depth, swept, 10.0), rel=5e-4)


# surfaces


def test_floor_of_a_bull_nose_and_wall_of_an_end_mill():
    floor = settled(
        tool__kind="bull nose", tool__corner_radius="0.8 mm", cut__mode="slot",
        cut__radial_depth=None,
    )["roughness"]["floor"]  # fmt: skip
    assert floor["Rz_um"] == pytest.approx(1e3 * FEED**2 / (8.0 * 0.8), rel=2e-3)
    wall = settled()["roughness"]["wall"]
    # arcs with cusps of f_z^2/(4 D); the filter of ISO 21920 takes some at the ends
    cusp = 1e3 * FEED**2 / (4.0 * 10.0)
    assert wall["Ra_um"] == pytest.approx(cusp * 4.0 / (9.0 * math.sqrt(3.0)), rel=0.02)


# limits and tools


def test_the_lowest_limit_of_a_slot_by_hand():
    """Altintas and Budak 1995 with equal modes: eigenvalues pi (-Kr +- i)."""
    modes = {"frequency": "1250 Hz", "damping": 0.025, "stiffness": "18 N/um"}
    case = job(RIGID + MODES, cut__mode="slot", lobes__method="zero-order").patch(
        {f"structure.mode[*].{key}": value for key, value in modes.items()}
    )
    ratio = np.linspace(0.9, 1.3, 400_001)
    receptance = 1.0 / 18e6 / (1.0 - ratio**2 + 2j * 0.025 * ratio)
    limits = []
    for eigenvalue in (math.pi * (-KRC / KTC + 1j), math.pi * (-KRC / KTC - 1j)):
        value = -1.0 / (eigenvalue * receptance)
        depth = -2.0 * math.pi * value.real / (TEETH * KTC * 1e6)
        depth *= 1.0 + (value.imag / value.real) ** 2
        limits.append(float(depth[depth > 0.0].min()))
    # between the speeds of the diagram too, whatever the method
    assert chatter.lobes(case).lowest.critical_depth == pytest.approx(min(limits), rel=1e-6)


def test_half_the_stiffness_is_half_the_limit():
    soft = {"structure.mode[0].stiffness": "10 N/um", "structure.mode[1].stiffness": "9 N/um"}
    stiff = job(RIGID + MODES)
    depths = [chatter.check(case).critical_depth for case in (stiff, stiff.patch(soft))]
    assert depths[1] == pytest.approx(0.5 * depths[0], rel=5e-3)


@pytest.mark.parametrize(
    ("tool", "lengths"),
    [
        ({"stick_out": "35 mm"}, [(0.0, 35.0, 10.0)]),
        ({"stick_out": "60 mm", "flute_length": "15 mm", "shank_diameter": "12 mm"},
         [(0.0, 15.0, 10.0), (15.0, 60.0, 12.0)]),
    ],
)  # fmt: skip
def test_a_stub_and_a_long_tool_with_a_thick_shank(tool, lengths):
    stiff = {"structure.mode[*].stiffness": "900 N/um"}
    case = job(RIGID + MODES, **{f"tool__{key}": value for key, value in tool.items()})
    # the compliance of a cantilever is the integral of x^2/(E I) from the tip, 650 GPa
    compliance = sum(
        64.0 * (end**3 - begin**3) / (3.0 * math.pi * 650e3 * diameter**4)
        for begin, end, diameter in lengths
    )
    told = " ".join(chatter.check(case.patch(stiff)).notes)
    assert f"has at most {1e-3 / compliance:.3g} N/um" in told


def test_life_of_an_edge():
    """Taylor: v T^n = C."""
    life = {"cutting_speed": "120 m/min", "life": "15 min", "exponent": 0.25}
    assert rows(tool_life=life)["tool life"] == f"{15.0 * (120.0 / 90.0) ** 4:.3g} min"
