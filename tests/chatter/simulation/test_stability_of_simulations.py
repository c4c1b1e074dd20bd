"""Growth and chatter frequency in time against the multipliers of semi-discretization."""

import math

import numpy as np
import pytest

import chatter
from chatter.simulation.simulate import simulate
from tests.cases import tool_of_922_hertz

# the 922 Hz tool of Insperger and Stepan 2004
FREQUENCY, DAMPING, MASS = 922.0, 0.011, 0.03993


def case(speed, depth, mode="up", immersion=0.05, directions=((1, 0, 0),), helix=0.0, **sections):
    return tool_of_922_hertz(
        directions,
        tool={"helix": helix},
        cut={
            "mode": mode,
            "spindle_speed": f"{speed} rpm",
            "feed_per_tooth": "0.2 mm",
            "axial_depth": depth,
            "radial_depth": immersion * 16e-3,
        },
        **{"simulation": {"revolutions": 60, "steps": 1200}, **sections},
    )


def free_motion(found):
    """Change of x from tooth to tooth, (teeth, phases): free vibration around the forced one.

    Cut where an edge might have left the work: the chip of a mode along x is (f + change) sin(phi).
    """
    resolution = found.setup.resolution
    steps = resolution.steps_per_revolution // resolution.stride // found.case.tool.teeth
    turns = (len(found.rows) - 1) // steps
    x = found.displacement[: turns * steps, 0].reshape(turns, steps)[:, :: steps // 20]
    change = np.diff(x, axis=0)
    size = np.abs(change).max(axis=1)
    large = size > 0.8 * found.case.cut.feed_per_tooth
    end = int(np.argmax(large)) if large.any() else len(size)
    small = size[:end] < 1e-7 * size[0]
    end = int(np.argmax(small)) if small.any() else end
    return change[:end]


def multiplier_of(change):
    """Dominant multiplier: eigenvalue of the map from one tooth to the next over the later half.

    Dynamic mode decomposition (Schmid 2010) with the directions that carry 1e-4 of the motion.
    """
    late = change[len(change) // 2 :].T
    assert late.shape[1] >= 8
    u, size, v = np.linalg.svd(late[:, :-1], full_matrices=False)
    rank = int(np.sum(size > 1e-4 * size[0]))
    u, size, v = u[:, :rank], size[:rank], v[:rank]
    roots = np.linalg.eigvals(u.T @ late[:, 1:] @ v.T / size)
    return roots[np.argmax(np.abs(roots))]


def distance(found, wanted):
    """Between multipliers, of which each has its conjugate."""
    return min(abs(found - wanted), abs(found - np.conj(wanted)))


CASES = {
    "stable, low immersion": (5000.0, 0.6e-3, "up", 0.05, "none"),
    "stable, half immersion": (9000.0, 0.15e-3, "down", 0.5, "none"),
    "stable, slot": (8000.0, 0.2e-3, "slot", 1.0, "none"),
    "beyond a Hopf limit": (8000.0, 1.03, "slot", 1.0, "hopf"),
    "beyond a Hopf limit, down": (11000.0, 1.03, "down", 0.3, "hopf"),
    "beyond a flip limit": (19000.0, 1.01, "up", 0.05, "flip"),
}


@pytest.mark.parametrize("name", list(CASES))
def test_decay_and_growth_are_those_of_the_multiplier(name):
    speed, depth, mode, immersion, kind = CASES[name]
    if kind != "none":
        depth *= chatter.check(case(speed, 1e-4, mode, immersion)).critical_depth
    given = case(speed, depth, mode, immersion)
    wanted = chatter.check(given)
    assert wanted.bifurcation == kind
    got = multiplier_of(free_motion(simulate(given)))
    assert distance(got, wanted.multiplier.value) < 1e-3
    if kind == "flip":
        assert got.real < -1.0
    if kind == "hopf":
        # chatter frequency: the angle of the multiplier, and whole turns in a tooth period
        turns = wanted.chatter_frequency * 30.0 / speed
        angle = np.angle(got) / (2.0 * math.pi)
        gap = min(abs(math.remainder(turns - angle, 1.0)), abs(math.remainder(turns + angle, 1.0)))
        assert gap < 0.01 * turns


# exact limits by an independent collocation code
@pytest.mark.parametrize(("speed", "limit_mm"), [(20000.0, 3.774050), (19000.0, 1.369560)])
def test_flip_sets_in_at_the_exact_depth(speed, limit_mm):
    sizes = []
    for factor in (0.995, 1.005):
        long = {"revolutions": 60, "steps": 2400}
        found = simulate(case(speed, factor * limit_mm * 1e-3, simulation=long))
        sizes.append(multiplier_of(free_motion(found)))
        assert sizes[-1].real < 0.0
    assert abs(sizes[0]) < 1.0 < abs(sizes[1])


def test_chatter_frequency_of_the_signal_itself():
    limit = chatter.check(case(8000.0, 1e-4, "slot", 1.0)).critical_depth
    long = {"revolutions": 90, "steps": 1200}
    given = case(8000.0, 1.05 * limit, "slot", 1.0, simulation=long)
    wanted = chatter.check(given)
    found = simulate(given)
    assert found.setup.resolution.stride == 1
    free = (found.displacement[600:, 0] - found.displacement[:-600, 0])[-48000:]
    spectrum = np.abs(np.fft.rfft(free * np.hanning(free.size), 16 * free.size))
    frequency = np.fft.rfftfreq(16 * free.size, found.time[1])
    assert frequency[np.argmax(spectrum)] == pytest.approx(wanted.chatter_frequency, rel=0.01)


def test_time_domain_limit_agrees_with_semi_discretization():
    """The growth per tooth passes one at the critical depth, to 2 %."""
    for speed in (8000.0, 12500.0, 17000.0):
        limit = chatter.check(case(speed, 1e-4, "down", 0.4)).critical_depth
        below, beyond = (
            abs(multiplier_of(free_motion(simulate(case(speed, f * limit, "down", 0.4)))))
            for f in (0.98, 1.02)
        )
        assert below < 1.0 < beyond


@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_process_damping_changes_the_multiplier_as_it_must(friction):
    sections = {"process_damping": {"coefficient": 8e4, "friction": friction}}
    bare = chatter.check(case(4000.0, 0.25e-3, "up", 0.5))
    given = case(4000.0, 0.25e-3, "up", 0.5, **sections)
    wanted = chatter.check(given)
    assert abs(wanted.spectral_radius - bare.spectral_radius) > 0.05
    got = multiplier_of(free_motion(simulate(given)))
    assert abs(got) == pytest.approx(wanted.spectral_radius, rel=0.01)


def test_process_damping_alone_is_added_damping():
    """Of two straight teeth in a slot one is in the cut: a dashpot C b/V at sin(phi)^2."""
    coefficient, depth, speed = 2e5, 1e-3, 12000.0
    given = case(
        speed,
        depth,
        "slot",
        1.0,
        process_damping={"coefficient": coefficient},
        # no regeneration; the edge force alone sets the tool moving
        material={"law": "linear", "Ktc": 1e3, "Krc": 0.0, "Kre": 100.0},
    )
    got = abs(multiplier_of(free_motion(simulate(given))))
    viscous = 2.0 * DAMPING * MASS * 2.0 * math.pi * FREQUENCY
    added = 0.5 * coefficient * depth / (8e-3 * speed * math.pi / 30.0)
    assert added > viscous
    rate = -math.log(got) * speed / 30.0
    assert rate == pytest.approx((viscous + added) / (2.0 * MASS), rel=0.02)
