"""Momentum, angular momentum and energy of machine and cut together."""

import numpy as np
import pytest

from chatter.simulation.setup import set_up
from tests.chatter.simulation.on_machine.coupled_machines import (
    body,
    cut_case,
    linear_axis,
    spindle,
    stepped,
    written,
)

TIP = (0.11, -0.07, 0.4)
BODIES = {
    "bed": (400.0, (0.0, 0.1, -0.3), (20.0, 30.0, 25.0)),
    "head": (60.0, (0.2, 0.3, 0.7), (1.2, 1.5, 0.9)),
    "table": (90.0, (-0.1, 0.05, 0.2), (2.0, 3.0, 4.0)),
}
FOOT = np.array([0.3, -0.2, -0.5])
FOOT_STIFFNESS = {"x": 3e7, "y": 4e7, "z": 6e7, "rx": 4e6, "ry": 5e6, "rz": 6e6}
FOOT_DAMPING = {"x": 2e4, "y": 3e4, "z": 2e4, "rx": 2e3, "ry": 1e3, "rz": 3e3}
INERTIA = 0.02
WAYS = np.eye(6)


def joint(first, second, at, free=(), scale=1.0):
    stiffness = {"x": 2e8, "y": 3e8, "z": 4e8, "rx": 3e7, "ry": 2e7, "rz": 3e7}
    kept = {way: scale * k for way, k in stiffness.items() if way not in free}
    damping = {way: 1e-4 * k for way, k in kept.items()}
    return {"between": [first, second], "at": at, "stiffness": kept, "damping": damping}


def machine():
    return {
        "tool_point": "tip",
        "workpiece": "work",
        "body": {name: body(*told) for name, told in BODIES.items()},
        "connector": {
            "foot": {
                "between": ["bed", "ground"],
                "at": FOOT.tolist(),
                "stiffness": FOOT_STIFFNESS,
                "damping": FOOT_DAMPING,
            },
            "neck": joint("head", "bed", [0.1, 0.4, 0.5]),
            "guide": joint("table", "bed", [-0.1, 0.0, 0.0], free=("x",)),
        },
        "point": {"tip": {"on": "head", "at": TIP}, "work": {"on": "table", "at": TIP}},
        "axis": {
            "X": linear_axis((1, 0, 0), "table", "bed", ["table"]),
            "S": spindle("head", inertia=INERTIA, proportional=2.0),
        },
    }


def case_of(path, parts=1, **cut):
    cut = {"axial_depth": "4 mm", **cut}
    return cut_case(
        {"machine": str(path), "settling": 0.2}, cut=cut, steps=400 * parts, revolutions=2
    )


def outputs():
    found = {
        f"{name}:{i}": (name, WAYS[i], centre)
        for name, (_, centre, _) in BODIES.items()
        for i in range(6)
    }
    return (
        found
        | {"rotor": ("S: motor", -WAYS[5], TIP)}
        | {f"foot:{i}": ("bed", WAYS[i], FOOT) for i in range(6)}
    )


@pytest.fixture(scope="module")
def on_feet(tmp_path_factory):
    path = written(tmp_path_factory.mktemp("feet"), machine())
    return stepped(case_of(path), 800, outputs())


def momentum(motion):
    linear, angular = np.zeros((len(motion.torque), 3)), np.zeros((len(motion.torque), 3))
    for name, (mass, centre, inertia) in BODIES.items():
        velocity = np.array([motion.v[f"{name}:{i}"] for i in range(6)]).T
        linear += mass * velocity[:, :3]
        angular += velocity[:, 3:] * inertia + mass * np.cross(centre, velocity[:, :3])
    angular[:, 2] -= INERTIA * motion.v["rotor"]
    return linear, angular


def summed(values, rates, step):
    """Integral from the first row on, by the trapezoidal rule with its end correction."""
    inner = 0.5 * step * (values[1:] + values[:-1]) - step**2 / 12.0 * (rates[1:] - rates[:-1])
    return np.concatenate([np.zeros((1, inner.shape[1])), np.cumsum(inner, axis=0)])


