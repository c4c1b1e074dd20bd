"""A structure that changes as an axis travels, against closed forms, integration and itself."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from chatter.compile.machine_along_axes import StateOfMachine, machine_along_axes, machine_at_start
from chatter.compile.machine_parts import assembled_machine
from chatter.description.errors import InputError
from chatter.description.machine.machine_file import load_machine
from chatter.engine.loop import Laws, run
from chatter.engine.record import port_record
from chatter.simulation.virtual_tests.from_file import file_move
from chatter.simulation.virtual_tests.run import RunInputs, run_machine
from dynamics.machine.along_axes import machines_at
from dynamics.machine.description import Machine
from dynamics.machine.energy import account_of_moving, energy_of
from dynamics.machine.moving_structure import MachinesAlong, moving_structure
from dynamics.reduction.modal_truncation import undamped_modes
from dynamics.structure.linear_structure import LinearStructure, StructureError
from dynamics.trajectory.jerk_limited import JerkLimitedMove
from dynamics.trajectory.set_points import set_points

#: travel at a constant speed past an oscillator whose stiffness grows along it
SPEED, LENGTH = 0.5, 0.2
LOAD = 500.0
MASS, STIFFNESS, GROWTH = 2.0, 2.0 * (2.0 * np.pi * 60.0) ** 2, 4.0

SCREW_MACHINE = """
damping_ratio = 0.01
tool_point = "tcp"
highest_frequency = "1200 Hz"
step = "50 us"

[beam.rail]
origin = ["0 mm", "0 mm", "0 mm"]
axis = [1, 0, 0]
material = { young = "210 GPa", density = "7850 kg/m^3" }
segments = [{ length = "1000 mm", outer = "70 mm", elements = 8 }]

[connector.left]
between = ["rail", "ground"]
at = ["0 mm", "0 mm", "0 mm"]
stiffness = { x = "500 N/um", y = "500 N/um", z = "500 N/um", rx = "1e6 N*m/rad" }

[connector.right]
between = ["rail", "ground"]
at = ["1000 mm", "0 mm", "0 mm"]
stiffness = { y = "500 N/um", z = "500 N/um", rx = "1e6 N*m/rad" }

[body.carriage]
mass = "40 kg"
size = ["200 mm", "200 mm", "150 mm"]
centre = ["150 mm", "0 mm", "100 mm"]

[connector.guide]
between = ["carriage", "rail"]
positions = [["100 mm", "0 mm", "40 mm"], ["200 mm", "0 mm", "40 mm"]]
stiffness = { y = "400 N/um", z = "400 N/um", rx = "2e5 N*m/rad" }

[point.tcp]
on = "carriage"
at = ["150 mm", "0 mm", "250 mm"]

[axis.X]
direction = [1, 0, 0]
moving = "carriage"
carrying = "ground"
at = ["150 mm", "0 mm", "0 mm"]

[axis.X.drive]
kind = "ball screw"
lead = "20 mm"
motor_inertia = "0.004 kg*m^2"
screw_inertia = "0.002 kg*m^2"
nut_stiffness = "300 N/um"
bearing_stiffness = "400 N/um"
shaft = { diameter = "32 mm", length = "1100 mm", nut_at = "200 mm", support = "fixed-free" }

[axis.X.control]
position = { gain = "25 1/s", sample_time = "1 ms" }
velocity = { proportional_gain = "4 N*m*s/rad", integral_time = "20 ms", sample_time = "250 us" }
current = { kind = "first order", time_constant = "0.3 ms", sample_time = "50 us" }

[friction.guide]
on = { axis = "X" }
law = "coulomb-stribeck"
coulomb = "60 N"

