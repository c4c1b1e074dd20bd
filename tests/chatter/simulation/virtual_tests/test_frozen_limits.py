"""A machine of solid elements in motion answers at each place as one that is frozen there."""

import numpy as np
import pytest

from chatter.compile.machine_along_axes import machine_along_axes, machine_at_start
from chatter.compile.machine_parts import assembled_machine
from chatter.description.machine.machine_file import load_machine
from chatter.simulation.virtual_tests.run import RunInputs, run_machine
from dynamics.machine.moving_structure import moving_structure
from dynamics.trajectory.jerk_limited import JerkLimitedMove
from dynamics.trajectory.set_points import set_points
from tests.places import EXAMPLES

START, TRAVEL, SPEED = -0.4, 0.3, 0.06  # m, m, m/s
#: instant of the blow, how long it lasts and what is compared behind it, s
BLOW, WIDTH, AFTER = 4.0, 2e-3, 0.25
FORCE = 200.0  # N
SETTLED = 1.0  # s, of the frozen machine in motion before its blow


@pytest.fixture(scope="module")
def file():
    return load_machine(EXAMPLES / "solid-crossbeam" / "machine.toml")


def tool(machine):
    return {
        way: machine.structure.port("tcp", row) for way, row in zip("xyz", np.eye(3), strict=True)
    }


def points_of(file, travel):
    motion = JerkLimitedMove(np.zeros(1), np.array([travel]), SPEED, 2.0, 50.0)
    return set_points(motion, 1e-3, file.step)


