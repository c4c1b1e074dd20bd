"""Engagement as a shop states it: stepover, place of the workpiece, entry and exit angles."""

import math

import numpy as np
import pytest

import chatter
from chatter.description.case import loads
from chatter.description.errors import InputError
from cutting.engagement.immersion import engagement
from cutting.engagement.uncut_band import SLOT

TEXT = """
[tool]
kind = "end mill"
teeth = 4
diameter = "80 mm"
[material]
Ktc = "1800 MPa"
Krc = "600 MPa"
Kac = "200 MPa"
[cut]
{engagement}
spindle_speed = "1000 rpm"
feed_per_tooth = "0.1 mm"
axial_depth = "1 mm"
[[structure.mode]]
frequency = "200 Hz"
damping = 0.03
stiffness = "4000 N/um"
direction = [1, 0, 0]
[[structure.mode]]
frequency = "200 Hz"
damping = 0.03
stiffness = "4000 N/um"
direction = [0, 1, 0]
[simulation]
revolutions = 6
"""

SHARE = """
[tool]
teeth = 4
diameter = "12 mm"
[cut]
mode = "down"
spindle_speed = "3000 rpm"
feed_per_tooth = "0.05 mm"
axial_depth = "2 mm"
{key} = "{width}"
"""


def case_of(engagement, **replaced):
    text = TEXT.format(engagement=engagement)
    for old, new in replaced.items():
        text = text.replace(old, new)
    return loads(text)


def mean_forces(case):
    """Mean force of the straight teeth over a turn (Altintas 2012, eqs 2.24 to 2.27), N."""
    entry, leave = (math.radians(angle) for angle in ANGLES)
    teeth, depth, feed = 4, case.cut.axial_depth, case.cut.feed_per_tooth
    kt, kr, ka = 1800e6, 600e6, 200e6
    angle = np.array([entry, leave])
    double, straight = np.cos(2.0 * angle), 2.0 * angle - np.sin(2.0 * angle)
    share = teeth * depth * feed / (8.0 * math.pi)
    x = share * np.diff(kt * double - kr * straight)[0]
    y = share * np.diff(kt * straight + kr * double)[0]
    z = -teeth * depth * feed / (2.0 * math.pi) * ka * np.diff(np.cos(angle))[0]
    return np.array([x, y, z])


#: 60 mm of work under 80 mm, the tool 5 mm off its middle
ANGLES = [math.degrees(math.acos(y / 40.0)) for y in (25.0, -35.0)]
STATEMENTS = [
    'workpiece_width = "60 mm"\ntool_offset = "5 mm"',
    f'mode = "face"\nentry_angle = "{ANGLES[0]} deg"\nexit_angle = "{ANGLES[1]} deg"',
]


@pytest.mark.parametrize("stated", STATEMENTS)
@pytest.mark.parametrize("chip", ["delay", "dexel"])
def test_mean_forces_of_face_milling(stated, chip):
    case = case_of(stated, **{"revolutions = 6": f'revolutions = 6\nchip = "{chip}"'})
    result = chatter.simulate(case)
    assert result.force[result.settled].mean(axis=0) == pytest.approx(
        mean_forces(case), rel=0.01, abs=1.0
    )
    # the work ends within the reach of the tool on both sides: there is no wall
    assert result.case.uncut_band.walls(40e-3) == ()


def test_methods_agree_on_face_milling():
    """A cut stated by angles: semi-discretization, collocation and the multi-frequency solution."""
    case = case_of(STATEMENTS[0], **{"4000 N/um": "40 N/um"})
    depths = [
        chatter.check(case, method=method).critical_depth
        for method in ("collocation", "semi-discretization", "multi-frequency")
    ]
    assert depths == pytest.approx([depths[0]] * 3, rel=0.01)


@pytest.mark.parametrize("feed", [0.02, 0.1])
@pytest.mark.parametrize("mode", ["up", "down"])
def test_a_ball_beside_its_pass_before(mode, feed):
    """The delayed chip against dexels that the pass before has cut out of the stock.

    Near the tip the feed is no small part of the radius: they differ by as much, and the less the
    smaller the feed.
    """
    means = [
        chatter.simulate(
            case_of(
                f'mode = "{mode}"\nstepover = "0.4 mm"',
                **{
                    '"end mill"': '"ball"',
                    '"80 mm"': '"10 mm"',
                    '"1 mm"': '"0.5 mm"',
                    '"0.1 mm"': f'"{feed} mm"',
                    "revolutions = 6": f'revolutions = 6\nchip = "{chip}"',
                },
            )
        )
        for chip in ("delay", "dexel")
    ]
    delayed, carved = (one.force[one.settled].mean(axis=0) for one in means)
    assert carved == pytest.approx(delayed, abs=1.5 * feed * np.abs(delayed).max())


