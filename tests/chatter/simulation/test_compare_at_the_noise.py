"""A case against its own data: what is simulated is what a measurement is compared with.

Each kind of case is simulated, one percent of noise is added, and `compare` is asked for the error
of the same case. Were it to predict with another model, one without the drives of a machine for
instance, the error would not be that of the noise.
"""

import numpy as np
import pytest

import chatter
from chatter import Case
from chatter.explain.comparison import compare
from tests.chatter.simulation.on_machine.coupled_machines import (
    body,
    linear_axis,
    spindle,
    spring,
    written,
)

NOISE = 0.01
MODES = [
    {"frequency": "410 Hz", "damping": 0.03, "stiffness": 9e6, "direction": [1, 0, 0]},
    {"frequency": "530 Hz", "damping": 0.02, "stiffness": 1.4e7, "direction": [0.6, 0.8, 0]},
]
AT_TIP = [0.0, 0.0, 0.0]


def head():
    """Body on springs without axes."""
    return {
        "tool_point": "tip",
        "damping_ratio": 0.03,
        "body": {"head": body(20.0)},
        "connector": {"springs": spring("head", "ground", x=8e7, y=1.4e8)},
        "point": {"tip": {"on": "head", "at": AT_TIP}},
    }


def slide():
    """Slide that feeds a spindle along x, with friction of its guide."""
    return {
        "tool_point": "tip",
        "workpiece": "work",
        "body": {"bed": body(1e5), "slide": body(50.0)},
        "connector": {"foot": spring("bed", "ground"), "guide": spring("slide", "bed", x=0.0)},
        "point": {"tip": {"on": "slide", "at": AT_TIP}, "work": {"on": "bed", "at": AT_TIP}},
        "axis": {
            "X": linear_axis((1, 0, 0), "slide", "bed", ["slide"]),
            "S": spindle("bed", inertia=0.02),
        },
        "friction": {
            "guide": {
                "law": "coulomb-stribeck",
                "on": {"axis": "X"},
                "coulomb": 60.0,
                "static": 90.0,
                "stribeck_velocity": 3e-3,
            }
        },
    }


def cut_of(structure, tool=None, material=None, cut=None, simulation=None, **sections):
    """Stable cut of three revolutions."""
    return Case.from_dict(
        {
            "tool": {"teeth": 4, "diameter": "16 mm", "helix": "35 deg", **(tool or {})},
            "material": {"law": "linear", "Ktc": 8e8, "Krc": 3e8, "Kac": 1e8, **(material or {})},
            "cut": {
                "mode": "down",
                "spindle_speed": "3000 rpm",
                "feed_per_tooth": "0.1 mm",
                "axial_depth": "1.5 mm",
                "radial_depth": "6 mm",
                **(cut or {}),
            },
            "structure": structure,
            "simulation": {"slices": 6, "revolutions": 3, **(simulation or {})},
            **sections,
        }
    )


def on_modes(modes=MODES, **given):
    return cut_of({"mode": modes}, **given)


def rubbing():
    law = {"law": "coulomb-stribeck", "coulomb": 20.0, "static": 25.0, "stribeck_velocity": 5e-3}
    return on_modes([{**MODES[0], "friction": "guide"}, MODES[1]], friction={"guide": law})


KINDS = {
    "modes": on_modes,
    "machine at rest": lambda: cut_of({"machine": "head.toml", "settling": 0}),
    "machine feeding": lambda: cut_of({"machine": "slide.toml", "settling": 0.1}),
    "friction": rubbing,
    "contact": lambda: on_modes(contact={"stiffness": 2e6, "damping": 50.0}),
    "dexel stock": lambda: on_modes(simulation={"chip": "dexel", "resolution": "50 um"}),
    "voxel": lambda: on_modes(simulation={"chip": "voxel", "resolution": "40 um"}),
    "varying speed": lambda: on_modes(
        cut={"speed_variation": {"amplitude": 0.1, "frequency": "20 Hz"}}
    ),
    "runout": lambda: on_modes(tool={"runout": {"offset": "20 um", "angle": "40 deg"}}),
    "exponential law": lambda: on_modes(
        material={"law": "exponential", "h0": "0.1 mm", "exponent": 0.7}
    ),
    "ploughing": lambda: on_modes(
        tool={"clearance_angle": "6 deg", "flank_wear": "0.05 mm"},
        process_damping={"indentation_force": 1e14, "friction": 0.3},
    ),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Folder with the machine files."""
    where = tmp_path_factory.mktemp("measurements")
    written(where, head(), "head.toml")
    written(where, slide(), "slide.toml")
    return where


def measured(folder, case):
    """Write a measurement: the case simulated, with noise in all channels; the noise of each."""
    result = chatter.simulate(case)
    rng = np.random.default_rng(1)
    columns, names, noise = [result.time], ["time [s]"], {}
    for name, values in zip(
        ("Fx [N]", "Fy [N]", "Fz [N]", "x [m]", "y [m]", "z [m]"),
        np.hstack([result.force, result.displacement]).T,
        strict=True,
    ):
        size = NOISE * np.sqrt(np.mean(values**2))
        if size > 0.0:
            noise[name.split()[0]] = size
            columns.append(values + size * rng.normal(size=values.size))
            names.append(name)
    (folder / "case.toml").write_text(case.to_toml())
    header = ",".join(names)
    table = np.column_stack(columns)
    np.savetxt(folder / "run.csv", table, "%.12g", ",", header=header, comments="")
    (folder / "measurement.toml").write_text(
        'title = "itself"\nkind = "milling"\ncase = "case.toml"\n[[run]]\nfile = "run.csv"\n'
    )
    return noise


@pytest.mark.parametrize("kind", KINDS)
def test_a_case_meets_its_own_data_at_the_noise(kind, folder):
    case = KINDS[kind]()
    if case.structure.machine is not None:
        case = case.patch({"structure.machine": str(folder / case.structure.machine)})
    noise = measured(folder, case)
    found = compare(folder)
    assert not found.checks
    assert len(noise) >= 4
    for channel, size in noise.items():
        # a run is compared in parts
        errors = [one.error for one in found.errors if one.channel == channel]
        assert np.sqrt(np.mean(np.square(errors))) == pytest.approx(size, rel=0.1), channel
