"""A bar of solid elements: its mass, statics and modes, reduced, and a carriage that travels on it.

Expected values are of beam theory, of the matrices before reduction, and of a reduction made anew
with points where the carriage stands.
"""

import numpy as np
import pytest
import scipy.linalg
import scipy.optimize

from dynamics.reduction.craig_bampton import super_element
from dynamics.reduction.imported_part import reduced_part
from dynamics.reduction.modal_truncation import undamped_modes
from dynamics.structure.assembly import assemble
from dynamics.structure.bodies import Body, Connector, rigid_motion
from dynamics.structure.imported import tied_structure
from dynamics.structure.linear_structure import LinearStructure, StructureError
from dynamics.structure.solid_elements import Material, boxes, solid_matrices
from dynamics.structure.surface_constraint import InterpolatedPoint, Nodes, RigidSurface

LENGTH, WIDTH, HEIGHT = 1.0, 0.04, 0.05
STEEL = Material(210e9, 0.0, 7850.0)  # no contraction, so that an end is clamped as beams are
AREA, SECOND = WIDTH * HEIGHT, WIDTH * HEIGHT**3 / 12.0
SHEARING = 5.0 / 6.0 * 0.5 * STEEL.modulus * AREA
RIGID_MASS = 12.0


def everywhere(x, y, z):
    return np.ones(np.shape(x), dtype=bool)


@pytest.fixture(scope="module")
def bar():
    """Nodes, and mass and stiffness, of the free bar along x, 20 elements."""
    pytest.importorskip("skfem")
    mesh = boxes(([0.0, LENGTH], [0.0, WIDTH], [0.0, HEIGHT]), everywhere, LENGTH / 20)
    coordinates, mass, stiffness = solid_matrices(mesh, STEEL)
    nodes = Nodes.in_order(np.arange(len(coordinates)) + 1, coordinates, coordinates.size)
    return nodes, LinearStructure(mass, 0 * mass, stiffness, {})


def section(nodes, x):
    """Numbers of the nodes of a cross-section."""
    return nodes.names[abs(nodes.coordinates[:, 0] - x) < 1e-6].tolist()


def with_points(bar, places):
    """The bar with its ends rigid, and cross-sections that points follow."""
    nodes, bare = bar
    ends = {"left": 0.0, "right": LENGTH}
    rigid = [RigidSurface(name, middle(x), section(nodes, x)) for name, x in ends.items()]
    followed = [InterpolatedPoint(f"p{k}", middle(x), section(nodes, x))
                for k, x in enumerate(places)]  # fmt: skip
    positions = {tie.name: tie.at for tie in (*rigid, *followed)}
    return tied_structure(bare, nodes, rigid, followed), positions


def middle(x):
    return (x, 0.5 * WIDTH, 0.5 * HEIGHT)


def test_mass_and_inertia_of_a_block(bar):
    nodes, bare = bar
    about = np.array(middle(0.5 * LENGTH))
    motion = np.vstack([rigid_motion(one - about)[:3] for one in nodes.coordinates])
    mass = STEEL.density * LENGTH * AREA
    square = np.square([LENGTH, WIDTH, HEIGHT])
    expected = mass * np.concatenate([np.ones(3), (square.sum() - square) / 12.0])
    np.testing.assert_allclose(motion.T @ (bare.mass @ motion), np.diag(expected), atol=1e-9)
    assert np.max(abs(bare.stiffness @ motion)) < 1e-9 * np.max(abs(bare.stiffness))