def test_a_stepover_of_an_end_mill_is_its_radial_depth():
    case = case_of('mode = "down"\nstepover = "20 mm"')
    walled = case.patch({"cut.radial_depth": "20 mm"})
    assert walled.cut.stepover is None
    assert walled.width_of_cut == pytest.approx(case.width_of_cut) == pytest.approx(20e-3)
    limits = [chatter.check(one).critical_depth for one in (case, walled)]
    assert limits[0] == pytest.approx(limits[1], rel=1e-6)


def test_one_statement_takes_the_other_away():
    case = case_of(STATEMENTS[0])
    beside = case.patch({"cut.mode": "down", "cut.stepover": "10 mm"})
    assert (beside.cut.workpiece_width, beside.cut.tool_offset) == (None, None)
    slot = case.patch({"cut.mode": "slot"})
    assert slot.uncut_band == SLOT
    assert slot.width_of_cut == pytest.approx(80e-3)
    angled = beside.patch(
        {"cut.mode": "face", "cut.entry_angle": "20 deg", "cut.exit_angle": "90 deg"}
    )
    assert angled.cut.stepover is None


@pytest.mark.parametrize(
    ("engagement", "told"),
    [
        ('mode = "face"', "cut.workpiece_width: is missing; mode = \"face\" needs workpiece_width"),
        ('mode = "up"', 'cut.radial_depth: is missing; mode = "up" needs a length'),
        ('mode = "up"\nstepover = "90 mm"', "cut.stepover: 90 mm is more than the diameter"),
        ('mode = "slot"\nstepover = "9 mm"', 'cut.stepover: does not belong to mode = "slot"'),
        ('mode = "down"\nworkpiece_width = "9 mm"', 'cut.workpiece_width: does not belong to mode'),
        (
            'mode = "down"\nradial_depth = "9 mm"\nstepover = "9 mm"',
            "cut.stepover: cut.radial_depth is given as well",
        ),
        ('tool_offset = "5 mm"', "cut.workpiece_width: is missing; tool_offset counts"),
        ('entry_angle = "30 deg"', "cut.exit_angle: is missing; entry_angle needs it"),
        ('exit_angle = "30 deg"', "cut.entry_angle: is missing; exit_angle needs it"),
        (
            'entry_angle = "90 deg"\nexit_angle = "30 deg"',
            "cut.exit_angle: 30 deg is not above entry_angle, 90 deg",
        ),
        (
            'workpiece_width = "60 mm"\ntool_offset = "70 mm"',
            "cut.tool_offset: 70 mm from the middle of a workpiece 60 mm wide the tool of 80 mm",
        ),
        ('entry_angle = "30 deg"\nexit_angle = "200 deg"', "cut.exit_angle: "),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_told(engagement, told):
    with pytest.raises(InputError) as refused:
        case_of(engagement)
    assert told in str(refused.value)


def test_a_radial_depth_that_a_ball_does_not_reach_names_the_stepover():
    case = case_of('mode = "up"\nradial_depth = "0.4 mm"', **{'"end mill"': '"ball"'})
    for command in (chatter.check, chatter.simulate):
        with pytest.raises(InputError, match="stepover"):
            command(case)


@pytest.mark.parametrize("key", ["radial_depth", "stepover"])
def test_a_width_in_percent_of_the_diameter(key):
    case = loads(SHARE.format(key=key, width="8 %"))
    assert case.get(f"cut.{key}") == pytest.approx(0.96e-3)
    # of the tool that the case has, whichever way it changes
    assert case.patch({"tool.diameter": "20 mm"}).get(f"cut.{key}") == pytest.approx(1.6e-3)
    assert case.patch({f"cut.{key}": "25 %"}).get(f"cut.{key}") == pytest.approx(3e-3)


@pytest.mark.parametrize(
    ("width", "words"),
    [
        ("120 %", r"14\.4 mm is more than the diameter of the tool, 12 mm"),
        ("-8 %", "a length is required"),
        ("0 %", "a length is required"),
        ("x %", "is not a quantity"),
        ("8 +- 1 %", "a length is required"),
    ],
)
def test_a_wrong_percentage(width, words):
    with pytest.raises(InputError, match=words):
        loads(SHARE.format(key="radial_depth", width=width))


def test_an_offset_to_either_side_mirrors_the_engagement():
    stated = 'workpiece_width = "60 mm"\ntool_offset = "{} mm"'
    towards = loads(TEXT.format(engagement=stated.format(12))).uncut_band
    away = loads(TEXT.format(engagement=stated.format(-12))).uncut_band
    entry, leave = engagement(towards, 40e-3)
    # the tool 12 mm towards +y: the work from -42 mm, beyond the tool, to 18 mm
    assert (entry, leave) == pytest.approx((math.acos(18 / 40), math.pi))
    assert engagement(away, 40e-3) == pytest.approx((0.0, math.pi - math.acos(18 / 40)))
