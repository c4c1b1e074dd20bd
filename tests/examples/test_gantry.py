"""The gantry of the examples: its finite elements, and what Moten et al. publish."""

import sys

import numpy as np
import pytest
import scipy.sparse.linalg

import chatter
from chatter.compile.machine_parts import assembled_machine, machine_parts
from chatter.engine.loop_stability import least_stable_motion
from dynamics.reduction.modal_truncation import undamped_modes
from dynamics.structure.linear_structure import LinearStructure
from tests.places import EXAMPLES, example_module

EXAMPLE = EXAMPLES / "machine-gantry"
ALUMINIUM, STEEL = 70e9, 210e9  # N/m^2


@pytest.fixture(scope="module")
def machine():
    return chatter.load_machine(EXAMPLE / "machine.toml")


@pytest.fixture(scope="module")
def run():
    return example_module("machine-gantry", "run")


@pytest.fixture(scope="module")
def identified(machine, run):
    """FRFs of figures 13 to 15 by the tests of the paper."""
    return run.frfs_to_tool(machine, run.LEFT)


@pytest.fixture(scope="module")
def drawing():
    pytest.importorskip("skfem")
    return example_module("machine-gantry", "gantry_parts")


def shipped(machine, name):
    """Imported part of the machine by name."""
    return next(one for one in machine_parts(machine).bodies if one.name == name)


def test_masses(machine):
    whole = assembled_machine(machine, {"X": "free", "Y": "free"})
    # receptance far below the first mode is that of the published masses and the motors' inertia
    lines = np.array([0.05])
    frequency = 2.0 * np.pi * lines[0]
    row = whole.structure.port("tcp", (1.0, 0.0, 0.0))
    moved = whole.structure.receptance(lines, row[None])[0, 0, 0]
    motors = 2.0 * 0.0008 / 0.005**2
    assert -1.0 / (moved.real * frequency**2) == pytest.approx(330.0 + motors, rel=2e-4)
    row = whole.structure.port("tcp", (0.0, 1.0, 0.0))
    moved = whole.structure.receptance(lines, row[None])[0, 0, 0]
    assert -1.0 / (moved.real * frequency**2) == pytest.approx(50.0, rel=2e-4)


def gantry_volumes():
    """Volumes of aluminium and steel of the gantry, m^3, by the drawing."""
    legs = 2 * (0.80 * 0.14 * 0.07 - 0.77 * 0.11 * 0.055)  # boxes with a top, open below
    legs += 2 * 2 * 0.020 * 0.11 * 0.055  # under the webs of the crossbeam
    hollow = 0.36 * (0.13 - 2 * 0.0102)
    crossbeam = 1.94 * (0.40 * 0.13 - hollow) + (5 * 0.012 + 4 * 0.015) * hollow
    steel = 2 * 1.0 * 0.14 * 0.04 + 1.44 * (2 * 0.025 * 0.025 + 0.10 * 0.015)
    return legs + crossbeam, steel


def test_mass_of_the_super_element_is_that_of_the_drawing(machine):
    gantry = shipped(machine, "gantry")
    aluminium, steel = gantry_volumes()
    lifted = gantry.rigid_motions[:, 2]
    mass = lifted @ gantry.mass_matrix @ lifted
    assert mass == pytest.approx(2700.0 * aluminium + 7850.0 * steel, rel=1e-6)


def test_the_crossbeam_bends_as_a_beam_of_its_section(machine):
    """Opposite moments at two places: the curvature between them is M over E I, without shear."""
    gantry = shipped(machine, "gantry").structure
    names = [f"rail_{number}" for number in (2, 3, 4, 5, 6)]
    moment = np.zeros(gantry.size)
    moment += 1e3 * (gantry.points["rail_1"][3] - gantry.points["rail_7"][3])
    # held softly: the moments balance, so that nothing is carried by what holds it
    motion = np.linalg.solve(gantry.stiffness + 1e-2 * gantry.mass, moment)
    height = np.array([gantry.points[name][2] @ motion for name in names])
    curvature = (height[1] - 2.0 * height[2] + height[3]) / 0.22**2
    # bottom flange, webs, top flange, strip, rails: area, centre along z, second moment of its own
    parts = [
        (ALUMINIUM, 0.40 * 0.0102, 0.1151, 0.40 * 0.0102**3 / 12),
        (ALUMINIUM, 2 * 0.020 * 0.1096, 0.175, 2 * 0.020 * 0.1096**3 / 12),
        (ALUMINIUM, 0.40 * 0.0102, 0.2349, 0.40 * 0.0102**3 / 12),
        (STEEL, 0.10 * 0.015, 0.2475, 0.10 * 0.015**3 / 12),
        (STEEL, 2 * 0.025**2, 0.2525, 2 * 0.025**4 / 12),
    ]
    centre = sum(e * a * z for e, a, z, _ in parts) / sum(e * a for e, a, _, _ in parts)
    rigidity = sum(e * (a * (z - centre) ** 2 + own) for e, a, z, own in parts)
    assert abs(curvature) == pytest.approx(1e3 / rigidity, rel=0.05)