def test_ground_forces_alone_change_the_momentum(on_feet):
    k, c = (np.array([told[way] for way in told]) for told in (FOOT_STIFFNESS, FOOT_DAMPING))
    moved = np.array([on_feet.u[f"foot:{i}"] for i in range(6)]).T
    speed = np.array([on_feet.v[f"foot:{i}"] for i in range(6)]).T
    # k times the integral of the displacement, and the damper takes the displacement itself
    spring_impulse = summed(moved, speed, on_feet.step)
    impulse = -(k * spring_impulse + c * (moved - moved[0]))
    moment = impulse[:, 3:] + np.cross(FOOT, impulse[:, :3])
    linear, angular = momentum(on_feet)
    size = np.abs(np.array([on_feet.v[f"head:{i}"] for i in range(3)])).max() * 60.0
    assert np.abs(linear - linear[0]).max() > 0.05 * size
    assert np.abs((linear - linear[0]) - impulse[:, :3]).max() < 1e-4 * size
    assert np.abs((angular - angular[0]) - moment).max() < 1e-4 * size


def test_the_forces_on_tool_and_workpiece_are_those_of_the_cut(on_feet):
    """Over each step they go linearly from those at its beginning to those at its end."""
    for axis, way in enumerate("xyz"):
        assert np.allclose(on_feet.held[f"tool {way}"][1:], on_feet.force[:-1, axis], rtol=1e-12)
    assert np.allclose(on_feet.held["tool turn"][1:], -on_feet.torque[:-1], rtol=1e-12)
    assert on_feet.torque.mean() > 0.5


def test_a_free_machine_keeps_its_momentum(tmp_path):
    """Nothing holds it; the cut accelerates head and table apart, and turns them."""
    free = machine()
    free["allowed_rigid_motions"] = 6
    del free["connector"]["foot"]
    path = written(tmp_path, free)
    told = {name: one for name, one in outputs().items() if not name.startswith("foot")}
    motion = stepped(case_of(path), 400, told)
    linear, angular = momentum(motion)
    head = np.array([motion.v[f"head:{i}"] for i in range(6)])
    assert np.abs(head[:3]).max() * 60.0 > 0.1
    assert np.abs(linear - linear[0]).max() < 1e-8 * np.abs(head[:3]).max() * 60.0
    assert np.abs(angular - angular[0]).max() < 1e-8 * np.abs(head[3:]).max()


def residual(path, parts):
    """What the energy balance misses over two turns, against the work of the cut, J."""
    case = case_of(path, parts)
    on = set_up(case).on_machine
    structure = on.machine.structure
    told = outputs()
    order = freedoms(on.machine, told)
    motion = stepped(case, 800 * parts, told)
    q = np.array([motion.u[name] for name in order]).T
    v = np.array([motion.v[name] for name in order]).T
    step = motion.step
    kinetic = 0.5 * np.einsum("ti,ij,tj->t", v, structure.mass, v)
    elastic = 0.5 * np.einsum("ti,ij,tj->t", q, structure.stiffness, q)
    lost = np.einsum("ti,ij,tj->t", v, structure.damping, v)
    lost = step * 0.5 * (lost[1:] + lost[:-1]).sum()
    driven = sum(
        np.sum(motion.held[f"drive {name}"][1:] * np.diff(motion.u[f"drive {name}"]))
        for name in ("X", "S")
    )
    works = []
    for axis, way in enumerate("xyz"):
        force, moved = motion.force[:, axis], motion.u[f"tool {way}"]
        works.append(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(moved)))
    turned = motion.u["tool turn"]
    torque = motion.torque
    of_spindle = -np.sum(0.5 * (torque[1:] + torque[:-1]) * np.diff(turned))
    gained = (kinetic + elastic)[-1] - (kinetic + elastic)[0]
    cutting = sum(works) + of_spindle
    return gained + lost - driven - cutting, cutting, of_spindle, sum(works), gained


def freedoms(machine, told):
    """Names of the outputs that are the freedoms of the structure, in their order."""
    from dynamics.structure.spring_coupling import Term

    order = [""] * machine.structure.size
    for name, (part, way, at) in told.items():
        row = machine.row(name, [Term(part, np.array(way), np.array(at))])
        place = np.flatnonzero(np.abs(row) > 1e-12)
        if len(place) == 1 and abs(row[place[0]] - 1.0) < 1e-12 and not order[place[0]]:
            order[place[0]] = name
    assert all(order), order
    return order


def test_energy_balance_to_the_order_of_the_scheme(tmp_path):
    path = written(tmp_path, machine())
    missing = []
    for parts in (1, 2, 4):
        miss, cutting, of_spindle, _, _ = residual(path, parts)
        # the cut only takes, nearly all of it from the spindle
        assert cutting < 0.0
        assert abs(of_spindle / cutting - 1.0) < 0.05
        missing.append(abs(miss / cutting))
    assert missing[0] < 1e-3
    assert missing[1] < missing[0] / 2.5
    assert missing[2] < missing[1] / 2.5