[move.forward]
kind = "jerk limited"
axes = ["X"]
travel = ["600 mm"]
velocity = "1 m/s"
acceleration = "5 m/s^2"
jerk = "400 m/s^3"
"""


@pytest.fixture(scope="module")
def screw_machine(tmp_path_factory):
    path = tmp_path_factory.mktemp("moving") / "machine.toml"
    path.write_text(SCREW_MACHINE)
    return load_machine(path)


def stiffness_at(place):
    return STIFFNESS * (1.0 + GROWTH * place)


def along(cells, damping=0.0):
    """Freedoms: travel, and an oscillator; a port at each."""
    places = np.linspace(0.0, LENGTH, cells + 1)
    machines = [
        Machine(
            LinearStructure(
                np.diag([1.0, MASS]),
                np.diag([0.0, damping]),
                np.diag([0.0, stiffness_at(place)]),
                {},
            ),
            *((),) * 4,
            assembly=None,
        )
        for place in places
    ]
    return MachinesAlong(("X",), (places,), tuple(machines), ({},) * len(places), (1,))


def run_past(cells, damping=0.0, step=1e-4):
    """Travel along the whole length; displacement of the oscillator, and the energy."""
    grid = along(cells, damping)
    rows = [np.eye(2)] * len(grid.machines)
    bus, group = moving_structure(grid, rows, np.array([0]), step, np.array([SPEED, 0.1]))
    account = account_of_moving(group, bus, [2, 2])
    steps = round(LENGTH / SPEED / step)
    record = port_record(steps, 2, 1, 1)
    assert run(Laws((group,), (), (account,), (record,)), bus, 0, 0, steps) == steps
    return step * np.arange(1, steps + 1), record.displacement[:, 1], energy_of(account, bus)


def test_adiabatic_invariant():
    """A slow change of the stiffness keeps energy over frequency, and the travel does the work."""
    time, _, energy = run_past(16)
    at_start = 0.5 * MASS * 0.1**2
    stiffer = np.sqrt(stiffness_at(LENGTH) / STIFFNESS)
    assert energy["stored"] == pytest.approx(at_start * (stiffer - 1.0), rel=0.02)
    assert energy["travel"] == pytest.approx(energy["stored"], rel=2e-4)
    assert energy["dissipated"] == 0.0
    assert energy["work"] == 0.0
    assert time[-1] == pytest.approx(LENGTH / SPEED)


def test_against_integration():
    damping = 0.01 * 2.0 * np.sqrt(STIFFNESS * MASS)

    def rates(time, y):
        force = -stiffness_at(SPEED * time) * y[0] - damping * y[1]
        return [y[1], force / MASS]

    time, moved, energy = run_past(8, damping)
    exact = solve_ivp(rates, (0.0, time[-1]), [0.0, 0.1], t_eval=time, rtol=1e-10, atol=1e-14)
    assert np.max(np.abs(moved - exact.y[0])) < 5e-3 * np.max(np.abs(exact.y[0]))
    last = exact.y[:, -1]
    stored = 0.5 * (MASS * last[1] ** 2 + stiffness_at(LENGTH) * last[0] ** 2)
    assert energy["stored"] == pytest.approx(stored - 0.5 * MASS * 0.1**2, rel=5e-3)
    balance = energy["work"] + energy["travel"] - energy["dissipated"] - energy["stored"]
    assert abs(balance) < 1e-3 * abs(energy["stored"])


def test_nothing_jumps():
    """No step of the displacement is larger than its velocity makes it."""
    time, moved, _ = run_past(2)
    fastest = 0.1 * 1.05  # the stiffness grows, and the velocity with it
    assert np.max(np.abs(np.diff(moved))) < 1.3 * fastest * time[0]


def test_axis_without_two_positions_is_refused():
    grid = along(1)._replace(positions=(np.array([0.1, 0.2]),))
    with pytest.raises(StructureError, match='axis "X": positions'):
        moving_structure(grid, [np.eye(2)] * 2, np.array([0]), 1e-4)


def grid_of(file, count, low=0.0, high=0.6):
    return machine_along_axes(file, {"X": (low, high)}, lambda *_: {}, count)


def test_frozen_positions(screw_machine):
    """At every position the machine is that of the file there: screw, beam and points."""
    grid = grid_of(screw_machine, 5)
    assert grid.axes == ("X",)
    for place, machine in zip(grid.positions[0], grid.machines, strict=True):
        frozen = assembled_machine(screw_machine, positions={"X": float(place)})
        mine, exact = (undamped_modes(one.structure).frequency for one in (machine, frozen))
        below = exact < 600.0
        assert mine[: below.sum()] == pytest.approx(exact[below], rel=2e-3, abs=1e-6)
    lowest = [undamped_modes(one.structure, 600.0).frequency[1] for one in grid.machines]
    assert max(lowest) > 1.05 * min(lowest)  # it does change


def test_one_reduction_keeps_the_responses_of_every_position(screw_machine):
    """Motions in common, far fewer than of all positions, answer as the whole machine at each."""
    grid = grid_of(screw_machine, 9)
    whole = screw_machine.patch({"highest_frequency": None})
    frequency = np.linspace(20.0, 600.0, 60)
    for place, machine in zip(grid.positions[0], grid.machines, strict=True):
        exact = assembled_machine(whole, positions={"X": float(place)})
        found, wanted = (
            one.structure.receptance(
                frequency, np.array([one.structure.port("tcp", way) for way in np.eye(3)])
            )
            for one in (machine, exact)
        )
        assert np.max(np.abs(found - wanted)) < 5e-3 * np.max(np.abs(wanted))


def test_contact_of_a_move_in_the_cut_travels_along(screw_machine, monkeypatch):
    """Everywhere the tool is held as that of the file in the cut there; it once was not at all."""
    contact = {"contact": {"stiffness": "50 N/um", "directions": ["z"]}}
    file = screw_machine.patch({"axis.X.brake.stiffness": "1e6 N*m/rad", **contact})
    grids = []

    def kept(*given):
        grids.append(machine_along_axes(*given))
        return grids[-1]

    monkeypatch.setattr("chatter.simulation.virtual_tests.from_file.machine_along_axes", kept)
    assert moved(file, 3, in_cut=True).energy
    (grid,) = grids
    frequency = np.array([30.0, 60.0])
    for place, machine in zip(grid.positions[0], grid.machines, strict=True):
        frozen = assembled_machine(file, positions={"X": float(place)}, in_cut=True)
        mine, exact = (
            one.structure.receptance(frequency, one.structure.port("tcp", [0.0, 0.0, 1.0])[None])
            for one in (machine, frozen)
        )
        assert mine == pytest.approx(exact, rel=5e-3)
        assert np.max(np.abs(mine)) < 1.0 / 50e6  # of the contact alone


def test_start_within_the_travel(screw_machine):
    grid = grid_of(screw_machine, 4, -0.02, 0.3)
    assert 0.0 in grid.positions[0]
    start = machine_at_start(grid)
    frozen = assembled_machine(screw_machine)
    assert undamped_modes(start.structure).frequency[1] == pytest.approx(
        undamped_modes(frozen.structure).frequency[1], rel=1e-3
    )


@pytest.mark.parametrize("beyond", [1e-19, 3e-5])
def test_a_little_beyond_the_start_is_no_position(screw_machine, beyond):
    """An arc that closes but for rounding was refused; a sliver of a cell would be followed."""
    positions = grid_of(screw_machine, 5, -beyond, 0.3).positions[0]
    assert positions == pytest.approx(np.linspace(0.0, 0.3, 5))
    assert positions[0] == 0.0


def test_number_of_positions_by_the_travel(screw_machine):
    travels = (0.05, 0.07, 0.1, 0.6)
    counts = [len(grid_of(screw_machine, None, 0.0, high).positions[0]) for high in travels]
    assert counts == [3, 4, 5, 13]


def moved(file, count, **changes):
    section = file.move["forward"].model_copy(update={"travel_positions": count, **changes})
    return file_move(file, "forward", section)


def pressed_down(file, count=None):
    """Carriage that travels with a load on it: time, place, deflection along the load, energy."""
    grid = machine_along_axes(
        file, {"X": (0.0, 0.6)}, lambda one, _: {"load": downwards(one)}, count
    )
    machine = machine_at_start(grid)
    motion = JerkLimitedMove(np.zeros(1), np.array([0.6]), 1.0, 5.0, 400.0)
    points = set_points(motion, 1e-3, file.step)
    steps = len(points.position) * points.steps
    force = LOAD * np.minimum(np.arange(steps + 1) * file.step / 0.05, 1.0)
    inputs = RunInputs(
        steps * file.step, points, {"load": (downwards(machine), force)}, stride=20, along=grid
    )
    run = run_machine(machine, file.step, inputs)
    return run.displacement["scale X"], run.displacement["load"], run.energy


def downwards(machine):
    return machine.structure.port("tcp", [0.0, 0.0, -1.0])


def static_deflection(file, place):
    """Deflection under the load with the axis held where it is."""
    machine = assembled_machine(file, {"X": "brake"}, {"X": place})
    row = downwards(machine)
    return LOAD * row @ np.linalg.solve(machine.structure.stiffness, row)


def test_loaded_carriage_sags_as_at_frozen_positions(screw_machine):
    """The load is moved slowly against the rail's vibrations: deflections are those at rest."""
    file = screw_machine.patch({"damping_ratio": 0.1, "axis.X.brake.stiffness": "1e6 N*m/rad"})
    place, usual, energy = pressed_down(file)
    fine = pressed_down(file, 33)[1]
    settled = (place > 0.1) & (place < 0.5)
    exact = [static_deflection(file, where) for where in (0.1, 0.2, 0.3, 0.4, 0.5)]
    assert np.ptp(exact) > 0.3 * min(exact)  # the rail bends most in the middle
    expected = CubicSpline((0.1, 0.2, 0.3, 0.4, 0.5), exact)(place[settled])
    assert np.max(np.abs(fine[settled] - expected)) < 0.03 * max(exact)
    assert np.max(np.abs(usual - fine)) < 0.02 * max(exact)
    assert np.max(np.abs(np.diff(usual))) < 0.05 * max(exact)  # no jumps, a millisecond a row
    balance = energy["work"] + energy["travel"] - energy["dissipated"] - energy["stored"]
    assert abs(balance) < 0.01 * energy["work"]
    assert abs(energy["travel"]) > 10.0 * abs(balance)


