"""Forces of a rigid tool against integrals of the force law along the edge."""

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import quad

from chatter import Case
from chatter.simulation.simulate import simulate
from cutting.tool.cutter import Cutter, edge_slices, slice_counts

KTC, KRC, KAC = 1.1e9, 4.0e8, 1.5e8
KTE, KRE, KAE = 2.2e4, 3.1e4, 2.0e3
FEED = 1.2e-4
RADIUS = 6e-3
MATERIAL = {
    "law": "linear",
    **{"Ktc": KTC, "Krc": KRC, "Kac": KAC},
    **{"Kte": KTE, "Kre": KRE, "Kae": KAE},
}
ARC = {
    "up": (0.0, math.acos(1.0 - 0.7)),
    "down": (math.pi - math.acos(1.0 - 0.7), math.pi),
    "slot": (0.0, math.pi),
}


def case(mode="down", teeth=3, helix=0.5, depth=5e-3, tool=None, material=None, **simulation):
    return Case.from_dict(
        {
            "title": "rigid tool",
            "tool": {
                "kind": "end mill",
                "teeth": teeth,
                "diameter": 2.0 * RADIUS,
                "helix": helix,
                **(tool or {}),
            },
            "material": material or MATERIAL,
            "cut": {
                "mode": mode,
                "spindle_speed": "6000 rpm",
                "feed_per_tooth": FEED,
                "axial_depth": depth,
                "radial_depth": 2.0 * RADIUS if mode == "slot" else 0.7 * RADIUS,
            },
            "simulation": {"revolutions": 1, **simulation},
        }
    )


def antiderivatives(phi):
    """Integrals over phi of (Fx, Fy, Fz, Ft) per length of edge, linear law with edge terms."""
    s, c = np.sin(phi), np.cos(phi)
    ss, sc = 0.5 * phi - 0.25 * np.sin(2.0 * phi), 0.5 * s * s
    return np.array(
        [
            -KTC * FEED * sc - KTE * s - KRC * FEED * ss + KRE * c,
            KTC * FEED * ss - KTE * c - KRC * FEED * sc - KRE * s,
            -KAC * FEED * c + KAE * phi,
            -KTC * FEED * c + KTE * phi,
        ]
    )


def closed_form(theta, teeth, helix, depth, arc):
    """(Fx, Fy, Fz, torque) of equally spaced teeth with helix, each (n,)."""
    lag = math.tan(helix) / RADIUS
    total = np.zeros((4, theta.size))
    for j in range(teeth):
        tip = theta + 2.0 * math.pi * j / teeth
        low, high = np.minimum(tip, tip - lag * depth), np.maximum(tip, tip - lag * depth)
        for turn in range(-5, 6):
            begin = np.maximum(low, arc[0] + 2.0 * math.pi * turn)
            end = np.minimum(high, arc[1] + 2.0 * math.pi * turn)
            end = np.maximum(begin, end)
            total += (antiderivatives(end) - antiderivatives(begin)) / abs(lag)
    total[3] *= RADIUS
    return total


@pytest.mark.parametrize("mode", ["up", "down", "slot"])
@pytest.mark.parametrize(
    ("helix_deg", "depth", "teeth"),
    [(30.0, 5e-3, 3), (45.0, 2e-3, 1), (8.0, 0.7e-3, 4), (50.0, 40e-3, 2), (-35.0, 6e-3, 4)],
)
def test_helical_edges_give_the_closed_form(mode, helix_deg, depth, teeth):
    helix = math.radians(helix_deg)
    run = simulate(case(mode, teeth, helix, depth))
    wanted = closed_form(run.spindle_angle, teeth, helix, depth, ARC[mode])
    got = np.vstack([run.force.T, run.torque])
    peak = np.abs(wanted).max(axis=1, keepdims=True)
    assert np.all(np.abs(got - wanted) < 1e-6 * peak)


