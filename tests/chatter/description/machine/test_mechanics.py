"""Machines from files against hand calculation and against assemblies made by hand."""

import math

import numpy as np
import pytest
import scipy.linalg

from chatter import InputError
from chatter.compile.machine_parts import assembled_machine, machine_parts
from chatter.description.machine.machine_file import MachineFile
from dynamics.beam.shaft import BeamLine, Bearing, Material, Segment
from dynamics.reduction.modal_truncation import damping_ratios, undamped_modes
from dynamics.structure.assembly import assemble
from dynamics.structure.bodies import Body, Connector, Point

TABLE, BED, ROTOR = 300.0, 2000.0, 0.006
FEET, TRAVEL = 40e6, 0.01 / (2.0 * math.pi)
#: nut and bearing in a row
SCREW = 1.0 / (1.0 / 250e6 + 1.0 / 400e6)


def by_hand(brake=0.0):
    """Frequencies, Hz, of table, bed and rotor along one line."""
    mass = np.diag([TABLE, BED, ROTOR])
    stretch = np.array([1.0, -1.0, -TRAVEL])
    stiffness = SCREW * np.outer(stretch, stretch) + np.diag([0.0, FEET, brake])
    squared = scipy.linalg.eigh(stiffness, mass, eigvals_only=True)
    return np.sqrt(np.maximum(squared, 0.0)) / (2.0 * np.pi)


def along_y(machine):
    """Frequencies, Hz, of modes in which the table or the motor moves along the line."""
    structure = machine.structure
    squared, shapes = scipy.linalg.eigh(structure.stiffness, structure.mass)
    moving = abs(structure.port("table", (0, 1, 0)) @ shapes) * math.sqrt(TABLE) > 1e-3
    moving |= abs(shapes[-1]) * math.sqrt(ROTOR) > 1e-3
    return np.sqrt(np.maximum(squared[moving], 0.0)) / (2.0 * np.pi)


@pytest.mark.parametrize("condition", ["free", "control", "brake"])
def test_two_bodies_and_a_screw(line_text, condition):
    machine = assembled_machine(MachineFile.from_text(line_text), {"Y": condition})
    expected = by_hand(1e5 if condition == "brake" else 0.0)
    found = along_y(machine)
    assert len(found) == 3
    # the free axis has rounding of 0
    assert found == pytest.approx(expected, rel=1e-5, abs=1e-3)
    assert len(machine.drives) == (condition == "control")


def test_brake_is_the_default_of_nothing(line_text):
    file = MachineFile.from_text(line_text)
    assert [drive.name for drive in assembled_machine(file).drives] == ["Y"]
    assert assembled_machine(file.patch({"axis.Y.control": None})).drives == ()


def test_contact_in_cut_stiffens_tool_against_table(line_text):
    file = MachineFile.from_text(line_text)
    away, in_cut = (
        assembled_machine(file, {"Y": "brake"}, in_cut=cut).structure for cut in (False, True)
    )
    port = away.port("tool", (0, 1, 0), "table")
    frequency = 30.0
    stiffness = [1.0 / one.receptance(frequency, port)[0, 0, 0] for one in (away, in_cut)]
    contact = 2.5e6 + 2j * np.pi * frequency * 3350.0
    assert stiffness[1] - stiffness[0] == pytest.approx(contact, rel=1e-6)
    across = away.port("tool", (1, 0, 0), "table")
    assert in_cut.receptance(frequency, across) == pytest.approx(
        away.receptance(frequency, across), rel=1e-6
    )


def test_damping_ratio_of_every_elastic_mode(line_text):
    patch = {"damping_ratio": 0.03, "axis.Y.brake.damping": "0"}
    file = MachineFile.from_text(line_text).patch(patch)
    structure = assembled_machine(file, {"Y": "brake"}).structure
    squared, shapes = scipy.linalg.eigh(structure.stiffness, structure.mass)
    ratio = np.diag(shapes.T @ structure.damping @ shapes) / (2.0 * np.sqrt(squared))
    assert ratio == pytest.approx(0.03, rel=1e-6)


def head_by_hand(position):
    """The same machine with its coordinates moved by hand, m."""
    steel = Material(206e9, 7850.0, 0.3)
    bearings = [
        Bearing("left", 0.0, (200e6, 200e6), 100e6, (1e5, 1e5), 1e6),
        Bearing("right", 1.0, (200e6, 150e6), 0.0, (1e5, 2e5)),
    ]
    beam = BeamLine("crossbeam", [Segment(1.0, 0.09, steel, elements=8)], (0, 0, 0), (1, 0, 0),
                    bearings=bearings)  # fmt: skip
    inertia = 50.0 / 12.0 * np.array([0.2**2 + 0.4**2, 0.3**2 + 0.4**2, 0.3**2 + 0.2**2])
    guide = [
        Connector(f"carriage{x}", "head", "crossbeam", (x + position, 0.0, 0.0),
                  (80e6, 300e6, 300e6, 1e6, 0.0, 0.0))
        for x in (0.45, 0.55)
    ]  # fmt: skip
    return assemble(
        [Body("head", 50.0, inertia, (0.5 + position, 0.0, -0.1))],
        guide,
        [Point("tool", "head", (0.5 + position, 0.0, -0.35))],
        [beam],
    )


