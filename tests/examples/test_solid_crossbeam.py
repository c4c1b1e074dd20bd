"""Solid elements of the crossbeam example against beam theory, and its reduction against itself."""

import numpy as np
import pytest
import scipy.linalg
import scipy.optimize
import scipy.sparse
import scipy.sparse.linalg

import chatter
from dynamics.reduction.craig_bampton import super_element
from dynamics.reduction.modal_truncation import undamped_modes
from dynamics.structure.bodies import rigid_motion
from dynamics.structure.linear_structure import LinearStructure
from tests.places import EXAMPLES, example_module

STATIONS = 1
HIGHEST = 6000.0  # Hz, of the fixed-interface modes here


@pytest.fixture(scope="module")
def solid():
    pytest.importorskip("skfem")
    return example_module("solid-crossbeam", "crossbeam")


@pytest.fixture(scope="module")
def machine():
    return example_module("solid-crossbeam", "run")


# -- a slender bar -----------------------------------------------------------------------------

LENGTH, SIDE = 1.0, 0.025
FREE_FREE = np.array([4.730040744862704, 7.853204624095503, 10.995607838001671])


def solid_bar(solid, along, across=1):
    """First three pairs of bending frequencies of a square bar, Hz."""
    lines = ([0.0, LENGTH], [0.0, SIDE], [0.0, SIDE])
    mesh = solid.MeshHex.init_tensor(
        *(
            np.linspace(*line, count + 1)
            for line, count in zip(lines, (along, across, across), strict=True)
        )
    )
    _, mass, stiffness = solid.solid_matrices(mesh, solid.STEEL)
    structure = LinearStructure(mass, 0 * mass, stiffness, {})
    frequency = undamped_modes(structure, count=12).frequency
    np.testing.assert_array_equal(frequency[:6], 0.0)
    return frequency[6:12].reshape(3, 2)


def euler_bernoulli(material):
    slenderness = FREE_FREE**2 / (2.0 * np.pi * LENGTH**2)
    return slenderness * np.sqrt(material.modulus * SIDE**2 / (12.0 * material.density))


def timoshenko(material):
    """Free-free frequencies from the exact solution of the beam's equations over its length."""
    area, inertia = SIDE**2, SIDE**4 / 12.0
    bending = material.modulus * inertia
    cowper = 10.0 * (1.0 + material.poisson) / (12.0 + 11.0 * material.poisson)
    shearing = cowper * material.modulus / (2.0 * (1.0 + material.poisson)) * area

    def free_end(frequency):
        omega2 = (2.0 * np.pi * frequency) ** 2
        # deflection, rotation, moment, shear force
        slope = np.array(
            [
                [0.0, 1.0, 0.0, 1.0 / shearing],
                [0.0, 0.0, 1.0 / bending, 0.0],
                [0.0, -material.density * inertia * omega2, 0.0, -1.0],
                [-material.density * area * omega2, 0.0, 0.0, 0.0],
            ]
        )
        return np.linalg.det(scipy.linalg.expm(slope * LENGTH)[2:, :2])

    return np.array(
        [
            scipy.optimize.brentq(free_end, 0.95 * near, 1.001 * near)
            for near in euler_bernoulli(material)
        ]
    )


def test_slender_bar_has_the_frequencies_of_a_beam(solid):
    found = solid_bar(solid, 40, 2)
    np.testing.assert_allclose(found[:, 0], found[:, 1], rtol=1e-6)
    np.testing.assert_allclose(found[:2, 0], euler_bernoulli(solid.STEEL)[:2], rtol=0.01)
    np.testing.assert_allclose(found[:, 0], timoshenko(solid.STEEL), rtol=1e-3)


def test_refinement_converges_from_above(solid):
    finest = solid_bar(solid, 80)[:, 0]
    errors = [solid_bar(solid, along)[:, 0] / finest - 1.0 for along in (10, 20, 40)]
    assert np.all(np.array(errors) > 0.0)
    # quadratic elements: energy, and so the frequency, is in error by h^4 (16 a halving)
    first, second = errors[0] / errors[1], errors[1] / errors[2]
    assert np.all(first > 8.0)
    np.testing.assert_allclose(second, 16.0, rtol=0.2)


# -- a short crossbeam -------------------------------------------------------------------------


@pytest.fixture(scope="module")
def matrices(solid):
    return solid.solid_matrices(solid.crossbeam_mesh(STATIONS), solid.STEEL)


@pytest.fixture(scope="module")
def tied(solid, matrices, tmp_path_factory):
    """Structure read back from files, and where its points are."""
    folder = tmp_path_factory.mktemp("solid")
    solid.write_model(folder, *matrices)
    return solid.tied_crossbeam(folder, STATIONS)


@pytest.fixture(scope="module")
def reduced(solid, tied):
    structure, places = tied
    return super_element(structure, list(places), HIGHEST)


