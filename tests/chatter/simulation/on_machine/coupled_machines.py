"""Machines and cuts of the tests of machine and cut together, and runs step by step."""

from dataclasses import dataclass, replace

import numpy as np

from chatter import Case
from chatter.compile.linearised_friction import rigid_motion
from chatter.description.machine.machine_file import MachineFile
from chatter.simulation.cut_run import CutRun
from chatter.simulation.setup import set_up
from dynamics.machine.tables import machine_tables
from dynamics.structure.spring_coupling import Term

STIFF = 1e13  # N/m, N m/rad
RIGID = dict.fromkeys(("x", "y", "z"), STIFF) | dict.fromkeys(("rx", "ry", "rz"), STIFF)


def body(mass, centre=(0.0, 0.0, 0.0), inertia=(1.0, 1.0, 1.0)):
    return {"mass": mass, "inertia": list(inertia), "centre": list(centre)}


def spring(first, second, at=(0.0, 0.0, 0.0), damping=None, **stiffness):
    found = {
        "between": [first, second],
        "at": list(at),
        "stiffness": {way: k for way, k in (RIGID | stiffness).items() if k},
    }
    return found if damping is None else found | {"damping": damping}


def control(gain, proportional, integral=None, **further):
    """Cascade that follows at once: ideal currents, no dead time, no limits."""
    velocity = {"proportional_gain": proportional, "sample_time": 1e-4}
    if integral is not None:
        velocity["integral_time"] = integral
    return {
        "position": {"gain": gain, "sample_time": 1e-3},
        "velocity": velocity,
        "current": {"sample_time": 5e-5},
        "feedforward": {"velocity": 1.0},
        **further,
    }


def linear_axis(direction, moving, carrying, carries, **controller):
    """Axis with a linear motor at the origin."""
    return {
        "direction": list(direction),
        "moving": moving,
        "carrying": carrying,
        "at": [0.0, 0.0, 0.0],
        "carries": carries,
        "drive": {"kind": "linear motor"},
        "control": control(50.0, 1e5, **controller),
    }


def spindle(carrying, direction=(0.0, 0.0, -1.0), inertia=0.01, proportional=3.0, integral=None):
    """Spindle under a velocity controller."""
    return {
        "direction": list(direction),
        "carrying": carrying,
        "at": [0.0, 0.0, 0.0],
        "drive": {"kind": "spindle", "inertia": inertia},
        "control": control(0.0, proportional, integral),
    }


def written(folder, machine, name="machine.toml"):
    """Machine file in a folder."""
    return MachineFile.from_dict(machine).save(folder / name) or folder / name


def cut_case(structure, tool=None, cut=None, material=None, **simulation):
    return Case.from_dict(
        {
            "tool": {
                "kind": "end mill", "teeth": 4, "diameter": "16 mm", "helix": "35 deg",
                **(tool or {}),
            },
            "material": {"law": "linear", "Ktc": 8e8, "Krc": 3e8, "Kac": 1e8, **(material or {})},
            "cut": {
                "mode": "down",
                "spindle_speed": "3000 rpm",
                "feed_per_tooth": "0.1 mm",
                "axial_depth": "1.5 mm",
                "radial_depth": "6 mm",
                **(cut or {}),
            },
            **({} if structure is None else {"structure": structure}),
            "simulation": {"slices": 8, **simulation},
        }
    )  # fmt: skip


@dataclass
class Motion:
    """Ports of a machine at the ends of steps, and the forces of the cut at them."""

    step: float
    u: dict
    v: dict
    held: dict
    force: np.ndarray
    torque: np.ndarray


def stepped(case, count, outputs=None):
    """Run a case step by step and note everything, further motions of parts included.

    `outputs` are names of (part, direction, at).
    """
    setup = set_up(case)
    on = setup.on_machine
    rows = {f"tool {axis}": row for axis, row in zip("xyz", on.tool, strict=True)}
    if on.spindle is not None:
        rows["tool turn"] = on.spindle
    for name, (part, direction, at) in (outputs or {}).items():
        rows[name] = on.machine.row(name, [Term(part, np.array(direction, float), np.array(at))])
    points = next(
        (law.points for law in setup.structure.tables.explicit if hasattr(law, "points")), None
    )
    start = np.zeros(on.machine.structure.size)
    if on.spindle_axis is not None:
        start = rigid_motion(on.machine, {on.spindle_axis: on.sense * setup.spindle.speed})
    tables = machine_tables(on.machine, setup.step, points, {}, rows, start)
    setup = replace(setup, structure=replace(setup.structure, tables=tables), furthest=1.0)
    run, s = CutRun(setup, 1, count), tables.bus
    kept = {name: np.empty((count + 1, len(s.u))) for name in ("u", "v", "held")}
    force, torque = np.empty((count + 1, 3)), np.empty(count + 1)
    for step in range(count + 1):
        assert run.steps(step) == step
        kept["u"][step], kept["v"][step], kept["held"][step] = s.u, s.v, s.force
        force[step], torque[step] = run.point.force, run.point.torque[0]
    named = {
        what: {name: values[:, place] for name, place in tables.port.items()}
        for what, values in kept.items()
    }
    return Motion(setup.step, named["u"], named["v"], named["held"], force, torque)