def test_two_materials():
    pytest.importorskip("skfem")
    mesh = boxes(([0.0, 0.1, 0.3], [0.0, 0.02], [0.0, 0.02]), everywhere, 0.05)
    light = Material(70e9, 0.0, 2700.0)
    coordinates, mass, stiffness = solid_matrices(mesh, light, (STEEL, lambda x, y, z: x < 0.1))
    along = np.tile([1.0, 0.0, 0.0], len(coordinates))
    assert along @ mass @ along == pytest.approx(4e-4 * (0.1 * 7850.0 + 0.2 * 2700.0))
    # pulled at its far end it stretches as two bars in a row
    at_end = abs(coordinates[:, 0] - 0.3) < 1e-9
    free = np.repeat(coordinates[:, 0] > 1e-9, 3)
    stretch = np.where(
        coordinates[:, 0] < 0.1,
        coordinates[:, 0] / 210e9,
        0.1 / 210e9 + (coordinates[:, 0] - 0.1) / 70e9,
    )
    motion = np.zeros(3 * len(coordinates))
    motion[::3] = stretch / 4e-4
    force = stiffness @ motion
    assert force[::3][at_end].sum() == pytest.approx(1.0, rel=1e-9)
    inside = free & ~np.repeat(at_end, 3)
    assert np.max(abs(force[inside])) < 1e-9


def test_cantilever_against_the_closed_form(bar):
    """Tip compliance l^3 / 3 E I + l / kappa G A; 1.875^2 / 2 pi sqrt(E I / rho A l^4)."""
    whole, positions = with_points(bar, [])
    reduced = super_element(whole, list(positions), 5e3)
    held = np.s_[6:]  # the left end's six freedoms are the first
    compliance = np.linalg.inv(reduced.stiffness[held, held])
    bending = STEEL.modulus * SECOND
    assert compliance[2, 2] == pytest.approx(
        LENGTH**3 / (3.0 * bending) + LENGTH / SHEARING, rel=1e-3
    )
    assert compliance[4, 4] == pytest.approx(LENGTH / bending, rel=1e-3)
    assert compliance[2, 4] == pytest.approx(-(LENGTH**2) / (2.0 * bending), rel=1e-3)
    assert compliance[0, 0] == pytest.approx(LENGTH / (STEEL.modulus * AREA), rel=1e-6)
    squared = scipy.linalg.eigh(
        reduced.stiffness[held, held], reduced.mass[held, held], eigvals_only=True
    )
    lower = 1.875104**2 / (2.0 * np.pi) * np.sqrt(
        STEEL.modulus * WIDTH**2 / (12.0 * STEEL.density * LENGTH**4)
    )  # fmt: skip
    # shear and rotary inertia take 0.2 % off the slender theory
    assert np.sqrt(squared[0]) / (2.0 * np.pi) == pytest.approx(lower, rel=3e-3)
    assert np.sqrt(squared[0]) / (2.0 * np.pi) < lower


def test_reduction_against_all_freedoms(bar):
    """Statics to rounding, free modes from above, their shapes by the modal assurance criterion."""
    whole, positions = with_points(bar, [0.25, 0.6])
    reduced = super_element(whole, list(positions), 6e3)
    rows, fewer = (np.vstack([one.points[name] for name in positions]) for one in (whole, reduced))
    # held at the left end by the same springs, loads at all points
    spring = 1e7 * whole.points["left"].T @ whole.points["left"]
    full = np.linalg.solve(whole.stiffness.toarray() + spring, rows.T)
    part = np.linalg.solve(
        reduced.stiffness + 1e7 * reduced.points["left"].T @ reduced.points["left"], fewer.T
    )
    compliance = rows @ full
    size = np.sqrt(np.outer(np.diag(compliance), np.diag(compliance)))
    assert np.max(abs(fewer @ part - compliance) / size) < 1e-7
    exact, found = (undamped_modes(one, count=16) for one in (whole, reduced))
    np.testing.assert_array_equal(found.frequency[:6], 0.0)
    ratio = found.frequency[6:] / exact.frequency[6:]
    assert np.all((ratio > 1.0 - 1e-9) & (ratio < 1.06)), ratio
    assert np.all(ratio[:4] < 1.001)
    shapes, others = rows @ exact.shapes[:, 6:12], fewer @ found.shapes[:, 6:12]
    product = np.einsum("nm,nm->m", shapes, others) ** 2
    assurance = product / (np.sum(shapes**2, axis=0) * np.sum(others**2, axis=0))
    assert np.min(assurance) > 0.9999