@pytest.mark.parametrize("position", [0.0, -0.3, 0.12])
def test_a_head_that_moves_along_a_beam(head_on_beam, position):
    file = MachineFile.from_dict(head_on_beam)
    expected = head_by_hand(position)
    frequencies = expected.natural_frequencies(12)
    for machine in (
        assembled_machine(file, positions={"X": f"{position * 1e3} mm"}),
        assembled_machine(file.patch({"axis.X.position": position})),
    ):
        assert machine.structure.natural_frequencies(12) == pytest.approx(frequencies, rel=1e-9)
        ports = [one.port("tool", (0, 1, 0)) for one in (expected, machine.structure)]
        assert machine.structure.receptance(37.0, ports[1]) == pytest.approx(
            expected.receptance(37.0, ports[0]), rel=1e-9
        )


def test_the_head_is_softest_in_the_middle(head_on_beam):
    file = MachineFile.from_dict(head_on_beam)
    middle, left = (assembled_machine(file, positions={"X": x}).structure for x in (0.0, "-300 mm"))
    assert middle.natural_frequencies(1)[0] < 0.95 * left.natural_frequencies(1)[0]


def test_axes_on_axes_shift_together(head_on_beam):
    head_on_beam["body"]["leg"] = {"mass": "80 kg", "size": [0.3, 0.3, 0.3], "centre": [0, 1, 0]}
    head_on_beam["beam"]["crossbeam"]["bearings"][0]["on"] = "leg"
    head_on_beam["connector"]["rail"] = {
        "between": ["ground", "leg"], "at": [0.0, 0.0, 0.0], "stiffness": {"x": 1e6},
    }  # fmt: skip
    head_on_beam["axis"]["Y"] = {
        "direction": [0, 1, 0], "moving": "crossbeam", "carrying": "ground",
        "carries": ["crossbeam", "head", "leg"], "position": "10 mm",
    }  # fmt: skip
    parts = machine_parts(MachineFile.from_dict(head_on_beam), {"X": 0.2})
    at = {one.name: one.centre for one in parts.bodies}
    assert at["head"] == pytest.approx([0.7, 0.01, -0.1])
    assert at["leg"] == pytest.approx([0.0, 1.01, 0.0])
    assert parts.beams[0].origin == pytest.approx([0.0, 0.01, 0.0])
    places = {one.name: one.at for one in parts.connectors}
    assert places["carriage[0]"] == pytest.approx([0.65, 0.01, 0.0])
    # fixed to the ground, where it stays
    assert places["rail"] == pytest.approx([0.0, 0.0, 0.0])
    assert parts.points[0].at == pytest.approx([0.7, 0.01, -0.35])


def test_drives_push_where_the_part_is(line_text):
    parts = machine_parts(MachineFile.from_text(line_text), {"Y": "200 mm"})
    geometry = parts.axes[0].geometry
    assert geometry.at == pytest.approx([0.0, 0.3, 0.0])
    assert geometry.position == pytest.approx(0.2)


def test_six_entries_of_an_inertia_tensor(line, changed):
    data = changed(line, ["body", "bed", "inertia"], [400, 500, 600, -20, 30, "-10 kg*m^2"])
    bed = machine_parts(MachineFile.from_dict(data)).bodies[0]
    assert bed.inertia.tolist() == [[400, -20, 30], [-20, 500, -10], [30, -10, 600]]


def test_disc_by_size_and_material_of_a_segment(head_on_beam):
    beam = head_on_beam["beam"]["crossbeam"]
    beam["discs"] = [{"station": 0.5, "width": "20 mm", "outer": "0.2 m", "density": "7850 kg/m^3"}]
    beam["segments"].append(
        {"length": "0.2 m", "outer": "50 mm", "inner": "20 mm",
         "material": {"young": "70 GPa", "density": "2.7 g/cm^3", "poisson": 0.33}}
    )  # fmt: skip
    made = machine_parts(MachineFile.from_dict(head_on_beam)).beams[0]
    assert made.discs[0].mass == pytest.approx(7850.0 * 0.02 * math.pi * 0.01)
    assert made.segments[1].material.young == 70e9
    rigid = made.rigid_motions
    weight = (rigid.T @ made.mass_matrix @ rigid)[0, 0]
    tube = 2700.0 * 0.2 * math.pi / 4 * (0.05**2 - 0.02**2)
    bar = 7850.0 * math.pi / 4 * 0.09**2
    assert weight == pytest.approx(bar + tube + made.discs[0].mass)


def test_damping_by_mode():
    """Two masses on springs, 20 and 50 Hz: the band takes one of them, the ratio the other."""
    spring = {"ry": 1e9, "rx": 1e9, "rz": 1e9, "y": 1e9, "z": 1e9}
    machine = MachineFile.from_dict(
        {
            "damping_ratio": 0.01,
            "mode_damping": [{"from": "15 Hz", "to": "25 Hz", "ratio": "4 %"}],
            "body": {
                name: {"mass": 10.0, "inertia": [1.0, 1.0, 1.0], "centre": [at, 0.0, 0.0]}
                for name, at in (("slow", 0.0), ("fast", 1.0))
            },
            "connector": {
                name: {
                    "between": [name, "ground"],
                    "at": [at, 0.0, 0.0],
                    "stiffness": spring | {"x": 10.0 * (2.0 * np.pi * frequency) ** 2},
                }
                for name, at, frequency in (("slow", 0.0, 20.0), ("fast", 1.0, 50.0))
            },
        }
    )
    structure = assembled_machine(machine).structure
    modes = undamped_modes(structure)
    assert modes.frequency[:2] == pytest.approx([20.0, 50.0], rel=1e-9)
    assert damping_ratios(structure, modes)[:3] == pytest.approx([0.04, 0.01, 0.01], rel=1e-6)


def test_an_empty_band_of_damping_is_refused():
    with pytest.raises(InputError, match=r"mode_damping.*band is empty"):
        MachineFile.from_dict({"mode_damping": [{"from": "25 Hz", "to": "15 Hz", "ratio": 0.04}]})
