"""Tapered ball end mills and flanks that plough, on an inclined axis: sections, mirrors, limits."""

import math

import numpy as np
import pytest

import chatter
from chatter.description.progress import no_progress
from chatter.simulation.perturbation.multiplier import simulated_multiplier
from chatter.stability.model import milling_model
from chatter.stability.registry import METHODS
from tests.validation.test_inclined_axis import KTC, MODES, case_of

CORNER, HALF, DEPTH, STEP, FEED = 2e-3, math.radians(8.0), 1.2e-3, 0.7e-3, 0.05e-3
TAPERED = {
    "tool.kind": "taper", "tool.taper_angle": HALF, "tool.diameter": 2.0 * CORNER,
    "tool.corner_radius": CORNER, "cut.axial_depth": DEPTH, "cut.feed_per_tooth": FEED,
}  # fmt: skip
SHARP = {f"material.{key}": 0.0 for key in ("Kte", "Kre", "Kae")}


def tapered(lead, tilt, mode="up", **further):
    case = case_of(lead, tilt, mode, STEP, **further)
    return case.patch({**TAPERED, **SHARP})


def section(tilt):
    """Area by hand between the outlines of two passes of a tapered ball that is tilted, m^2."""
    z = DEPTH * (np.arange(100000) + 0.5) / 100000

    def reach(leaning):
        rise = 0.5 * math.pi - leaning - HALF
        tangent = CORNER * (1.0 - math.cos(rise))
        on_ball = np.sqrt(np.maximum(CORNER**2 - (CORNER - z) ** 2, 0.0))
        on_flank = CORNER * math.sin(rise) + (z - tangent) / math.tan(rise)
        return np.where(z < tangent, on_ball, on_flank)

    return DEPTH * np.mean(np.minimum(reach(tilt) + reach(-tilt), STEP))


@pytest.mark.parametrize("tilt", [25.0, 65.0])
def test_power_of_a_tapered_ball_is_its_removal_rate_times_ktc(tilt):
    found = chatter.simulate(tapered(0.0, tilt, simulation={"revolutions": 4}))
    rate = section(math.radians(tilt)) * FEED * 2 * 8000.0 / 60.0
    assert found.mean_power == pytest.approx(KTC * rate, rel=4e-3)


def assert_hardly_leading_is_upright(made):
    """A tool made of a lead and a tilt cuts alike upright and with next to no lead."""
    upright, leading = (
        made(lead, 0.0, structure={"mode": MODES}, simulation={"revolutions": 4})
        for lead in (0.0, 1e-6)
    )
    one, other = chatter.simulate(upright), chatter.simulate(leading)
    largest = np.abs(one.mean_force).max()
    assert other.mean_force == pytest.approx(one.mean_force, abs=2e-3 * largest)
    assert radius(leading) == pytest.approx(radius(upright), rel=1e-3)


def test_a_tapered_ball_that_hardly_leads_is_an_upright_one():
    assert_hardly_leading_is_upright(tapered)


def radius(case, method="collocation"):
    """Spectral radius of a cut."""
    model = milling_model(case)
    at = np.array([case.cut.spindle_speed]), np.array([case.cut.axial_depth])
    return float(METHODS[method].radius(model, *at, None, no_progress)[0])


def test_a_tapered_ball_by_collocation_and_in_time():
    case = tapered(-10.0, 35.0, structure={"mode": MODES})
    assert radius(case, "time-domain") == pytest.approx(radius(case), rel=4e-3)


CONE = {
    "tool.kind": "taper", "tool.taper_angle": "30 deg", "tool.diameter": 4e-3,
    "tool.corner_radius": None, "tool.helix": 0.0, "cut.axial_depth": 0.4e-3,
    "cut.feed_per_tooth": FEED, "cut.stepover": None, "cut.radial_depth": 1e-3,
}  # fmt: skip


def cone(lead, tilt, mode="up", **further):
    return case_of(lead, tilt, mode, STEP, **further).patch({**CONE, **SHARP})