def crossbeam_volume(stations):
    """Box, its two flanges, ribs with a window and rails, from the drawing; m^3."""
    length = 0.25 * (stations + 2)
    inner = length - 2 * 0.025
    section = 0.25 * 0.30 - 0.22 * 0.27
    rib = 0.22 * 0.27 - 0.11 * 0.18
    flange = (0.25 + 0.12) * (0.30 + 0.12) * 0.025
    return inner * (section + 2 * 0.03 * 0.03) + (stations + 1) * 0.012 * rib + 2 * flange


def rigid_motions(coordinates):
    return np.vstack([rigid_motion(place)[:3] for place in coordinates])


def test_mass_is_density_times_volume(solid, matrices):
    coordinates, mass, _ = matrices
    inertia = rigid_motions(coordinates).T @ (mass @ rigid_motions(coordinates))
    expected = solid.STEEL.density * crossbeam_volume(STATIONS)
    np.testing.assert_allclose(inertia[:3, :3], expected * np.eye(3), atol=1e-9 * expected)
    # the beam is the same from both ends: its centre of gravity is at half its length
    assert inertia[2, 4] == pytest.approx(-0.5 * 0.25 * (STATIONS + 2) * expected, rel=1e-9)


def test_rigid_motion_strains_nothing(matrices):
    coordinates, _, stiffness = matrices
    forces = stiffness @ rigid_motions(coordinates)
    assert np.max(abs(forces)) < 1e-10 * np.max(abs(stiffness))


def test_uniform_stretch_has_the_energy_of_hooke(solid, matrices):
    # x stretched, across contracting freely: stress E times strain, all over the volume
    coordinates, _, stiffness = matrices
    material = solid.STEEL
    strain = 1e-4 * np.array([1.0, -material.poisson, -material.poisson])
    motion = (coordinates * strain).ravel()
    energy = 0.5 * motion @ (stiffness @ motion)
    expected = 0.5 * material.modulus * 1e-8 * crossbeam_volume(STATIONS)
    assert energy == pytest.approx(expected, rel=1e-9)


def test_six_rigid_body_modes_and_points_that_follow(tied):
    structure, places = tied
    frequency, shapes = undamped_modes(structure, count=8)
    np.testing.assert_array_equal(frequency[:6], 0.0)
    assert frequency[6] > 100.0
    # points move with the six rigid-body modes as places of one rigid body
    first = next(iter(places))
    for name, place in places.items():
        moved = rigid_motion(place - places[first]) @ structure.points[first] @ shapes[:, :6]
        np.testing.assert_allclose(structure.points[name] @ shapes[:, :6], moved, atol=1e-5)


def held_at_the_left(whole):
    """Mass, stiffness and all points without the six freedoms of the left end."""
    ends = whole.points["left"]
    free = np.flatnonzero(~np.any(ends != 0.0, axis=0))
    assert len(free) == whole.size - 6
    mass, stiffness = (
        part[free][:, free] if scipy.sparse.issparse(part) else part[np.ix_(free, free)]
        for part in (whole.mass, whole.stiffness)
    )
    points = {name: row[:, free] for name, row in whole.points.items() if name != "left"}
    return LinearStructure(mass, 0.0 * mass, stiffness, points)


def with_modes_up_to(element, boundary, highest):
    """Super-element with fewer modes: these are its last coordinates, and independent."""
    squared = np.diag(element.stiffness)
    kept = np.flatnonzero((np.arange(element.size) < boundary) | (squared < highest))
    mass, stiffness = (part[np.ix_(kept, kept)] for part in (element.mass, element.stiffness))
    points = {name: row[:, kept] for name, row in element.points.items()}
    return LinearStructure(mass, 0.0 * mass, stiffness, points)


def test_reduced_frequencies_are_close_from_above(tied, reduced):
    structure, places = tied
    assert reduced.size < 0.02 * structure.size
    whole = undamped_modes(held_at_the_left(structure), count=10).frequency
    fewer = with_modes_up_to(reduced, 6 * len(places), (2.0 * np.pi * 0.5 * HIGHEST) ** 2)
    assert fewer.size < reduced.size
    error, coarser = (
        undamped_modes(held_at_the_left(one)).frequency[:10] / whole - 1.0
        for one in (reduced, fewer)
    )
    assert np.all(error > 0.0)
    assert np.all(error <= coarser)
    assert np.sum(whole < 0.1 * HIGHEST) == 2
    assert np.all(error[whole < 0.1 * HIGHEST] < 5e-4)
    assert np.all(error[whole < 0.25 * HIGHEST] < 2e-3)


def test_static_compliance_is_exact(tied, reduced):
    structure, reference = (held_at_the_left(one) for one in (reduced, tied[0]))
    rows = np.vstack(list(reference.points.values()))
    moved = scipy.sparse.linalg.spsolve(
        scipy.sparse.csc_array(reference.stiffness), scipy.sparse.csc_array(rows.T)
    )
    exact = rows @ moved
    rows = np.vstack(list(structure.points.values()))
    found = rows @ np.linalg.solve(structure.stiffness, rows.T)
    scale = np.sqrt(np.outer(np.diag(exact), np.diag(exact)))
    np.testing.assert_allclose(found / scale, exact / scale, atol=1e-7)