def test_move_tells_its_energy(screw_machine):
    frozen, following = (moved(screw_machine, count) for count in (1, None))
    assert frozen.summary()["energy_J"]["travel"] == 0.0
    energy = following.summary()["energy_J"]
    balance = energy["work"] + energy["travel"] - energy["dissipated"] - energy["stored"]
    assert abs(balance) < 0.01 * energy["stored"]
    assert following.scale[-1, 0] == pytest.approx(0.6, abs=1e-3)


def test_a_move_that_ends_where_it_began_is_the_frozen_one(screw_machine):
    """Below a millimetre of travel nothing follows; and a machine that hardly moves is frozen."""
    short = moved(screw_machine, None, travel=(0.5e-3,))
    assert short.energy["travel"] == 0.0
    frozen, following = (moved(screw_machine, count, travel=(1.5e-3,)) for count in (1, 3))
    assert following.energy["travel"] != 0.0
    error = np.max(np.abs(frozen.tracking_error - following.tracking_error))
    assert error < 2e-3 * np.max(np.abs(frozen.tracking_error))


def test_a_nut_that_leaves_its_screw_is_refused(screw_machine):
    with pytest.raises(InputError, match=r"screw|beam|shaft"):
        moved(screw_machine, None, travel=(0.95,))


def test_friction_on_a_mode_stays_on_it(screw_machine):
    patched = screw_machine.patch({"friction.guide.on": {"mode": 2}})
    grid = grid_of(patched, 9)
    rows = [machine.frictions[0].row for machine in grid.machines]
    for before, behind in pairwise(rows):
        assert before @ behind > 0.8 * np.linalg.norm(before) * np.linalg.norm(behind)


