"""The matrix-free method against exact values, the independent reference and collocation."""

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import quad

from chatter.description.case import Case
from chatter.description.errors import RunError
from chatter.description.progress import no_progress
from chatter.engine import parallel as sweep
from chatter.stability.methods.collocation import multipliers as collocation
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.methods.matrix_free import multipliers as matrix_free
from chatter.stability.methods.matrix_free.modal_response import (
    POSITIONS,
    graded_response,
    mode_response,
)
from chatter.stability.methods.matrix_free.stepped_cut import stepped_cut, with_contact
from chatter.stability.methods.time_domain.critical_depths import growths
from chatter.stability.model import milling_model
from chatter.stability.registry import METHODS, chosen_method
from cutting.edge_segments.segments import period_angle
from tests.validation.reference import dense_cases
from tests.validation.reference.general_cases import case_dict, load
from tests.validation.reference.general_cut import GeneralCut, spectral_radius

RPM = math.pi / 30.0
CASES = load()


def converged(model, speed, depth, *tolerance):
    return matrix_free.converged_multiplier(
        lambda fineness: stepped_cut(model, depth, fineness), speed, depth, *tolerance
    )


def model_of(tool, cut, modes=None, **sections):
    modes = modes or [
        {"frequency": 922.0, "damping": 0.011, "mass": 0.03993, "direction": [1, 0, 0]}
    ]
    return milling_model(
        Case.from_dict(
            {
                "tool": {"teeth": 2, "diameter": 16e-3, **tool},
                "material": {"Ktc": 6e8, "Krc": 2e8},
                "cut": {
                    "mode": "down", "spindle_speed": 1000.0, "feed_per_tooth": 1e-4,
                    "axial_depth": 1e-3, "radial_depth": 1.6e-3, **cut,
                },
                "structure": {"mode": modes},
                **sections,
            }
        )
    )  # fmt: skip


