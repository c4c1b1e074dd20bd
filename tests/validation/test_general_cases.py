"""Collocation against random cases of any tool, solved by the independent reference."""

import math
from dataclasses import replace

import numpy as np
import pytest

from chatter.description.case import Case
from chatter.engine import parallel as sweep
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.methods.collocation.multipliers import converged_multiplier, multipliers
from chatter.stability.model import milling_model
from cutting.edge_segments.segments import period_angle
from tests.validation.reference import dense_cases, setting_cases
from tests.validation.reference.general_cases import STORE, load
from tests.validation.reference.general_cut import GeneralCut, spectral_radius
from tests.validation.reference.setting_cases import case_dict

CASES = load()
#: drawn with another seed when the code stood; four of them showed faults of the edge pieces
#: (corners, first contact within an edge, flutes of different helix with runout) that were mended
UNSEEN = load(STORE.with_name("general_cases_unseen.json"))
#: three to seven features at once in each
DENSE = load(dense_cases.STORE)
#: axial errors of teeth on corners and cones; serrated edges
SETTINGS = load(setting_cases.STORE)
RPM = math.pi / 30.0
X = ((922.0, 0.011, 0.03993, (1.0, 0.0, 0.0)),)


def over_the_period_of_the_reference(model, cut, radius):
    """The reference counts from turn to turn, the product from tooth to like tooth."""
    repeats = 1 if cut.variation else round(2.0 * math.pi / period_angle(model.cutter))
    return radius**repeats


def test_the_store_is_what_the_reference_gives():
    plain = [
        (cut, stored)
        for cut, stored in CASES
        if not cut.corner_radius and not any(cut.helix) and not cut.variation
    ]
    for cut, stored in plain[:3]:
        assert spectral_radius(cut, nodes=8) == pytest.approx(stored, rel=1e-4)


@pytest.mark.parametrize(
    ("cut", "periods", "expected"),
    [
        # validation 2.2, 4 and 3.3: even teeth, unequal pitch, flutes of different helix
        (
            GeneralCut(
                16e-3, (math.pi,) * 2, (0.0,) * 2, "up", 1.6e-3, (6e8, 2e8, 0.0), X,
                10000 * RPM, 2e-3,
            ),
            2, pytest.approx(1.1773892490, rel=1e-8),
        ),
        (
            GeneralCut(
                16e-3, (math.pi,) * 2, (math.radians(30.0), math.radians(45.0)), "down", 0.8e-3,
                (6e8, 2e8, 0.0), X, 15000 * RPM, 3e-3,
            ),
            1, pytest.approx(0.4701, rel=1e-2),
        ),
    ],
)  # fmt: skip
def test_the_reference_meets_published_values(cut, periods, expected):
    assert spectral_radius(cut) ** (1.0 / periods) == expected


def test_the_cases_are_varied():
    cuts = [cut for cut, _ in CASES]
    radii = np.array([radius for _, radius in CASES])
    assert len(cuts) >= 40
    assert np.sum(radii > 1.0) > 8
    assert np.sum(radii < 1.0) > 8
    assert sum(np.ptp(cut.pitch) > 0.0 for cut in cuts) > 10
    assert sum(len(set(cut.helix)) > 1 for cut in cuts) > 5
    assert sum(cut.corner_radius > 0.0 for cut in cuts) > 4
    assert sum(cut.edge_angle < 1.57 for cut in cuts) > 4
    assert sum(bool(cut.offsets) for cut in cuts) > 10
    assert sum(cut.exponent < 1.0 for cut in cuts) > 5
    assert sum(cut.process_damping > 0.0 for cut in cuts) > 5
    assert sum(cut.variation is not None for cut in cuts) > 2


def test_many_features_act_at_once_in_the_dense_cases():
    present = [set(dense_cases.features(cut)) for cut, _ in DENSE]
    assert len(present) >= 50
    assert min(map(len, present)) >= 3
    assert sum(len(there) >= 5 for there in present) > 8
    for name, at_least in {
        "corner": 25, "cone": 8, "pitch": 25, "helices": 20, "runout": 25, "exponent": 12,
        "damping": 15, "variation": 5,
    }.items():  # fmt: skip
        assert sum(name in there for there in present) >= at_least, name
    assert sum({"corner", "runout", "exponent"} <= there for there in present) >= 3
    assert sum({"corner", "cone"} <= there for there in present) >= 3


def test_the_settings_are_varied():
    cuts = [cut for cut, _ in SETTINGS]
    axial = [cut for cut in cuts if cut.axial]
    assert len(axial) >= 12
    assert sum(bool(cut.offsets) for cut in axial) > 4
    assert sum(cut.corner_radius > 0.0 for cut in axial) > 4
    assert sum(max(cut.axial) - min(cut.axial) > cut.feed for cut in axial) > 3
    waved = [cut for cut in cuts if cut.serration]
    assert len(waved) >= 20
    # from waves that every tooth cuts to those of which a tooth takes only the crest
    heights = [cut.serration[0] / cut.feed / cut.teeth for cut in waved]
    assert min(heights) < 0.15
    assert sum(height > 1.5 for height in heights) > 5
    assert sum(cut.exponent < 1.0 for cut in waved) >= 1