@pytest.mark.parametrize("mode", ["up", "down", "slot"])
@pytest.mark.parametrize("teeth", [1, 2, 5])
def test_straight_edges_give_the_law_at_every_instant(mode, teeth):
    depth = 3e-3
    run = simulate(case(mode, teeth, 0.0, depth))
    entry, leave = ARC[mode]
    wanted, clear = np.zeros((4, run.time.size)), np.ones(run.time.size, dtype=bool)
    for j in range(teeth):
        phi = np.mod(run.spindle_angle + 2.0 * math.pi * j / teeth, 2.0 * math.pi)
        for border in (entry, leave):
            clear &= np.abs(np.mod(phi - border + math.pi, 2.0 * math.pi) - math.pi) > 1e-9
        inside = (phi > entry) & (phi < leave)
        s, c = np.sin(phi), np.cos(phi)
        ft, fr = KTC * FEED * s + KTE, KRC * FEED * s + KRE
        wanted += (
            inside
            * depth
            * np.array([-ft * c - fr * s, ft * s - fr * c, KAC * FEED * s + KAE, ft * RADIUS])
        )
    got = np.vstack([run.force.T, run.torque])
    peak = np.abs(wanted).max(axis=1, keepdims=True)
    assert clear.mean() > 0.95
    assert np.all(np.abs(got - wanted)[:, clear] < 1e-6 * peak)


def test_signs_and_places_of_a_single_tooth():
    # a quarter turn after +y the tooth points along the feed, where the chip is thickest
    run = simulate(case("slot", 1, 0.0, 1e-3))
    at = np.argmin(np.abs(run.spindle_angle - 0.5 * math.pi))
    assert run.force[at, 0] == pytest.approx(-(KRC * FEED + KRE) * 1e-3, rel=1e-9)
    assert run.force[at, 1] == pytest.approx((KTC * FEED + KTE) * 1e-3, rel=1e-9)
    assert run.force[at, 2] == pytest.approx((KAC * FEED + KAE) * 1e-3, rel=1e-9)
    in_air = (run.spindle_angle > math.pi + 0.02) & (run.spindle_angle < 2.0 * math.pi - 0.02)
    assert np.all(run.force[in_air] == 0.0)


def test_power_is_the_work_of_the_tangential_force():
    # mean power = Ktc times removal rate + Kte times the way of the edges in the cut
    depth = 5e-3
    run = simulate(case("down", 3, math.radians(30.0), depth))
    rate = 0.7 * RADIUS * depth * FEED * 3 * 100.0
    arc = ARC["down"][1] - ARC["down"][0]
    wanted = KTC * rate + KTE * depth * 3 * arc / (2.0 * math.pi) * RADIUS * 200.0 * math.pi
    assert np.mean(run.power[:-1]) == pytest.approx(wanted, rel=1e-5)


def exponential(p, h0, **others):
    return {**MATERIAL, "law": "exponential", "exponent": p, "h0": h0, **others}


def by_quadrature(theta, per_length, pieces, teeth, radius_at, arc_of, lag, top):
    """Integral along z of (Fx, Fy, Fz) per height for each spindle angle; pieces split z."""
    total = np.zeros((len(theta), 3))
    for i, angle in enumerate(theta):
        for j in range(teeth):
            tip = angle + 2.0 * math.pi * j / teeth

            def at(z, axis, tip=tip):
                phi = math.remainder(tip - lag * z - math.pi, 2.0 * math.pi) + math.pi
                arc = arc_of(radius_at(z))
                return per_length(phi, z)[axis] if arc[0] < phi < arc[1] else 0.0

            # the borders of the arc cut the range of z
            knots = list(pieces)
            for border in {*arc_of(radius_at(0.5 * top))}:
                for turn in range(-3, 4):
                    z = (tip - border + 2.0 * math.pi * turn) / lag if lag else -1.0
                    knots += [z] if 0.0 < z < top else []
            for axis in range(3):
                total[i, axis] += sum(
                    quad(at, a, b, args=(axis,), epsrel=1e-8, epsabs=1e-6)[0]
                    for a, b in itertools.pairwise(sorted(knots))
                )
    return total


@pytest.mark.parametrize(
    ("p", "h0", "others"),
    [
        (0.7, 1e-4, {}),
        (0.9, 1e-3, {}),
        (0.9, 1e-4, {"radial_exponent": 0.5, "axial_exponent": 1.0}),
    ],
)
def test_exponential_law_against_quadrature(p, h0, others):
    helix, depth, teeth = math.radians(40.0), 6e-3, 2
    run = simulate(
        case("up", teeth, helix, depth, material=exponential(p, h0, **others), slices=400, steps=48)
    )
    picked = np.arange(1, 48, 9)

    def law(phi, z):
        s, c = math.sin(phi), math.cos(phi)
        powers = (p, others.get("radial_exponent", p), others.get("axial_exponent", p))
        tangential, radial, axial = (h0 * (FEED * s / h0) ** power for power in powers)
        ft, fr = KTC * tangential + KTE, KRC * radial + KRE
        return -ft * c - fr * s, ft * s - fr * c, KAC * axial + KAE

    lag = math.tan(helix) / RADIUS
    wanted = by_quadrature(
        run.spindle_angle[picked], law, (0.0, depth), teeth, lambda z: RADIUS,
        lambda radius: ARC["up"], lag, depth,
    )  # fmt: skip
    peak = np.abs(run.force).max(axis=0)
    assert np.all(np.abs(run.force[picked] - wanted) < 2e-6 * peak)