def answer(file, machine, along, points, blow):
    """Motion (3, n) of the tool point behind a blow in x, y and z while the axis travels.

    Less the same motion without the blow; and the energy of the run with it.
    """
    steps = round((blow + AFTER) / file.step)
    time = np.arange(steps + 1) * file.step
    share = np.clip((time - blow) / WIDTH, 0.0, 1.0)
    pulse = FORCE * np.sin(np.pi * share) ** 2
    row = machine.structure.port("tcp", np.ones(3) / np.sqrt(3.0))
    if along is not None:
        load = [one.structure.port("tcp", np.ones(3) / np.sqrt(3.0)) for one in along.machines]
        rows = [{**there, "blow": here} for there, here in zip(along.outputs, load, strict=True)]
        along = along._replace(outputs=tuple(rows))
    runs = [
        run_machine(
            machine,
            file.step,
            RunInputs(
                steps * file.step,
                points,
                {"blow": (row, force)},
                outputs=tool(machine),
                along=along,
            ),
        )
        for force in (pulse, 0.0 * pulse)
    ]
    behind = round(blow / file.step)
    hit, still = (np.array([one.displacement[way][behind:] for way in "xyz"]) for one in runs)
    place = runs[1].displacement["scale X"][behind + (steps - behind) // 2]
    return hit - still, float(place), runs[0].energy


@pytest.fixture(scope="module")
def moving(file):
    """Answer of the machine that follows, where that was, and its energy."""
    patched = file.patch({"axis.X.position": START})
    along = machine_along_axes(patched, {"X": (0.0, TRAVEL)}, lambda one, _: tool(one))
    return answer(patched, machine_at_start(along), along, points_of(file, TRAVEL), BLOW)


def frozen_at(file, place):
    """Answer of a machine that stays as it is at a place, though its axis moves as fast."""
    machine = assembled_machine(file, positions={"X": place})
    return answer(file, machine, None, points_of(file, 2.0 * SPEED), SETTLED)[0]


def apart(one, other):
    return np.linalg.norm(one - other) / np.linalg.norm(other)


def poles(decay, step):
    """Frequency, Hz, damping ratio and energy of each motion that rings (3, n), by a matrix pencil.

    Hua and Sarkar 1990, IEEE Trans. Acoust. Speech Signal Process. 38:814.
    """
    every = 8
    seen = decay[:, ::every]
    width = seen.shape[1] // 3
    stacked = np.vstack([np.lib.stride_tricks.sliding_window_view(row, width + 1) for row in seen])
    left, right = stacked[:, :-1], stacked[:, 1:]
    u, s, v = np.linalg.svd(left, full_matrices=False)
    kept = s > 1e-4 * s[0]
    pencil = (u[:, kept].T @ right @ v[kept].T) / s[kept][:, None]
    roots = np.log(np.linalg.eigvals(pencil).astype(complex)) / (every * step)
    rings = np.exp(np.outer(np.arange(seen.shape[1]) * every * step, roots))
    share = np.linalg.lstsq(rings, seen.T.astype(complex), rcond=None)[0]
    energy = np.sum(np.abs(share) ** 2, axis=1) * np.sum(np.abs(rings) ** 2, axis=0)
    found = np.abs(roots) / (2.0 * np.pi), -roots.real / np.abs(roots), energy
    return np.array(found).T[roots.imag > 0.0]


def test_a_blow_in_motion_rings_as_at_the_place_frozen(file, moving):
    decay, place, _ = moving
    there, at_start = (frozen_at(file, START + where) for where in (place, 0.0))
    assert 0.2 < place < 0.27
    assert apart(decay, there) < 0.03
    assert apart(at_start, there) > 0.15  # so that following it is seen


def test_frequency_and_damping_in_motion_are_those_frozen(file, moving):
    """The strongest motions behind the blow, by a fit that knows nothing of the machine."""
    decay, place, _ = moving
    free = round(2.0 * WIDTH / file.step)
    found, wanted = (
        poles(one[:, free:], file.step) for one in (decay, frozen_at(file, START + place))
    )
    vibrates = wanted[wanted[:, 1] < 0.1]
    strong = vibrates[vibrates[:, 2] > 1e-2 * vibrates[:, 2].max()]
    near = [found[np.abs(found[:, 0] / one[0] - 1.0) < 5e-3] for one in strong]
    # a mode whose frequency changes within the decay is fitted by two
    pairs = [(ones[0], one) for ones, one in zip(near, strong, strict=True) if len(ones) == 1]
    assert len(pairs) >= 6
    frequency, damping, _ = np.array([mine / exact for mine, exact in pairs]).T
    assert frequency == pytest.approx(1.0, rel=1e-3)
    assert damping == pytest.approx(1.0, rel=0.05)


def test_energy_closes_with_a_blow_in_motion(moving):
    energy = moving[2]
    balance = energy["work"] + energy["travel"] - energy["dissipated"] - energy["stored"]
    assert energy["dissipated"] > 0.0
    assert abs(balance) < 1e-3 * energy["dissipated"]
    assert abs(energy["travel"]) > 10.0 * abs(balance)


def test_between_positions_the_machine_is_that_of_the_file_there(file):
    """What stands between the positions is interpolated: frequencies to 2 parts in 1000."""
    along = machine_along_axes(
        file.patch({"axis.X.position": START}), {"X": (0.0, TRAVEL)}, lambda one, _: tool(one)
    )
    rows = [np.array(list(one.values())) for one in along.outputs]
    along = along._replace(parts=(2,))
    _, group = moving_structure(along, rows, np.array([0]), file.step)
    places = group.position[0]
    for number in range(1, len(places), 2):
        exact = assembled_machine(file, positions={"X": START + float(places[number])})
        wanted = exact.structure.natural_frequencies()
        below = np.flatnonzero((wanted > 1.0) & (wanted < 600.0))
        found = np.sqrt(np.maximum(np.linalg.eigvalsh(group.stiffness[number]), 0.0)) / 2 / np.pi
        assert found[below] == pytest.approx(wanted[below], rel=2e-3)


def test_common_coordinates_give_the_same_answer(file, moving, monkeypatch):
    """Far more coordinates, the same at all positions, answer the blow alike."""
    monkeypatch.setattr(
        "chatter.compile.machine_along_axes.in_transported_coordinates", lambda *_: None
    )
    patched = file.patch({"axis.X.position": START})
    along = machine_along_axes(patched, {"X": (0.0, TRAVEL)}, lambda one, _: tool(one))
    machine = machine_at_start(along)
    decay, _, _ = answer(patched, machine, along, points_of(file, TRAVEL), BLOW)
    assert machine.structure.size > 1.5 * len(assembled_machine(file).structure.mass)
    assert apart(moving[0], decay) < 0.01