def test_super_element_is_read_as_written(solid, machine, reduced, tied, tmp_path, monkeypatch):
    _, places = tied
    solid.write_super_element(tmp_path, reduced, places)
    monkeypatch.setattr(machine, "SUPER_ELEMENT", tmp_path)
    beam, found = machine.crossbeam()
    assert list(found) == list(places)
    # a response above the rigid-body modes tells the mass and the stiffness
    for name in places:
        np.testing.assert_allclose(found[name], places[name], atol=1e-9)
        motion = [
            np.linalg.solve(one.stiffness - 1e6 * one.mass, one.points[name].T)
            for one in (beam, reduced)
        ]
        there, here = (
            one.points["left"] @ x for one, x in zip((beam, reduced), motion, strict=True)
        )
        np.testing.assert_allclose(there, here, rtol=1e-6, atol=1e-9 * np.max(abs(here)))


# -- what is shipped, without solid elements ---------------------------------------------------


def test_shipped_super_element_has_the_mass_and_freedom_of_the_drawing(machine):
    beam, places = machine.crossbeam()
    motion = np.zeros((beam.size, 6))
    for name, place in places.items():
        motion += beam.points[name].T @ rigid_motion(place)
    inertia = motion.T @ beam.mass @ motion
    expected = 7850.0 * crossbeam_volume(6)
    np.testing.assert_allclose(inertia[:3, :3], expected * np.eye(3), atol=1e-6 * expected)
    assert np.max(abs(beam.stiffness @ motion)) < 1e-9 * np.max(abs(beam.stiffness))
    assert np.sum(undamped_modes(beam).frequency == 0.0) == 6


def test_head_in_the_middle_is_the_most_compliant(machine):
    static = {}
    for position, numbers in machine.POSITIONS.items():
        structure = machine.machine(numbers)
        assert structure.natural_frequencies(1)[0] > 10.0
        row = structure.port("head.tool", (0.0, 1.0, 0.0))
        static[position] = row @ np.linalg.solve(structure.stiffness, row)
    assert static["in the middle"] > 1.02 * static["at the left"]


def test_positions_that_mirror_each_other_are_alike(machine):
    left, right = (machine.machine(numbers).natural_frequencies(20) for numbers in ((1, 2), (5, 6)))
    np.testing.assert_allclose(left, right, rtol=1e-5)


def test_example_draws_its_picture(machine, tmp_path):
    assert all(path.stat().st_size > 10_000 for path in machine.main(tmp_path))


# -- the machine of machine.toml -----------------------------------------------------------------

FOLDER = EXAMPLES / "solid-crossbeam"


@pytest.mark.nightly
def test_slot_along_the_beam_keeps_its_energy():
    """The head travels 30 mm along the rails in the cut, under control, friction and chips."""
    case = chatter.load(FOLDER / "case.toml")
    result = chatter.simulate(
        case, {"simulation.duration": "0.25 s", "structure.settling": "0.3 s"}
    )
    energy = result.energy
    balance = energy["work"] + energy["travel"] - energy["dissipated"] - energy["stored"]
    assert abs(balance) < 1e-3 * energy["dissipated"]
    assert abs(energy["travel"]) > abs(balance)
    assert any(note.startswith("the structure changes as the axes travel") for note in result.notes)
    still = chatter.simulate(
        case,
        {
            "simulation.duration": "0.25 s",
            "structure.settling": "0.3 s",
            "structure.travel_positions": 1,
        },
    )
    assert still.energy == {}
    # over such a distance the beam hardly changes
    assert result.summary()["mean_force_N"]["Fy"] == pytest.approx(
        still.summary()["mean_force_N"]["Fy"], rel=1e-4
    )


def test_torque_at_the_motor_of_an_axis_that_moves():
    """The response with the loop open is that of sliding friction, as its loop moves the axis."""
    file = chatter.load_machine(FOLDER / "machine.toml").patch({"frf.motor_right.averages": 1})
    curve = chatter.frf(file, ["motor_right"])["motor_right"]
    lines = curve.tested.frequency
    linear = np.interp(lines, curve.harmonic.frequency, np.abs(curve.harmonic.values))
    apart = np.abs(np.abs(curve.tested.values) / linear - 1.0)
    assert np.median(apart) < 0.01
    resting = chatter.frf(
        file.patch({"frf.motor_right.moving": {}, "frf.motor_right.by": "linearised"}),
        ["motor_right"],
    )["motor_right"].harmonic
    stuck = np.interp(lines, resting.frequency, np.abs(resting.values))
    assert np.median(np.abs(stuck / linear - 1.0)) > 0.05


def test_frequencies_along_the_beam_between_its_points():
    """The head stands between points of the rails; the solid beam is softer than the tube."""
    travel = example_module("solid-crossbeam", "travel")
    file = chatter.load_machine(FOLDER / "machine.toml")
    middle, right = (travel.frequencies(file, place) for place in (0.0, 0.45))
    assert right[3] > 1.02 * middle[3]  # nodding on the twisting beam
    mirrored = travel.frequencies(file, -0.45)
    # the screw is longer at the right, the beam is symmetric
    assert mirrored[:3] == pytest.approx(right[:3], rel=0.01)