TWO_MODES = [
    {"frequency": 922.0, "damping": 0.011, "mass": 0.03993, "direction": [1, 0, 0]},
    {"frequency": 750.0, "damping": 0.02, "mass": 0.05, "direction": [0, 1, 0]},
]
TOOLS = {
    "uniform": model_of({}, {}),
    "variable pitch": model_of(
        {"teeth": 4, "pitch": [math.radians(a) for a in (84, 96, 87, 93)]}, {}, TWO_MODES
    ),
    "variable helix": model_of(
        {"helix": [math.radians(30.0), math.radians(38.0)]}, {}, TWO_MODES
    ),
    "ball": model_of(
        {"kind": "ball", "helix": math.radians(20.0)}, {"mode": "slot", "radial_depth": 16e-3},
        TWO_MODES,
    ),
    "runout": model_of(
        {"teeth": 3, "helix": math.radians(30.0), "runout": {"offset": 2e-5, "angle": 0.4}}, {},
        TWO_MODES,
    ),
    "process damping": model_of(
        {}, {"mode": "slot", "radial_depth": 16e-3}, TWO_MODES,
        process_damping={"coefficient": 2e4, "friction": 0.3},
    ),
    "varying speed": model_of(
        {}, {"speed_variation": {"amplitude": 0.1, "frequency": 40.0}}, TWO_MODES
    ),
    # delays of three pitches, dashpots as one over the speed, elements cut in two at corners
    "varying speed, pitch, helix, process damping": model_of(
        {"teeth": 3, "pitch": [math.radians(a) for a in (110, 120, 130)], "helix": 0.5},
        {"speed_variation": {"amplitude": 0.3, "frequency": 90.0, "shape": "triangle"}}, TWO_MODES,
        process_damping={"coefficient": 2e4, "friction": 0.3},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", TOOLS)
def test_radius_of_every_tool_is_that_of_collocation(name):
    model = TOOLS[name]
    rpm, depth = (part.ravel() for part in np.meshgrid([6100.0, 9700.0], [0.4e-3, 2e-3, 4e-3]))
    found = np.abs(matrix_free.multipliers(stepped_cut(model, 4e-3), rpm * RPM, depth))
    exact = np.abs(collocation.multipliers(element_cut(model, 4e-3, 12, 0.6), rpm * RPM, depth))
    assert found == pytest.approx(exact, rel=1e-4, abs=1e-5)


def test_radius_of_random_cases_of_any_tool():
    errors = []
    # one in two: all sixty are within 3e-5
    for cut, expected in CASES[::2]:
        model = milling_model(Case.from_dict(case_dict(cut)))
        point = np.array([cut.speed]), np.array([cut.depth])
        radius = abs(matrix_free.multipliers(stepped_cut(model, cut.depth), *point)[0])
        # the reference counts from turn to turn
        repeats = 1 if cut.variation else round(2.0 * math.pi / period_angle(model.cutter))
        errors.append(abs(radius**repeats - expected) / max(1.0, expected))
    assert max(errors) < 1e-4


def test_radius_of_dense_cases_of_any_tool():
    """Three and more of corner, runout, size effect, helices, pitch, variation at once."""
    errors = []
    for cut, expected in load(dense_cases.STORE):
        model = milling_model(Case.from_dict(dense_cases.case_dict(cut)))
        found = converged(model, cut.speed, cut.depth)
        repeats = 1 if cut.variation else round(2.0 * math.pi / period_angle(model.cutter))
        errors.append(abs(abs(found.value) ** repeats - expected) / max(1.0, expected))
    assert max(errors) < 1e-4


def general_cut(**changes):
    """Two straight teeth, two modes; see `reference.general_cut`."""
    modes = (922.0, 0.011, 0.03993, (1.0, 0.0, 0.0)), (750.0, 0.02, 0.05, (0.0, 1.0, 0.0))
    given = {
        "diameter": 16e-3, "pitch": (math.pi,) * 2, "helix": (0.0,) * 2, "mode": "up",
        "radial_depth": 1.6e-3, "coefficients": (6e8, 2e8, 1e8), "modes": modes,
        "speed": 9000.0 * RPM, "depth": 1e-3,
    }  # fmt: skip
    return GeneralCut(**(given | changes))


def radius_a_turn(cut):
    """Spectral radius over a turn and its estimated error, the steps and the edge refined."""
    found = converged(milling_model(Case.from_dict(case_dict(cut))), cut.speed, cut.depth)
    return abs(found.value) ** cut.teeth, cut.teeth * found.error


@pytest.mark.parametrize(("angle", "mode", "share"), [(30.0, "down", 0.03), (45.0, "up", 0.1)])
def test_flat_cones_that_hardly_touch(angle, mode, share):
    """The arc grows steeply along the edge; chords of it alone would be 4e-4 off."""
    cut = general_cut(
        pitch=(2.0 * math.pi / 3.0,) * 3, helix=(math.radians(30.0),) * 3, mode=mode,
        radial_depth=share * 16e-3, edge_angle=math.radians(angle), depth=2e-3,
    )  # fmt: skip
    exact = spectral_radius(cut, nodes=8, waves=0.7, samples=400)
    radius, error = radius_a_turn(cut)
    assert abs(radius - exact) < 1e-4 * max(1.0, exact)
    assert abs(radius - exact) < 2.0 * error + 1e-5


@pytest.mark.parametrize(
    ("exponent", "changes"),
    [
        (0.5, {}),
        (0.6, {}),
        (0.8, {"mode": "slot", "radial_depth": 16e-3}),
        # a flat tip that enters and leaves all at once
        (0.8, {"corner_radius": 4e-3, "helix": (0.6,) * 2, "mode": "slot", "radial_depth": 16e-3}),
        # radial forces that level off sooner, and later, than the tangential ones
        (0.9, {"radial_exponent": 0.5}),
        (0.6, {"radial_exponent": 0.9, "corner_radius": 4e-3, "helix": (0.6,) * 2}),
    ],
)  # fmt: skip
def test_a_size_effect_where_chips_vanish(exponent, changes):
    cut = general_cut(exponent=exponent, **changes)
    exact = spectral_radius(cut, nodes=10, waves=0.7)
    radius, _ = radius_a_turn(cut)
    assert radius == pytest.approx(exact, rel=3e-5)


@pytest.mark.parametrize(
    ("mode", "rpm", "depth_mm", "immersion", "exact"),
    [
        # validation 2.1 and 2.2
        ("down", 5000, 0.2, 1.0, 0.81974278427),
        ("down", 5000, 1.0, 1.0, 1.40647352539),
        ("up", 20000, 4.0, 0.05, 1.0543980187),
    ],
)
def test_published_multipliers(mode, rpm, depth_mm, immersion, exact):
    model = model_of({}, {"mode": mode, "radial_depth": immersion * 16e-3})
    found = converged(model, rpm * RPM, depth_mm * 1e-3)
    assert abs(found.value) == pytest.approx(exact, rel=2e-6)
    assert abs(abs(found.value) - exact) <= found.error < 2e-5


@pytest.mark.parametrize("name", ["uniform", "variable pitch", "process damping"])
def test_fourth_order_convergence(name):
    model = TOOLS[name]
    point = np.array([5000 * RPM]), np.array([2e-3])
    exact = abs(collocation.multipliers(element_cut(model, 2e-3, 12, 0.4), *point)[0])
    errors = np.array(
        [
            abs(
                abs(matrix_free.multipliers(stepped_cut(model, 2e-3), *point, refinements=(r,))[0])
                - exact
            )
            for r in (1, 2, 4)
        ]
    )
    assert np.log2(errors[:-1] / errors[1:]) == pytest.approx([4.0, 4.0], abs=0.35)
    better = abs(matrix_free.multipliers(stepped_cut(model, 2e-3), *point)[0])
    assert abs(better - exact) < 0.2 * errors[1]


def test_fourth_order_where_an_edge_leaves_within_its_length_just_before_its_top():
    """Of a flat cone the exit turns round 1e-4 rad before the top leaves: a root at both borders.

    Of second order and less, steps four times as fine would be off by a seventh of the error.
    """
    tool = {
        "teeth": 2, "diameter": 30.29e-3, "kind": "inserted", "helix": 0.504,
        "pitch": [3.0027, 2.0 * math.pi - 3.0027], "cutting_edge_angle": 0.0266,
    }  # fmt: skip
    cut = {
        "mode": "up", "spindle_speed": 37000.0, "feed_per_tooth": 2.56e-5,
        "axial_depth": 0.833e-3, "radial_depth": 17.16e-3,
    }  # fmt: skip
    law = {"law": "exponential", "Ktc": 6.57e8, "Krc": 5.2e8, "h0": 1e-4, "exponent": 0.515}
    modes = [{"frequency": 9000.0, "damping": 0.05, "stiffness": 8e6, "direction": [0, 0, 1]}]
    stepped = stepped_cut(model_of(tool, cut, modes, material=law), cut["axial_depth"])
    point = np.array([cut["spindle_speed"]]), np.array([cut["axial_depth"]])
    radius = [
        abs(matrix_free.multipliers(stepped, *point, refinements=(refinement,))[0])
        for refinement in (1, 2, 4)
    ]
    assert abs(radius[2] - radius[1]) < abs(radius[1] - radius[0]) / 6.0


@pytest.mark.parametrize("name", ["uniform", "variable pitch", "runout"])
def test_limits_are_those_of_collocation(name):
    model = TOOLS[name]
    speeds = np.array([5200.0, 8000.0, 11000.0]) * RPM
    depths = np.linspace(0.0, 12e-3, 25)[1:]
    found = METHODS["matrix-free"].limits(model, speeds, depths, None, no_progress)
    other = METHODS["collocation"].limits(model, speeds, depths, None, no_progress)
    assert np.isfinite(other.critical_depth).sum() >= 2
    assert found.critical_depth == pytest.approx(other.critical_depth, rel=2e-3)
    assert found.chatter_frequency == pytest.approx(other.chatter_frequency, rel=1e-3, nan_ok=True)
    assert found.bifurcation == other.bifurcation
    assert [len(c) for c in found.crossings] == [len(c) for c in other.crossings]
    assert found.steps.min() > 40
    # the estimate is that of the finer steps alone: the extrapolated limits are better
    apart = np.nanmax(np.abs(found.critical_depth / other.critical_depth - 1.0))
    assert 0.1 * apart < found.error < 1e-3


def test_the_grid_and_the_operating_point_of_the_method():
    model = model_of({}, {"spindle_speed": 5000 * RPM, "mode": "slot", "radial_depth": 16e-3})
    point = np.array([5000 * RPM]), np.array([1e-3])
    radius = METHODS["matrix-free"].radius(model, *point, None, no_progress)
    assert radius == pytest.approx([1.40647352539], rel=1e-5)
    own = METHODS["matrix-free"].multiplier(model, None)
    assert abs(own.value) == pytest.approx(1.40647352539, rel=2e-6)
    assert METHODS["matrix-free"].chatter_frequency(model) == pytest.approx(
        METHODS["collocation"].chatter_frequency(model), rel=1e-4
    )


def test_the_same_bytes_whatever_the_number_of_threads(monkeypatch):
    cut = stepped_cut(TOOLS["variable helix"], 3e-3)
    speeds, depths = np.linspace(600.0, 1300.0, 40), np.full(40, 3e-3)
    found = []
    for workers in (1, 2, 5):
        monkeypatch.setattr(sweep, "worker_count", lambda workers=workers: workers)
        found.append(matrix_free.multipliers(cut, speeds, depths).tobytes())
    assert len(set(found)) == 1


def test_too_many_vibrations_are_refused():
    cut = stepped_cut(TOOLS["uniform"], 1e-3)
    with pytest.raises(RunError, match="raise the lowest spindle speed"):
        matrix_free.multipliers(cut, np.array([0.1]), np.array([1e-3]))
    # few enough for two resolutions, too many for all: what is there is told with its error
    found = converged(TOOLS["uniform"], 6.0, 1e-3, 1e-15)
    assert 0.0 < found.error < 1e-3


@pytest.mark.parametrize("angle", [1e-3, 0.3, 1.4, 1.6, 7.0])
def test_a_mode_answers_exactly_to_a_line(angle):
    """Against the particular and the free motion of x'' + 2 z w x' + w^2 x = a + b t."""
    omega, zeta, length = 50.0, 0.07, angle / 50.0
    out = np.empty((4, 2, 4))
    mode_response(omega, zeta, length, out)
    start, forces = np.array([0.3, -0.2]), np.array([2.0, 5.0])
    b = (forces[1] - forces[0]) / ((POSITIONS[1] - POSITIONS[0]) * length)
    a = forces[0] - b * POSITIONS[0] * length
    constant = (a - 2.0 * zeta * b / omega) / omega**2
    root = omega * math.sqrt(1.0 - zeta**2)
    first = start[0] - constant
    second = (start[1] * omega - b / omega**2 + zeta * omega * first) / root
    for place, row in zip(POSITIONS, out, strict=True):
        t = place * length
        fade, c, s = math.exp(-zeta * omega * t), math.cos(root * t), math.sin(root * t)
        x = constant + b / omega**2 * t + fade * (first * c + second * s)
        rate = -zeta * omega * first + root * second, -zeta * omega * second - root * first
        v = b / omega**2 + fade * (rate[0] * c + rate[1] * s)
        found = row @ np.concatenate([start, forces])
        assert found == pytest.approx([x, v / omega], rel=1e-7, abs=1e-9)


def answer_to_infinite_force(mode, exponent, span, count):
    """State of a mode after `count` steps drawn towards |t|^(p-1) exp(t) at time zero."""
    place, weight = np.zeros((17, 16)), np.zeros((17, 16))
    for order in range(1, 17):
        nodes, weights = np.polynomial.legendre.leggauss(order)
        place[order, :order], weight[order, :order] = 0.5 * (nodes + 1.0), 0.5 * weights
    power = math.ceil(4.0 * exponent) / exponent
    state, out = np.zeros(2), np.empty((4, 2, 4))
    marks = np.linspace(0.0, 1.0, count + 1)[:: 1 if span > 0.0 else -1]
    for low, high in itertools.pairwise(marks):
        graded_response(*mode, (place, weight), (span, power, low, high), out)
        times = span * (low + POSITIONS[:2] * (high - low)) ** power
        forces = np.abs(times) ** (exponent - 1.0) * np.exp(times)
        state = out[3] @ np.concatenate([state, forces])
    return state


@pytest.mark.parametrize("exponent", [0.3, 0.6, 0.95])
@pytest.mark.parametrize("span", [0.3, -0.3])
def test_a_mode_answers_to_a_force_that_is_infinite_at_a_border(exponent, span):
    """Against quadrature with that very weight, before and after the border; of order four."""
    omega, zeta = 3.0, 0.05
    root, end = math.sqrt(1.0 - zeta**2), max(span, 0.0)

    def smooth(t, velocity):
        angle = omega * (end - t)
        wave = math.sin(root * angle) / root
        if velocity:
            wave = math.cos(root * angle) - zeta * wave
        return math.exp(t - zeta * angle) * wave / omega

    powers = (exponent - 1.0, 0.0) if span > 0.0 else (0.0, exponent - 1.0)
    exact = np.array(
        [
            quad(smooth, *sorted([0.0, span]), (part,), weight="alg", wvar=powers)[0]
            for part in (False, True)
        ]
    )
    errors = [
        np.abs(answer_to_infinite_force((omega, zeta), exponent, span, count) / exact - 1.0).max()
        for count in (6, 12)
    ]
    assert errors[0] < 1e-3
    assert errors[0] / errors[1] > 12.0


# --- contact of tool and work ---------------------------------------------------------------------

#: one of two straight teeth is always in the cut of a slot: the contact is always whole
SLOT = {"mode": "slot", "radial_depth": 16e-3, "spindle_speed": 8000 * RPM}


def test_a_contact_that_is_always_whole_is_a_stiffer_mode():
    spring, damper = 4e5, 30.0
    omega, mass = 2.0 * math.pi * 922.0, 0.03993
    held = model_of({}, SLOT, contact={"stiffness": spring, "damping": damper})
    stiffness = mass * omega**2 + spring
    damping = 2.0 * 0.011 * mass * omega + damper
    natural = math.sqrt(stiffness / mass)
    stiff = model_of(
        {}, SLOT,
        [
            {
                "frequency": natural / (2.0 * math.pi), "damping": damping / (2.0 * mass * natural),
                "mass": mass, "direction": [1, 0, 0],
            }
        ],
    )  # fmt: skip
    speeds, depths = np.full(3, 8000 * RPM), np.array([0.3e-3, 1e-3, 3e-3])
    found = np.abs(matrix_free.multipliers(stepped_cut(held, 3e-3), speeds, depths))
    exact = np.abs(collocation.multipliers(element_cut(stiff, 3e-3, 12, 0.6), speeds, depths))
    assert found == pytest.approx(exact, rel=1e-5)
    free = np.abs(matrix_free.multipliers(stepped_cut(model_of({}, SLOT), 3e-3), speeds, depths))
    assert not np.allclose(found, free, rtol=0.02)


@pytest.mark.parametrize("full_engagement_share", [1.0, 0.3])
def test_a_contact_that_comes_and_goes_grows_as_in_the_simulation(full_engagement_share):
    contact = {"stiffness": 5e5, "damping": 20.0, "full_engagement_share": full_engagement_share}
    # shallow: a large steady deflection moves the place where a vanishing chip ends the contact
    depth = 0.2e-3
    cut = {
        "mode": "down", "radial_depth": 4e-3, "spindle_speed": 7000 * RPM, "axial_depth": depth,
    }  # fmt: skip
    model = model_of({"helix": math.radians(30.0)}, cut, TWO_MODES, contact=contact)
    point = np.array([7000 * RPM]), np.array([depth])
    found = abs(matrix_free.multipliers(stepped_cut(model, depth), *point)[0])
    (simulated,) = growths(model.case, model.structure.modes, *point)
    assert found == pytest.approx(simulated.radius, rel=1e-3)
    without = abs(matrix_free.multipliers(with_contact(model.cut(depth)), *point)[0])
    assert abs(without - found) > 0.1


def test_auto_takes_the_contact_along():
    model = model_of({}, SLOT, contact={"stiffness": 4e5})
    assert chosen_method(model.case).name == "matrix-free"
    assert chosen_method(model_of({}, SLOT).case).name == "collocation"
    assert any("only the matrix-free and time-domain methods" in note for note in model.notes)
