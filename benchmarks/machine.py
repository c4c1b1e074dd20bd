"""A machine in time against real time: 33 degrees of freedom, three controlled drives, friction.

Every figure comes from one core: the shortest and the median of some repeats, warm, with
compilation left out. Times are those of the processor in the only thread that works. The machine
has five bodies on guides, three ball screws, and friction at three guides and three screws with
the parameters of Table 1 of "Time domain coupled simulation of machine tool dynamics and cutting
forces considering the influences of nonlinear friction characteristics and process damping"; its
masses and stiffnesses are of that size. All axes move at once, back and forth.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace

# figures of one core: threads of the linear algebra would wait for a busy second one
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from numba.core.runtime import _nrt_python, rtsys

from benchmarks.one_core import show, timed
from chatter.compile.machine_parts import assembled_machine
from chatter.description.machine.machine_file import MachineFile
from chatter.engine.loop import Laws, run
from chatter.engine.record import port_record
from chatter.simulation.virtual_tests.run import RunInputs, run_machine
from dynamics.friction.lugre import LuGre
from dynamics.machine.description import Machine
from dynamics.machine.tables import machine_tables
from dynamics.machine.travel_limit import TravelLimit
from dynamics.trajectory.periodic import SineMotion
from dynamics.trajectory.set_points import SetPoints, set_points

STEP = 50e-6  # s
DURATION = 5.0  # s, simulated
AIM = 20.0  # times faster than real time
AMPLITUDE, FREQUENCY = 0.02, 1.0  # of the move of every axis, m, Hz

# fc, C, Cv, av of Table 1: N m, rad and N, m
SCREW_FRICTION = {
    "X": (0.188, 3.2e-3, 0.03, 2.0),
    "Y": (0.113, 3.2e-3, 0.25, 2.0),
    "Z": (0.046, 1.3e-3, 0.35, 2.75),
}
GUIDE_FRICTION = {
    "X": (98.6, 856.2, 3000.0, 500.0),
    "Y": (99.2, 426.7, 6000.0, 500.0),
    "Z": (17.95, 189.3, 6000.0, 800.0),
}
INCLINATION = 1.15e4  # ah, 1/m of travel
LEAD = 10e-3  # m


def corners(x: float, y: float, z: float) -> list[list[float]]:
    """Four places of carriages or feet."""
    return [[sx * x, sy * y, z] for sx in (-1, 1) for sy in (-1, 1)]


def axis(name: str, direction: list[int], moving: str, carrying: str, at: list[float]) -> dict:
    """Ball screw with a cascade controller."""
    carried = {"X": ["table"], "Y": ["saddle", "table"], "Z": ["head"]}[name]
    return {
        "direction": direction,
        "moving": moving,
        "carrying": carrying,
        "at": at,
        "carries": carried,
        "drive": {
            "kind": "ball screw",
            "lead": LEAD,
            "motor_inertia": 2.5e-3,
            "screw_inertia": 1.5e-3,
            "nut_stiffness": "200 N/um",
            "bearing_stiffness": "300 N/um",
            "axial_damping": "5 kN*s/m",
        },
        "control": {
            "position": {"gain": "40 1/s", "sample_time": "1 ms"},
            "velocity": {
                "proportional_gain": 2.0,
                "integral_time": "20 ms",
                "sample_time": "100 us",
                "torque_limit": 40.0,
            },
            "current": {
                "kind": "second order",
                "natural_frequency": "900 Hz",
                "sample_time": "50 us",
            },
            "filters": [{"kind": "low pass", "frequency": "1500 Hz"}],
            "feedforward": {"velocity": 1.0, "inertia": 4e-3},
            "measuring": {"position": "scale", "scale_resolution": "0.1 um"},
        },
    }


def guide(first: str, second: str, along: str, places: list[list[float]]) -> dict:
    """Four carriages that let go along one direction."""
    return {
        "between": [first, second],
        "places": places,
        "stiffness": {way: "250 N/um" for way in "xyz" if way != along},
        "damping": {way: "1.5 kN*s/m" for way in "xyz" if way != along},
    }


def frictions() -> dict:
    """Friction of every guide and every screw."""
    keys = ("coulomb", "viscous", "low_speed_viscous", "low_speed_decay")
    law = {"law": "tanh-hysteresis"}
    places = {}
    for name, values in GUIDE_FRICTION.items():
        told = dict(zip(keys, values, strict=True)) | {"hysteresis_slope": INCLINATION}
        places[f"guide_{name}"] = law | told | {"on": {"axis": name}}
    for name, values in SCREW_FRICTION.items():
        told = dict(zip(keys, values, strict=True))
        told["hysteresis_slope"] = INCLINATION * LEAD / (2.0 * np.pi)
        places[f"screw_{name}"] = law | told | {"on": {"motor": name}}
    return places


def machining_centre() -> MachineFile:
    """Bed, saddle, table, column and head of a vertical machining centre."""
    bodies = {
        "bed": ("1500 kg", [1.2, 2.0, 0.5], [0.0, 0.0, 0.25]),
        "saddle": ("350 kg", [0.8, 0.6, 0.2], [0.0, -0.2, 0.65]),
        "table": ("300 kg", [0.9, 0.45, 0.15], [0.0, -0.2, 0.85]),
        "column": ("1000 kg", [0.6, 0.6, 1.6], [0.0, 0.7, 1.3]),
        "head": ("250 kg", [0.4, 0.7, 0.5], [0.0, 0.2, 1.6]),
    }
    return MachineFile.from_dict(
        {
            "title": "machining centre",
            "tool_point": "tool",
            "workpiece": "table",
            "damping_ratio": 0.02,
            "body": {
                name: {"mass": mass, "size": size, "centre": centre}
                for name, (mass, size, centre) in bodies.items()
            },
            "connector": {
                "feet": {
                    "between": ["bed", "ground"],
                    "places": corners(0.5, 0.9, 0.0),
                    "stiffness": {"x": "60 N/um", "y": "60 N/um", "z": "150 N/um"},
                },
                "column_foot": {
                    "between": ["column", "bed"],
                    "places": [[x, 0.7 + y, 0.5] for x, y, _ in corners(0.25, 0.25, 0.5)],
                    "stiffness": {"x": "500 N/um", "y": "500 N/um", "z": "800 N/um"},
                },
                "guide_Y": guide("saddle", "bed", "y", corners(0.3, 0.25, 0.55)),
                "guide_X": guide("table", "saddle", "x", corners(0.3, 0.2, 0.76)),
                "guide_Z": guide(
                    "head", "column", "z", [[x, 0.4, 1.6 + z] for x, z, _ in corners(0.2, 0.2, 0)]
                ),
            },
            "point": {
                "tool": {"on": "head", "at": [0.0, 0.0, 1.2]},
                "table": {"on": "table", "at": [0.0, -0.2, 0.925]},
            },
            "axis": {
                "X": axis("X", [1, 0, 0], "table", "saddle", [0.0, -0.2, 0.76]),
                "Y": axis("Y", [0, 1, 0], "saddle", "bed", [0.0, -0.2, 0.55]),
                "Z": axis("Z", [0, 0, 1], "head", "column", [0.0, 0.4, 1.6]),
            },
            "friction": frictions(),
        }
    )


def with_lugre(machine: Machine) -> Machine:
    """Same machine with LuGre friction of the same sliding force and presliding stiffness."""
    return replace(
        machine,
        frictions=tuple(
            one._replace(
                law=LuGre(
                    bristle_stiffness=2.0 * one.law.hysteresis_slope * one.law.coulomb,
                    bristle_damping=0.0,
                    viscous=one.law.viscous,
                    coulomb=one.law.coulomb,
                    static=1.4 * one.law.coulomb,
                    stribeck_velocity=0.1 / one.law.low_speed_decay,
                )
            )
            for one in machine.frictions
        ),
    )


def moves(machine: Machine) -> SetPoints:
    """All axes back and forth at once, by frequencies with a long common period."""
    amplitude = np.full(len(machine.axes), AMPLITUDE)
    periods = DURATION * FREQUENCY
    motion = SineMotion(np.zeros(len(machine.axes)), amplitude, FREQUENCY, periods, 0.5 * np.pi)
    points = set_points(motion, 1e-3, STEP)
    return points._replace(position=points.position - points.position[0])


def loop_alone(machine: Machine, points: SetPoints | None) -> Callable[[], object]:
    """The compiled loop over a run of so many steps; every call goes on where the last ended."""
    count = round(DURATION / STEP)
    tables = machine_tables(machine, STEP, points)
    record = port_record(0, 0, count + 1, count + 1)
    laws = Laws(tables.explicit, (TravelLimit(1e5),), tables.implicit, (record,))
    return lambda: run(laws, tables.bus, 0, 0, count)


def allocations(call: Callable[[], object]) -> int:
    """Arrays that the compiled code allocates in a call."""
    call()
    _nrt_python.memsys_enable_stats()
    before = rtsys.get_allocation_stats()
    call()
    return rtsys.get_allocation_stats().alloc - before.alloc


def main() -> dict[str, list[dict]]:
    """Print the table and return it."""
    file = machining_centre()
    machine = assembled_machine(file, {})
    tool = {
        way: machine.structure.port("tool", row, "table")
        for way, row in zip("xyz", np.eye(3), strict=True)
    }
    points = moves(machine)
    steps = DURATION / STEP
    rows = []
    for name, one in (
        ("tanh-hysteresis", machine),
        ("lugre", with_lugre(machine)),
        ("none", machine.without_friction()),
    ):
        inputs = RunInputs(DURATION, points, outputs=tool)
        whole = timed(lambda one=one, inputs=inputs: run_machine(one, STEP, inputs))
        loop = loop_alone(one, points)
        alone = timed(loop)
        rows.append(
            (
                name,
                DURATION / whole.shortest,
                DURATION / whole.median,
                DURATION / whole.shortest / AIM,
                whole.shortest / steps * 1e9,
                alone.shortest / steps * 1e9,
                DURATION / alone.shortest,
                str(allocations(loop)),
            )
        )
    title = (
        f"{machine.structure.size} degrees of freedom, {len(machine.drives)} controlled drives, "
        f"{len(machine.frictions)} frictions, step {STEP * 1e6:g} us, {DURATION:g} s; times "
        f"faster than real time (aim {AIM:g}) of `run_machine` and of the loop alone"
    )
    heads = "friction|faster|median|of aim|ns a step|ns in loop|loop faster|allocations in loop"
    return {"machine": show(title, heads, rows)}


if __name__ == "__main__":
    main()