def free_of_boundary(structure, name):
    """Structure with a point held, without the six freedoms of it."""
    kept = np.flatnonzero(~np.any(structure.points[name] != 0.0, axis=0))
    mass, stiffness = (
        part[kept][:, kept] if not isinstance(part, np.ndarray) else part[np.ix_(kept, kept)]
        for part in (structure.mass, structure.stiffness)
    )
    points = {one: row[:, kept] for one, row in structure.points.items() if one != name}
    return LinearStructure(mass, 0.0 * mass, stiffness, points)


def test_the_shipped_bracket_is_its_full_mesh(machine, drawing):
    full = free_of_boundary(drawing.bracket().structure, "root")
    reduced = free_of_boundary(shipped(machine, "bracket").structure, "root")
    whole, few = (undamped_modes(one, count=3).frequency for one in (full, reduced))
    assert np.all(few >= whole * (1.0 - 1e-9))
    assert few == pytest.approx(whole, rel=5e-3)
    row = full.points["grip"]
    moved = scipy.sparse.linalg.spsolve(full.stiffness.tocsc(), row.T)
    exact = row @ moved
    row = reduced.points["grip"]
    assert row @ np.linalg.solve(reduced.stiffness, row.T) == pytest.approx(
        exact, rel=1e-6, abs=1e-9 * np.max(np.abs(exact))
    )


def test_the_bracket_bends_as_a_plate_clamped_at_its_root(machine):
    """Tool on a cantilever from the flange to the grip: Timoshenko, between soft and stiff ends."""
    bracket = free_of_boundary(shipped(machine, "bracket").structure, "root")
    row = bracket.points["grip"][0]
    stiffness = 1.0 / (row @ np.linalg.solve(bracket.stiffness, row))
    inertia, area = 0.16 * 0.0156**3 / 12.0, 0.16 * 0.0156

    def cantilever(length):
        bending = length**3 / (3.0 * ALUMINIUM * inertia)
        return 1.0 / (bending + length / (5.0 / 6.0 * ALUMINIUM / 2.66 * area))

    # below the flange 180 mm to the end, of which the tool grips 50 mm
    assert cantilever(0.180) < stiffness < cantilever(0.130)


def test_bracket_and_bending_are_the_published_ones(machine, run, drawing, monkeypatch):
    assert run.clamped_bracket(machine) == pytest.approx(182.0, abs=0.2)
    monkeypatch.setitem(sys.modules, "gantry_parts", drawing)
    calibrate = example_module("machine-gantry", "calibrate")
    assert calibrate.bracket_frequencies(machine)[0] == pytest.approx(182.0, abs=0.2)
    assert calibrate.bending_frequency(machine) == pytest.approx(98.0, abs=0.2)
    assert calibrate.bending_frequency(machine, run.LEFT) == pytest.approx(112.0, rel=0.05)


@pytest.mark.parametrize(
    ("axis", "way", "head", "bending"),
    [("X", "x", "middle", 98.0), ("X", "x", "left", 109.0), ("Y", "y", "middle", 98.0)],
)
def test_bending_has_no_peak_in_x_and_y(run, identified, axis, way, head, bending):
    assert run.peaks_between(identified["X", "z", head], 95.0, 115.0) != "none"
    frf = identified[axis, way, head]
    assert run.peaks_between(frf, 0.9 * bending, 1.1 * bending) == "none"


@pytest.mark.parametrize("head", ["middle", "left"])
def test_nothing_but_the_bracket_shows_in_x_as_identified(run, identified, head):
    """Figure 13. With its loops open the gantry has a mode of yaw at 59 Hz, not seen there."""
    assert run.peaks_between(identified["X", "x", head], 20.0, 150.0) == "none"


def test_linearised_as_identified_where_the_motors_turn_against_yaw(machine, run):
    """By simulation in time, the head at the left: 8 % apart with both motors' loops open."""
    at_left = run.detuned(machine).patch({"frf.x_tcp.position": {"Y": run.LEFT}})
    assert run.usual_difference(chatter.frf(at_left, ["x_tcp"]), "x_tcp") < 0.005


def test_a_mass_alone_is_its_line(run):
    lines = np.linspace(10.0, 200.0, 1901)
    mass_alone = -1.0 / (50.0 * (2.0 * np.pi * lines) ** 2)
    assert run.over_mass_line(run.Frf(lines, mass_alone, "receptance")) == pytest.approx(1.0)


def test_y_is_the_line_of_the_head_up_to_100_hz(machine, run):
    """Section 3.3 of the paper; the line is that of its 50 kg."""
    tested = chatter.frf(run.detuned(machine), ["y_motor", "y_tcp"])
    assert run.over_mass_line(tested["y_tcp"].tested) == pytest.approx(1.0, rel=0.06)
    assert run.over_mass_line(tested["y_motor"].tested) == pytest.approx(1.0, rel=0.2)


def test_the_bracket_shows_in_x(run, identified):
    assert run.peak_near(identified["X", "x", "middle"], 185.0) == pytest.approx(185.0, rel=0.06)


def test_the_time_optimal_square_is_off_as_published(machine):
    assert least_stable_motion(assembled_machine(machine), machine.step).stable
    move = chatter.move(machine, "planned")
    assert np.max(np.abs(move.contour)) == pytest.approx(30e-6, rel=0.15)