def test_exponential_law_at_default_slices():
    # the law has a root at zero thickness, which two Gauss points take less well
    helix, depth, teeth = math.radians(30.0), 5e-3, 3
    coarse = simulate(case("down", teeth, helix, depth, material=exponential(0.75, 1e-4)))
    fine = simulate(case("down", teeth, helix, depth, material=exponential(0.75, 1e-4), slices=800))
    peak = np.abs(fine.force).max(axis=0)
    assert np.all(np.abs(coarse.force - fine.force) < 1e-3 * peak)


def test_the_exponent_one_is_the_linear_law():
    given = simulate(case("down", material=exponential(1.0, 1e-4)))
    linear = simulate(case("down"))
    assert np.allclose(given.force, linear.force, rtol=0.0, atol=1e-9)


def _ball(z):
    sine = math.sqrt(max(z * (2.0 * RADIUS - z), 1e-30)) / RADIUS
    return RADIUS * sine, math.acos(1.0 - z / RADIUS)


def _bull(z):
    corner = 2e-3
    if z >= corner:
        return RADIUS, 0.5 * math.pi
    angle = math.acos(1.0 - z / corner)
    return RADIUS - corner + corner * math.sin(angle), angle


def _insert(z):
    return RADIUS + z, 0.25 * math.pi


def _taper(z):
    angle = math.radians(6.0)
    return RADIUS + z * math.tan(angle), 0.5 * math.pi - angle


PROFILES = {
    "ball": (_ball, {"kind": "ball"}, 4e-3, ()),
    "bull nose": (_bull, {"kind": "bull nose", "corner_radius": 2e-3}, 4e-3, (2e-3,)),
    "inserted": (_insert, {"kind": "inserted", "cutting_edge_angle": "45 deg"}, 2e-3, ()),
    "taper": (_taper, {"kind": "taper", "taper_angle": "6 deg"}, 5e-3, ()),
}


def _profile_force(theta, kind, teeth, helix):
    """Slot: force by Gauss quadrature along the true profile, in the arc length."""
    profile, _, depth, knots = PROFILES[kind]
    lag = math.tan(helix) / RADIUS
    nodes, weights = np.polynomial.legendre.leggauss(24)
    total = np.zeros((theta.size, 3))
    for i, angle in enumerate(theta):
        for j in range(teeth):
            tip = angle + 2.0 * math.pi * j / teeth
            cuts = [0.0, depth, *knots]
            cuts += [
                z
                for turn in range(-4, 5)
                if lag and 0.0 < (z := (tip - turn * math.pi) / lag) < depth
            ]
            cuts.sort()
            for a, b in itertools.pairwise(cuts):
                # z = a + (b-a) t^2 takes the root of the ball's radius at its tip
                t = 0.5 * (nodes + 1.0)
                for z, weight in zip(a + (b - a) * t * t, weights * t * (b - a), strict=True):
                    phi = tip - lag * z
                    s, c = math.sin(phi), math.cos(phi)
                    if s <= 0.0:
                        continue
                    _, kappa = profile(z)
                    sk, ck = math.sin(kappa), math.cos(kappa)
                    h = FEED * s * sk
                    ft, fr, fa = KTC * h + KTE, KRC * h + KRE, KAC * h + KAE
                    # Altintas and Engin 2001: radial along the normal of the edge, into the tool
                    f = (
                        -ft * c - fr * sk * s + fa * ck * s,
                        ft * s - fr * sk * c + fa * ck * c,
                        fr * ck + fa * sk,
                    )
                    total[i] += weight / sk * np.array(f)
    return total