STATIONS = np.arange(0.1, 0.95, 0.2)
POSITIONS = (0.1, 0.15, 0.2, 0.45)


def carried(part, place):
    """Frequencies, Hz, of the bar on two hinges with a mass that stands on one block at a place."""
    carriage = Body("carriage", RIGID_MASS, 1e-3 * np.eye(3), middle(place))
    stiff, hinge = (1e11, 1e11, 1e11, 0.0, 0.0, 0.0), (1e11, 1e11, 1e11, 1e9, 0.0, 1e9)
    connectors = [
        Connector("block", "carriage", part.name, middle(place), stiff),
        Connector("left", part.name, "ground", middle(0.0), hinge),
        Connector("right", part.name, "ground", middle(LENGTH), hinge),
    ]
    structure = assemble([part, carriage], connectors, [], allowed_rigid_motions=3)
    return structure.natural_frequencies(8)[3:]


def simply_supported_with_mass(place):
    """First frequency, Hz, of Euler and Bernoulli's beam on two hinges with a mass on it.

    1 / m omega^2 = receptance of the bare beam at the place, by its modes sin(k pi x / l).
    """
    k = np.arange(1, 2000)
    line_mass = STEEL.density * AREA
    natural = (k * np.pi / LENGTH) ** 2 * np.sqrt(STEEL.modulus * SECOND / line_mass)
    shape = 2.0 / (line_mass * LENGTH) * np.sin(k * np.pi * place / LENGTH) ** 2

    def balance(omega):
        return 1.0 - RIGID_MASS * omega**2 * np.sum(shape / (natural**2 - omega**2))

    omega = scipy.optimize.brentq(balance, 1e-3 * natural[0], (1.0 - 1e-9) * natural[0])
    return omega / (2.0 * np.pi)


@pytest.fixture(scope="module")
def rail(bar):
    whole, positions = with_points(bar, STATIONS)
    names = [f"p{k}" for k in range(len(STATIONS))]
    return reduced_part("bar", whole, positions, [names], 6e3)


@pytest.mark.parametrize("place", POSITIONS)
def test_carriage_on_the_rail_against_beam_theory(rail, place):
    """Bending in the vertical plane; shear takes up to 0.6 % off."""
    found = carried(rail, place)
    exact = simply_supported_with_mass(place)
    assert np.min(abs(found / exact - 1.0)) < 8e-3


@pytest.mark.parametrize("place", POSITIONS)
def test_carriage_on_the_rail_against_a_new_reduction(bar, rail, place):
    whole, positions = with_points(bar, [place])
    anew = reduced_part("bar", whole, positions, (), 6e3)
    ratio = carried(rail, place) / carried(anew, place)
    # the rail between its stations is a constraint, which only stiffens
    assert np.all(ratio > 1.0 - 1e-4), ratio
    assert np.all(ratio[:2] < 1.003)
    assert np.all(ratio < 1.02)


def test_frequencies_along_the_rail_have_no_steps(rail):
    """Cubics with slopes: neither frequency nor its rate jumps where one span follows another."""
    station = STATIONS[2]
    step = 1e-4
    around = np.array([carried(rail, station + k * step)[0] for k in (-2, -1, 0, 1, 2)])
    rates = np.diff(around) / step
    assert np.max(abs(np.diff(rates))) < 2e-2 * np.max(abs(rates)) + 0.05


def test_a_stiffness_that_gives_energy_is_refused(bar):
    whole, positions = with_points(bar, [])
    turned = LinearStructure(whole.mass, whole.damping, -1.0 * whole.stiffness, whole.points)
    with pytest.raises(StructureError, match="stiffness is not positive"):
        super_element(turned, list(positions), 1e3)
