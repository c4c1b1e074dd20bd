"""Preset studies: common questions, each one command on a shipped example."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from chatter.description.errors import InputError


@dataclass(frozen=True)
class PresetStudy:
    """A study with its paths and values.

    Parameters
    ----------
    name : str
    question : str
    example : str
        Shipped example that it is made for, as folder/file.
    vary : tuple of str
        As on the command line.
    result : str
    settings : mapping of str to object
        Patch of the case before anything varies.
    only : tuple of str
        Names of [frf.NAME].
    quantity : str, optional
    tornado : bool
    """

    name: str
    question: str
    example: str
    vary: tuple[str, ...]
    result: str
    settings: Mapping[str, Any] = field(default_factory=dict)
    only: tuple[str, ...] = ()
    quantity: str | None = None
    tornado: bool = False

    def file(self) -> Path:
        """Case or machine file of the shipped example.

        Raises
        ------
        InputError
            If it is not there.
        """
        from chatter.io.shipped_examples import examples

        folders = {Path(one.folder).parent for one in examples().values()}
        for folder in folders:
            if (folder / self.example).is_file():
                return folder / self.example
        raise InputError(f"study {self.name}: the example {self.example} is not installed")


_PLOUGHING = {
    "tool.clearance_angle": "6 deg",
    "tool.edge_radius": "10 um",
    "process_damping": {"indentation_force": "4e13 N/m^3", "friction": 0.3},
}

#: lobes straight from the FRFs of the machine, without a fit of modes at every position
_WORKSPACE = {
    "lobes": {
        "method": "zero-order",
        "speeds": {"from": "600 rpm", "to": "1800 rpm", "count": 200},
        "depths": {"to": "6 mm"},
    }
}

STUDIES: dict[str, PresetStudy] = {
    study.name: study
    for study in (
        PresetStudy(
            "process-damping",
            "What does process damping add, over the whole diagram?",
            "one-degree-of-freedom/case.toml",
            ("process_damping.coefficient=0 N/m, 2e4 N/m, 5e4 N/m, 1e5 N/m",),
            "lobes",
        ),
        PresetStudy(
            "process-damping-speed",
            "At which speeds does process damping matter?",
            "one-degree-of-freedom/case.toml",
            (
                "process_damping.coefficient=0 N/m, 1e4 N/m, 2e4 N/m, 5e4 N/m",
                "cut.spindle_speed=2000 rpm..12000 rpm",
            ),
            "critical-depth",
        ),
        PresetStudy(
            "wear",
            "What becomes of chatter as the flank wears and ploughs?",
            "chattering-cut/case.toml",
            ("tool.flank_wear=0 um, 20 um, 50 um, 100 um",),
            "forces",
            _PLOUGHING,
            quantity="settled_displacement_um",
        ),
        PresetStudy(
            "guide-friction",
            "What does the friction of a guide do to the table?",
            "machine-coupled-milling/machine.toml",
            ("machine.friction.translation_y.coulomb=25 N, 50 N, 100 N, 200 N",),
            "frf",
            only=("rest",),
        ),
        PresetStudy(
            "friction-amplitude",
            "What does the amplitude of the vibration do to lobes where a guide rubs?",
            "friction-amplitude/case.toml",
            ("structure.friction_amplitude=0.2 um, 1 um, 2 um, 4 um, 7 um, 20 um, 60 um",),
            "lobes",
        ),
        PresetStudy(
            "contact",
            "What does the contact of tool and work do to the table?",
            "machine-coupled-milling/machine.toml",
            ("machine.contact.stiffness=0.5 N/um, 1 N/um, 2.5 N/um, 5 N/um, 10 N/um",),
            "frf",
            only=("boring_in_cut",),
        ),
        PresetStudy(
            "velocity-gain",
            "What does the gain of the velocity controller do to the table?",
            "machine-coupled-milling/machine.toml",
            (
                "machine.axis.Y.control.velocity.proportional_gain="
                "0.3 N*m*s/rad, 0.6 N*m*s/rad, 1.2 N*m*s/rad",
            ),
            "frf",
            only=("moving",),
        ),
        PresetStudy(
            "controller-gains",
            "Which gains of position and velocity controller keep the table quiet?",
            "machine-coupled-milling/machine.toml",
            (
                "machine.axis.Y.control.position.gain=20 1/s, 40 1/s, 60 1/s, 80 1/s",
                "machine.axis.Y.control.velocity.proportional_gain="
                "0.3 N*m*s/rad, 0.6 N*m*s/rad, 0.9 N*m*s/rad, 1.2 N*m*s/rad",
            ),
            "frf",
            only=("moving",),
        ),
        PresetStudy(
            "axis-position",
            "What does the tool feel where the head stands elsewhere on its crossbeam?",
            "machine-gantry/machine.toml",
            ("machine.axis.Y.position=-400 mm, -200 mm, 0 mm, 200 mm, 400 mm",),
            "frf",
            {"machine.frf.tool_z": {"excite": "tcp:z", "band": ["30 Hz", "500 Hz"]}},
            only=("tool_z",),
        ),
        PresetStudy(
            "workspace-lobes",
            "What are the lobes of a cut where the head stands higher or lower?",
            "face-mill-chatter/case.toml",
            ("machine.axis.Z.position=-200 mm, -100 mm, 0 mm, 100 mm, 200 mm",),
            "lobes",
            _WORKSPACE,
        ),
        PresetStudy(
            "workspace",
            "Where in the workspace does a cut go how deep?",
            "face-mill-chatter/case.toml",
            (
                "machine.axis.X.position=-200 mm, 0 mm, 200 mm",
                "machine.axis.Z.position=-200 mm, 0 mm, 200 mm",
            ),
            "lobes",
            _WORKSPACE,
            quantity="critical_depth_mm",
        ),
        PresetStudy(
            "pitch",
            "Does unequal pitch cut quietly where equal pitch chatters?",
            "chattering-cut/case.toml",
            (
                'tool.pitch=["90 deg", "90 deg", "90 deg", "90 deg"], '
                '["88 deg", "92 deg", "88 deg", "92 deg"], '
                '["85 deg", "95 deg", "85 deg", "95 deg"], '
                '["80 deg", "100 deg", "80 deg", "100 deg"]',
            ),
            "forces",
            quantity="settled_displacement_um",
        ),
        PresetStudy(
            "helix",
            "What does the helix do to the lobes of period doubling?",
            "helix-islands/case.toml",
            ("tool.helix=0 deg, 15 deg, 30 deg, 45 deg",),
            "lobes",
        ),
        PresetStudy(
            "runout",
            "What does runout do to forces and surface?",
            "chattering-cut/case.toml",
            ("tool.runout.offset=0 um, 5 um, 10 um, 20 um",),
            "surface",
            {"cut.axial_depth": "1 mm"},
            quantity="Rz_um",
        ),
        PresetStudy(
            "sensitivity",
            "On which declared value does the critical depth depend most?",
            "steel-half-immersion/case.toml",
            (
                "material.Ktc=+-10%",
                "material.Krc=+-10%",
                "cut.radial_depth=+-10%",
                "structure.mode[*].damping=+-10%",
                "structure.mode[*].frequency=+-2%",
                "structure.mode[*].stiffness=+-10%",
            ),
            "critical-depth",
            tornado=True,
        ),
    )
}


def preset_study(name: str) -> PresetStudy:
    """Return a preset study.

    Raises
    ------
    InputError
        If there is none of that name.
    """
    if name not in STUDIES:
        from chatter.description.wording import nearest

        raise InputError(f'--study "{name}" is not known; {nearest(name, list(STUDIES))}')
    return STUDIES[name]


def rows() -> Sequence[Sequence[str]]:
    """Name, what varies, result and example of every study, for a table."""
    return [
        [one.name, "\n".join(one.vary), one.result, one.example, one.question]
        for one in STUDIES.values()
    ]