@pytest.mark.parametrize("kind", list(PROFILES))
def test_curved_and_inclined_edges_against_quadrature(kind):
    _, tool, depth, _ = PROFILES[kind]
    teeth, helix = 2, math.radians(25.0)
    run = simulate(case("slot", teeth, helix, depth, tool=tool, slices=60))
    picked = np.arange(7, 360, 23)
    wanted = _profile_force(run.spindle_angle[picked], kind, teeth, helix)
    peak = np.abs(wanted).max(axis=0)
    error = np.abs(run.force[picked] - wanted) / peak
    # a ball has its edge coefficients where the edge is nearly flat
    assert error.max() < (1e-6 if kind in ("taper", "inserted") else 2e-3)


def test_corner_slices_count_for_little():
    # the corner is cut at equal arcs; the force at the default count is within a few parts in 1e3
    cutter = Cutter(2.0 * RADIUS, (0.4,), (2.0 * math.pi,), corner_radius=RADIUS)
    errors = []
    for factor in (1, 2, 4):
        corner, straight = slice_counts(cutter, 4e-3)
        slices = edge_slices(cutter, 4e-3, (factor * corner, straight))
        volume = np.sum(slices.edge_length * np.sin(slices.immersion))
        errors.append(abs(volume - 4e-3))
    assert errors[0] < 1e-3 * 4e-3
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.05)


def test_slices_of_a_helical_edge_converge_with_the_fourth_power():
    helix, depth = math.radians(50.0), 6e-3
    errors = []
    for slices in (4, 8, 16):
        run = simulate(case("slot", 2, helix, depth, slices=slices, steps=96))
        wanted = closed_form(run.spindle_angle, 2, helix, depth, ARC["slot"])[:3].T
        errors.append(np.sqrt(np.mean((run.force - wanted) ** 2)))
    order = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert np.all(np.abs(order - 4.0) < 0.4)


@pytest.mark.parametrize(("mode", "depth_share"), [("up", 0.028), ("down", 0.025), ("up", 0.06)])
@pytest.mark.parametrize("revolutions", [2, 300])
def test_a_straight_edge_has_its_mean_torque_and_power_in_short_and_long_records(
    mode, depth_share, revolutions
):
    # it enters between two steps, and a long record keeps one step of several
    width = depth_share * RADIUS
    given = case(mode, teeth=1, helix=0.0, revolutions=revolutions).patch(
        {"cut.radial_depth": width, "simulation.revolutions": revolutions}
    )
    result = simulate(given)
    assert (result.setup.resolution.stride > 1) == (revolutions > 2)
    arc = math.acos(1.0 - depth_share)
    low, high = (0.0, arc) if mode == "up" else (math.pi - arc, math.pi)
    expected = 5e-3 * (antiderivatives(high) - antiderivatives(low)) / (2.0 * math.pi)
    told = result.summary()
    scale = np.abs(expected[:2]).max()
    found = [told["mean_force_N"][axis] for axis in ("Fx", "Fy", "Fz")]
    np.testing.assert_allclose(found, expected[:3], atol=1e-3 * scale)
    torque = told["power"]["mean_torque_Nm"]
    assert torque == pytest.approx(expected[3] * RADIUS, rel=1e-3)
    assert told["power"]["mean_W"] == pytest.approx(torque * 200.0 * math.pi, rel=1e-6)


def test_deep_waves_of_an_edge_get_slices_enough():
    # the hunt's case: waves ten feeds deep, a depth of cut of an eighth of a wave
    wave = {"depth": "0.060452 mm", "wavelength": "2.33244 mm"}
    given = case("slot", 6, math.radians(26.6369), 0.3e-3, {"serration": wave}, revolutions=2)
    given = given.patch({"cut.feed_per_tooth": 6.1e-6, "simulation.revolutions": 2})
    coarse = simulate(given).mean_force
    # a wave in 2000 parts
    fine = simulate(given.patch({"simulation.slices": 257})).mean_force
    np.testing.assert_allclose(coarse, fine, atol=0.005 * np.linalg.norm(fine))


def test_a_round_peak_of_few_steps_is_no_kink():
    # a steep ball end mill, whose force peaks within a few steps; steps ten times finer show it
    ball = {"kind": "ball", "diameter": "18.2117 mm"}
    given = case("up", 2, math.radians(49.0749), 0.627689e-3, ball, revolutions=1).patch(
        {"cut.mode": "down", "cut.radial_depth": "8.33987 mm", "cut.feed_per_tooth": 5.13511e-6}
    )
    fine = simulate(given.patch({"simulation.steps": 14400}))
    peak = np.abs(fine.force).max(axis=0)
    np.testing.assert_allclose(simulate(given).peak_force, peak, atol=0.01 * peak.max())