def shallow(**changes):
    """A cut of three teeth near its limit."""
    cut = GeneralCut(
        12e-3, (2.0 * math.pi / 3.0,) * 3, (0.5,) * 3, "down", 4e-3, (8e8, 3e8, 1e8), X,
        7000 * RPM, 2e-3,
    )  # fmt: skip
    return replace(cut, **changes)


def product_radius(cut):
    """Spectral radius over a turn by the product."""
    model = milling_model(Case.from_dict(case_dict(cut)))
    radius = abs(
        multipliers(element_cut(model, cut.depth, 12, 0.3), *np.array([[cut.speed], [cut.depth]]))
    )
    return over_the_period_of_the_reference(model, cut, radius[0])


@pytest.mark.parametrize(
    ("one", "other"),
    [
        # along the normal of a cone, 60 degrees, an axial error counts cos 60, a radial one sin 60
        (
            shallow(edge_angle=math.pi / 3.0, axial=(6e-5, -3e-5, 0.0)),
            shallow(
                edge_angle=math.pi / 3.0,
                offsets=(6e-5 / math.sqrt(3.0), -3e-5 / math.sqrt(3.0), 0.0),
            ),
        ),
        # a tool that is moved as a whole is the same tool
        (shallow(corner_radius=3e-3, axial=(5e-5,) * 3), shallow(corner_radius=3e-3)),
    ],
    ids=["cone", "moved"],
)  # fmt: skip
def test_setting_errors_that_are_the_same(one, other):
    expected = spectral_radius(other)
    assert spectral_radius(one) == pytest.approx(expected, rel=2e-6)
    assert product_radius(one) == pytest.approx(expected, rel=2e-5)


def test_teeth_on_waves_far_longer_than_the_edge_have_each_its_own_radius():
    heights = tuple(-5e-5 * (1.0 - math.cos(math.tau * tooth / 3.0)) for tooth in range(3))
    own = spectral_radius(shallow(offsets=heights))
    assert own != pytest.approx(spectral_radius(shallow()), rel=0.05)
    assert spectral_radius(shallow(serration=(1e-4, 1e3))) == pytest.approx(own, rel=1e-5)
    # the longest wave that a case may have still rises along the edge
    assert product_radius(shallow(serration=(1e-4, 2.0))) == pytest.approx(own, rel=3e-3)


@pytest.mark.parametrize(
    "cases", [CASES, UNSEEN, DENSE, SETTINGS], ids=["seen", "unseen", "dense", "settings"]
)
def test_spectral_radius_of_random_cases_of_any_tool(cases):
    errors = []
    for cut, expected in cases:
        model = milling_model(Case.from_dict(case_dict(cut)))
        found = converged_multiplier(
            lambda points, waves, model=model, depth=cut.depth: element_cut(
                model, depth, points, waves
            ),
            cut.speed,
            cut.depth,
        )
        radius = over_the_period_of_the_reference(model, cut, abs(found.value))
        errors.append(abs(radius - expected) / max(1.0, expected))
    assert max(errors) < 1e-4


def test_the_same_bytes_whatever_the_number_of_threads(monkeypatch):
    cut, _ = next((cut, r) for cut, r in CASES if len(set(cut.helix)) > 1 and not cut.variation)
    arrays = element_cut(milling_model(Case.from_dict(case_dict(cut))), cut.depth)
    speeds = np.linspace(0.8, 1.2, 97) * cut.speed
    depths = np.full(speeds.size, cut.depth)
    found = []
    for workers in (1, 2, 5):
        monkeypatch.setattr(sweep, "worker_count", lambda workers=workers: workers)
        found.append(multipliers(arrays, speeds, depths).tobytes())
    assert len(set(found)) == 1


def test_spectral_convergence():
    """The logarithm of the error falls in proportion to the number of points."""
    cut = GeneralCut(
        16e-3, (math.pi,) * 2, (0.0,) * 2, "down", 8e-3, (6e8, 2e8, 0.0), X, 5000 * RPM, 1e-3
    )
    model = milling_model(Case.from_dict(case_dict(cut)))
    point = np.array([cut.speed]), np.array([cut.depth])
    orders = (4, 6, 8, 10, 12)
    radii = [abs(multipliers(element_cut(model, cut.depth, p, 1.0), *point)[0]) for p in orders]
    exact = spectral_radius(cut, nodes=14, waves=0.4) ** 0.5
    errors = np.abs(np.array(radii) - exact)
    # every two points more bring a factor of ten and more, down to rounding
    assert np.all((errors[1:] < 0.1 * errors[:-1]) | (errors[1:] < 1e-9))
    assert errors[-1] < 1e-9
