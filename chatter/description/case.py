"""The Case: an immutable description of a cut; everything else is a function of it."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field, PrivateAttr, model_validator

from chatter.description import renamed
from chatter.description.case_checks import depth_problems, friction_problems, optimum_problems
from chatter.description.errors import InputError
from chatter.description.file_access import remember_written
from chatter.description.given_path import path_given
from chatter.description.given_values import EXAMPLE_OF_PATCH, mapping_given, text_given
from chatter.description.patchable import Description
from chatter.description.path import Step, join_path
from chatter.description.renamed import Renamed
from chatter.description.sections.cut import Cut
from chatter.description.sections.empirical import Empirical, problems_of_terms
from chatter.description.sections.friction import Friction
from chatter.description.sections.material import Material
from chatter.description.sections.optimisation import Optimum, PitchDesign
from chatter.description.sections.process import (
    Axis,
    Contact,
    Dynamometer,
    Lobes,
    ProcessDamping,
    Simulation,
    Stock,
    ToolLife,
    Uncertainty,
    Wear,
)
from chatter.description.sections.structure import StructureSection
from chatter.description.sections.tool import Tool
from chatter.description.stated_cut import ALTERNATIVES, unsolved, with_stated_cut
from chatter.description.stated_engagement import (
    ALTERNATIVE_ENGAGEMENTS,
    ENGAGEMENT_KEYS,
    engagement_problems,
    engagement_problems_of_draft,
    uncut_band,
)
from chatter.description.toml_document import move_references
from chatter.description.toml_editing import Layout
from chatter.description.unit_system import units_of_content
from chatter.description.whole_files import write_whole
from chatter.description.without_effect import keys_without_effect
from cutting.engagement.uncut_band import UncutBand

if TYPE_CHECKING:
    from chatter.description.machine.machine_file import MachineFile


_MODE = "cut.mode"
#: beginning of paths into the machine of a case
MACHINE_PATH = "machine."


class Case(Description):
    """A tool, a material, a cut and a structure, in SI.

    Sections are None (or empty) where the file has none; a command asks for those that it needs
    with `require`.
    """

    NOUN: ClassVar[str] = "case"
    EXAMPLE_PATH: ClassVar[str] = "cut.axial_depth"
    RENAMED: ClassVar[tuple[Renamed, ...]] = renamed.CASE
    LAYOUT: ClassVar[Layout] = Layout(
        headed=frozenset({("friction", "*")}),
        alternatives={
            "mass": "stiffness",
            "stiffness": "mass",
            "duration": "revolutions",
            "revolutions": "duration",
            **ALTERNATIVES,
            **ALTERNATIVE_ENGAGEMENTS,
        },
    )

    title: str = ""
    tool: Tool | None = None
    material: Material | None = None
    cut: Cut | None = None
    structure: StructureSection | None = None
    process_damping: ProcessDamping | None = None
    contact: Contact | None = None
    wear: Wear | None = None
    tool_life: ToolLife | None = None
    dynamometer: Dynamometer | None = None
    empirical: tuple[Empirical, ...] = ()
    friction: dict[str, Friction] = Field(default_factory=dict)
    axis: Axis | None = None
    simulation: Simulation | None = None
    stock: Stock | None = None
    lobes: Lobes | None = None
    uncertainty: Uncertainty | None = None
    optimum: Optimum | None = None
    pitch_design: PitchDesign | None = None

    #: takes the place of the file that structure.machine names; no file holds it
    _machine: Any = PrivateAttr(default=None)

    @model_validator(mode="before")
    @classmethod
    def _read_stated_cut(cls, data: Any) -> Any:
        return with_stated_cut(data)

    @classmethod
    def _problems_of_draft(cls, data: Mapping[str, Any]) -> Sequence[tuple[str, str]]:
        return engagement_problems_of_draft(data, units_of_content(data).length)

    @classmethod
    def _follow_from_others(cls, data: Mapping[str, Any]) -> Mapping[tuple[Step, ...], str]:
        return unsolved(data)

    def _further_problems(self, data: Mapping[str, Any]) -> Sequence[tuple[str, str]]:
        length = units_of_content(data).length
        return [
            *engagement_problems(self.cut, self.tool, length),
            *depth_problems(self.cut, self.tool, length, data),
            *friction_problems(self.structure, self.friction),
            *optimum_problems(self.optimum, self.cut, self.tool, length),
            *problems_of_terms(self.empirical),
        ]

    def _resolve_files(self, content: dict[str, Any]) -> None:
        if self.material is not None and self.material.table is not None:
            content["material"]["table"] = str(self.material.table.resolve())
        if self.simulation is not None and self.simulation.program is not None:
            file = self.simulation.program.file
            content["simulation"]["program"]["file"] = str(file.resolve())
        if self.structure is None:
            return
        for entry in content["structure"]["frf"]:
            entry["file"] = str(Path(entry["file"]).resolve())
        if self.structure.machine is not None:
            content["structure"]["machine"] = str(self.structure.machine.resolve())
        if self._machine is not None:
            content["structure"]["machine"] = self._machine.content

    @classmethod
    def _move_references(cls, document: Any, old: Path, new: Path) -> None:
        move_references(document, old, new)

    @property
    def notes(self) -> tuple[str, ...]:
        """What the user should know of the file: renamed keys, and keys that nothing uses."""
        return (*super().notes, *keys_without_effect(self))

    @property
    def uncut_band(self) -> UncutBand:
        """Uncut work across the feed, as [cut] states it; InputError with an inclined tool axis."""
        for key in ("lead", "tilt"):
            angle = getattr(self.cut, key)
            if angle:
                raise InputError(
                    f"{self.name}: cut.{key}: {math.degrees(angle):.4g} deg is not computed here, "
                    "which takes a tool axis normal to the surface alone; check, lobes, whatif and "
                    "simulate take an inclined one"
                )
        return uncut_band(self.cut, self.tool)

    @property
    def width_of_cut(self) -> float:
        """Width of cut at the full radius of the tool, m, seen along the feed."""
        return float(uncut_band(self.cut, self.tool).width(0.5 * self.tool.diameter))

    @property
    def feed_speed(self) -> float:
        """Speed of the tool over the workpiece, m/s."""
        return self.cut.feed_per_tooth * self.tool.teeth * self.cut.spindle_speed / (2.0 * math.pi)

    def empirical_over(self, variable: str) -> Empirical | None:
        """Term learnt over a variable; None where there is none."""
        return next((one for one in self.empirical if one.over == variable), None)

    def machine_file(self) -> MachineFile:
        """Machine of [structure]: the one that was put in its place, else that of the file."""
        return self._read_machine() if self._machine is None else self._machine

    def _read_machine(self) -> MachineFile:
        from chatter.description.machine.machine_file import load_machine

        return load_machine(self.structure.machine, self._machine_name())

    def _machine_name(self) -> str:
        """Name of the machine file for people, who know where the case file lies."""
        path = self.structure.machine
        if not path.is_relative_to(self.folder):
            return str(path)
        # a case that was opened by a whole path is no reason to spell out that of the machine
        beside = Path() if Path(self.name).is_absolute() else Path(self.name).parent
        return os.path.normpath(beside / path.relative_to(self.folder))

    @property
    def on_machine(self) -> bool:
        """Whether the structure is that of a machine."""
        return self.structure is not None and self.structure.machine is not None

    @classmethod
    def _belongs_elsewhere(cls, steps: tuple[Step, ...]) -> str | None:
        from chatter.description.machine.machine_file import MachineFile

        if not MachineFile.knows(steps):
            return None
        path = join_path(steps)
        return f"is a path into a machine; into that of a case it is {MACHINE_PATH}{path}"

    def require_machine(self, path: str) -> None:
        """Raise InputError where a path leads into a machine and the case is on none."""
        if not self.on_machine:
            raise InputError(
                f"{self.name}: {MACHINE_PATH}{path}: the case is on no machine; [structure] "
                'machine = "machine.toml" puts it on one'
            )

    def get(self, path: str) -> Any:
        """Return the value at a dotted path, in SI, "machine." leading into the machine.

        See `Description`.
        """
        if not text_given(path, f"{self.name}: a path").startswith(MACHINE_PATH):
            return super().get(path)
        inside = path.removeprefix(MACHINE_PATH)
        self.require_machine(inside)
        return self.machine_file().get(inside)

    def deviations(self) -> dict[str, float]:
        """Standard deviations (SI) of all values given with one, by path, the machine's too."""
        found = super().deviations()
        if self.on_machine:
            of_machine = self.machine_file().deviations()
            found |= {MACHINE_PATH + path: one for path, one in of_machine.items()}
        return found

    def save(self, path: str | Path) -> None:
        """Write the file, and beside it the machine where it is not that of the file it names.

        See `Description`.
        """
        path = path_given(path, "the case to be written")
        if self._machine is None or self._machine == self._read_machine():
            super().save(path)
            return
        beside = path.with_name(f"{path.stem}-machine.toml")
        self._machine.save(beside)
        moved = self.patch({"structure.machine": str(beside.resolve())})
        super(Case, moved).save(path)
        text = path.read_text(encoding="utf-8").replace(beside.resolve().as_posix(), beside.name)
        write_whole(path, text)
        remember_written(text)

    def with_machine(self, machine: MachineFile) -> Case:
        """Return the case on another machine than that of the file that it names.

        Raises
        ------
        InputError
            If the case is on no machine.
        """
        if not self.on_machine:
            raise InputError(f"{self.name}: structure.machine is missing; it is on no machine")
        moved = self.model_copy()
        moved._machine = machine
        return moved

    def patch(self, values: Mapping[str, Any]) -> Case:
        """Return the case with some values changed, on the same machine; see `Description`.

        Paths that begin with "machine." lead into the machine. A cut that becomes a slot is as wide
        as the tool.
        """
        mapping_given(values, f"{self.name}: a dictionary", EXAMPLE_OF_PATCH)
        into = [str(path) for path in values if str(path).startswith(MACHINE_PATH)]
        if into:
            own = {path: value for path, value in values.items() if path not in into}
            moved = self.patch(own) if own else self
            moved.require_machine(into[0])
            of_machine = {path.removeprefix(MACHINE_PATH): values[path] for path in into}
            return moved.with_machine(moved.machine_file().patch(of_machine))
        if values.get(_MODE) == "slot" and self.cut is not None:
            given = [key for key in ENGAGEMENT_KEYS if getattr(self.cut, key) is not None]
            values = {**{f"cut.{key}": None for key in given}, **values}
        patched = super().patch(values)
        named = None if patched.structure is None else patched.structure.machine
        if self._machine is not None and named == self.structure.machine:
            patched._machine = self._machine
        return patched

    def require(self, *sections: str) -> None:
        """Raise InputError naming every one of the sections that the case lacks."""
        missing = [section for section in sections if not getattr(self, section)]
        if missing:
            raise InputError(
                [
                    f"{self.name}: [{section}] is missing; this command needs it"
                    for section in missing
                ]
            )


def load(path: str | Path) -> Case:
    """Read a case file.

    Raises
    ------
    InputError
        If the file cannot be read or describes no case; all problems found are in it.
    """
    return Case.from_file(path)


def loads(text: str, name: str = "case", folder: str | Path = ".") -> Case:
    """Read a case from TOML text.

    Raises
    ------
    InputError
        If the text describes no case; all problems found are in it.
    """
    return Case.from_text(text, name, folder)