@pytest.mark.parametrize(("tilt", "mode"), [(10.0, "up"), (-10.0, "down")])
def test_power_of_a_sharp_cone_is_its_removal_rate_times_ktc(tilt, mode):
    """Leaning towards the work, its wall 1 mm within the rim, which is the lowest of the tool.

    The flank reaches out by its angle and the tilt, the end rises inwards by the tilt.
    """
    lean, half, depth, wide = math.radians(10.0), math.radians(30.0), 0.4e-3, 1e-3
    z = depth * (np.arange(100000) + 0.5) / 100000
    reach = z * math.tan(half + lean) + np.minimum(z / math.tan(lean), wide)
    rate = depth * np.mean(reach) * FEED * 2 * 8000.0 / 60.0
    found = chatter.simulate(cone(0.0, tilt, mode, simulation={"revolutions": 4}))
    assert found.mean_power == pytest.approx(KTC * rate, rel=4e-3)


def test_a_sharp_cone_that_hardly_leads_is_an_upright_one():
    assert_hardly_leading_is_upright(cone)


def test_a_sharp_cone_by_collocation_and_in_time():
    case = cone(6.0, 12.0, structure={"mode": MODES})
    assert radius(case, "time-domain") == pytest.approx(radius(case), rel=4e-3)


PLOUGHING = {
    "tool.clearance_angle": "8 deg", "tool.edge_radius": 30e-6, "cut.spindle_speed": "4000 rpm",
    "cut.feed_per_tooth": 0.05e-3, "cut.axial_depth": 0.7e-3, **SHARP,
}  # fmt: skip


def ploughing(lead, tilt, force, mode="up"):
    damping = {"indentation_force": force, "friction": 0.3} if force else {"coefficient": 0.0}
    case = case_of(lead, tilt, mode, 0.4e-3, structure={"mode": MODES}, process_damping=damping)
    return case.patch(PLOUGHING)


@pytest.mark.parametrize(("lead", "tilt"), [(-12.0, 5.0), (15.0, -10.0)])
def test_ploughing_damps_an_inclined_cut_by_as_much_as_in_time(lead, tilt):
    """The flank pressed into its wave step by step, against the dashpot of the linear methods."""
    effects = []
    for multiplier in (radius, in_time):
        bare, pressed = (multiplier(ploughing(lead, tilt, force)) for force in (0.0, 1e14))
        effects.append(math.log(bare / pressed))
    assert effects[0] > 0.03
    assert effects[1] == pytest.approx(effects[0], rel=0.06)


def in_time(case):
    """Size of the multiplier of small vibration in a simulated cut."""
    return abs(simulated_multiplier(case, tuple(milling_model(case).structure.modes)).multiplier)


def test_a_tapered_ball_in_a_mirror_has_the_mirrored_chip():
    """Up beside down milling, +y for -y: of radial forces, as the spindle turns the same way."""
    radial = {"material.Ktc": 1e3}
    mirror = np.diag([1.0, -1.0, 1.0])
    found = []
    for tilt, mode in [(40.0, "up"), (-40.0, "down")]:
        case = tapered(-8.0, tilt, mode, structure={"mode": MODES}).patch(radial)
        model = milling_model(case)
        found.append(model.basis @ model.averaged_directional @ model.basis.T)
    assert found[0] == pytest.approx(mirror @ found[1] @ mirror, abs=2e-5 * np.abs(found[0]).max())


def test_ploughing_on_an_axis_that_hardly_leads_is_that_of_an_upright_tool():
    # without motion along the axis: of the tip of a ball, whose radius is zero, the dashpot along
    # the axis depends on how finely it is resolved
    across = {"structure.mode": MODES[:2]}
    found = [radius(ploughing(lead, 0.0, 1e14).patch(across)) for lead in (0.0, 1e-6)]
    bare = radius(ploughing(0.0, 0.0, 0.0).patch(across))
    assert math.log(bare / found[1]) == pytest.approx(math.log(bare / found[0]), rel=0.015)
    assert found[0] < 0.95 * bare