def test_one_position_keeps_the_structure(screw_machine):
    assert grid_of(screw_machine, 1) is None


def test_a_further_move_of_a_file_takes_its_machines(screw_machine, monkeypatch):
    """Machines along a travel are made once of a file, whatever reads them; others are others."""
    file = screw_machine.patch({})
    first = moved(file, 5)
    made = []

    def counted(*given):
        made.append(given)
        return machines_at(*given)

    monkeypatch.setattr("chatter.compile.machine_along_axes.machines_at", counted)
    again = moved(file, 5)
    assert not made
    assert np.array_equal(again.tracking_error, first.tracking_error)
    without = grid_of_state(file, StateOfMachine(friction=False))
    assert not without.machines[0].frictions
    assert len(made) == 1
    braked = grid_of_state(file, StateOfMachine({"X": "brake"}))
    elsewhere = grid_of_state(file, StateOfMachine(positions={"X": 0.05}))
    assert len(made) == 3
    stiffest = [np.max(one.machines[0].structure.stiffness) for one in (without, braked, elsewhere)]
    assert len(set(stiffest)) == 3
    softer = file.patch({"damping_ratio": 0.05})
    assert np.any(grid_of_state(softer, StateOfMachine()).machines[0].structure.damping)
    assert len(made) == 4
    for high in (0.3, 0.4, 0.5, 0.55):
        machine_along_axes(file, {"X": (0.0, high)}, lambda *_: {}, 3)
    assert len(file.once("along the axes", dict)) == 4  # not without end


def grid_of_state(file, state):
    return machine_along_axes(file, {"X": (0.0, 0.5)}, lambda *_: {}, 5, state)
