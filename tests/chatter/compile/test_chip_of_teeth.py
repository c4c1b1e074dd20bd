"""The thickest chip that teeth take which do not share the feed evenly, by hand."""

import pytest

import chatter
from chatter.compile.chip_of_teeth import thickest_chip_of_teeth
from chatter.compile.cutter import cutter_of
from chatter.description.case import loads

FEED = 0.1e-3
#: a slot reaches phi = 90 deg, where the chip is that of the feed
CASE = """
[tool]
teeth = 2
diameter = "10 mm"
[material]
Ktc = "800 MPa"
[cut]
mode = "slot"
spindle_speed = "6000 rpm"
feed_per_tooth = "0.1 mm"
axial_depth = "4 mm"
[[structure.mode]]
frequency = "900 Hz"
damping = 0.03
stiffness = "100 N/um"
direction = "y"
"""
WAVE = {"depth": "1 mm", "wavelength": "2 mm"}


def tool(**values):
    return loads(CASE).patch({f"tool.{key}": value for key, value in values.items()})


@pytest.mark.parametrize(
    ("values", "thickest"),
    [
        ({}, FEED),
        # what the feed brings in 200 deg
        ({"pitch": ["160 deg", "200 deg"]}, 2.0 * FEED * 200.0 / 360.0),
        # the tooth that stands out takes the difference too, and no more than a revolution's feed
        ({"radial_error": ["20 um", "0 um"]}, FEED + 20e-6),
        ({"radial_error": ["150 um", "0 um"]}, 2.0 * FEED),
        # its runout is that of the other tooth with another sign
        ({"runout.offset": "10 um"}, FEED + 20e-6),
        # beside a valley of the other tooth a crest takes the feed of a revolution
        ({"serration": WAVE}, 2.0 * FEED),
        # cos a - cos(a + 120 deg) over 2, which the tooth before lies deeper, is sin 60 deg at most
        (
            {"teeth": 3, "serration": {"depth": "0.1 mm", "wavelength": "2 mm"}},
            FEED + 0.8660254 * 0.1e-3,
        ),
    ],
)
def test_thickest_chip_of_uneven_teeth(values, thickest):
    case = tool(**values)
    assert thickest_chip_of_teeth(case, cutter_of(case)) == pytest.approx(thickest, rel=2e-3)


def test_helix_angles_that_differ_shift_the_pitch_along_the_edge():
    # 4 mm up the tool of 5 mm radius the second tooth trails by 0.8 (tan 30 deg - tan 20 deg) more
    case = tool(helix=["20 deg", "30 deg"])
    turned = 0.8 * (0.5773503 - 0.3639702) / 6.2831853
    found = thickest_chip_of_teeth(case, cutter_of(case))
    assert found == pytest.approx(2.0 * FEED * (0.5 + turned), rel=5e-3)


def test_check_shows_it():
    assert ["thickest chip", "0.2 mm"] in chatter.check(tool(serration=WAVE)).rows()


def test_check_says_of_which_period_the_spectral_radius_of_a_varied_speed_is():
    varied = loads(CASE).patch({"cut.speed_variation": {"amplitude": 0.1, "frequency": "5 Hz"}})
    told = dict(chatter.check(varied).rows())["spectral radius"]
    assert told.endswith("(below 1: stable; of a period of the speed)")
