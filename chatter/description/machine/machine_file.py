"""The MachineFile: an immutable description of a machine tool."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

from pydantic import Field, PrivateAttr

from chatter.description import renamed
from chatter.description.errors import InputError
from chatter.description.given_values import mapping_given
from chatter.description.kinds_of_files import OF_CASES_ALONE
from chatter.description.machine.axis import AxisSection
from chatter.description.machine.beam import BeamSection
from chatter.description.machine.bodies import (
    BodySection,
    ConnectorSection,
    ContactSection,
    ModeDampingSection,
    PointSection,
)
from chatter.description.machine.compose import Composition
from chatter.description.machine.errors_by_key import sentence
from chatter.description.machine.frequency_response import FrfSection
from chatter.description.machine.friction import FrictionSection
from chatter.description.machine.imported import ImportedSection
from chatter.description.machine.move import MoveSection
from chatter.description.machine.questioned_machine import (
    questions_of_machine,
    questions_of_positions,
)
from chatter.description.machine.references import dimension_problems, reference_problems
from chatter.description.patchable import Description
from chatter.description.path import Step
from chatter.description.quantities import QuantityField, quantity, whole_number
from chatter.description.renamed import Renamed
from chatter.description.toml_document import moved_reference
from chatter.description.toml_editing import Layout
from chatter.description.wording import nearest
from dynamics.structure.bodies import GROUND

_POSITION = QuantityField("length", at_least=-200.0, at_most=200.0)
_FILES = ("mass", "stiffness", "damping", "nodes")


class MachineFile(Description):
    """Bodies, beams and imported parts, what joins them, axes, frictions; in SI."""

    NOUN: ClassVar[str] = "machine"
    EXAMPLE_PATH: ClassVar[str] = "axis.Y.control.position.gain"
    RENAMED: ClassVar[tuple[Renamed, ...]] = renamed.MACHINE
    LAYOUT: ClassVar[Layout] = Layout(
        headed=frozenset(
            {
                *((kind, "*") for kind in ("body", "connector", "beam", "imported", "point")),
                *((kind, "*") for kind in ("axis", "friction", "frf", "move")),
                *(("axis", "*", part) for part in ("drive", "brake", "control")),
                ("imported", "*", "point"),
                ("imported", "*", "point", "*"),
            }
        ),
        alternatives={"at": "positions", "positions": "at", "inertia": "size", "size": "inertia"},
    )
    #: kinds of parts
    PARTS: ClassVar[tuple[str, ...]] = ("body", "beam", "imported")

    title: str = ""
    tool_point: str | None = Field(None, description="point where the tool is")
    workpiece: str | None = Field(None, description="point that it is measured against")
    damping_ratio: quantity("number", at_least=0.0, below=1.0) = Field(
        0.0, description="of every elastic mode, on top of the dampers"
    )
    mode_damping: tuple[ModeDampingSection, ...] = Field(
        (), description="damping ratios of the modes in bands of frequency, in place of that"
    )
    highest_frequency: quantity("frequency", above=0.0) | None = Field(
        None,
        description="modes above it are left out; their static answer is kept at drives, "
        "frictions and points",
    )
    allowed_rigid_motions: whole_number(0, 1000, "numbers of motions") = Field(
        0, description="free motions that are meant, besides those of the axes"
    )
    body: dict[str, BodySection] = Field(default_factory=dict)
    beam: dict[str, BeamSection] = Field(default_factory=dict)
    imported: dict[str, ImportedSection] = Field(default_factory=dict)
    connector: dict[str, ConnectorSection] = Field(default_factory=dict)
    point: dict[str, PointSection] = Field(default_factory=dict)
    axis: dict[str, AxisSection] = Field(default_factory=dict)
    friction: dict[str, FrictionSection] = Field(default_factory=dict)
    contact: ContactSection | None = None
    step: quantity("time", above=0.0) = Field(
        50e-6, description="of runs in time; sample times are multiples of it"
    )
    frf: dict[str, FrfSection] = Field(default_factory=dict)
    move: dict[str, MoveSection] = Field(default_factory=dict)

    _made: dict[str, Any] = PrivateAttr(default_factory=dict)

    def _resolve_files(self, content: dict[str, Any]) -> None:
        for section in content["imported"].values():
            for key in _FILES:
                if section[key] is not None:
                    section[key] = str(Path(section[key]).resolve())
        for section in content["move"].values():
            if section["file"] is not None:
                section["file"] = str(Path(section["file"]).resolve())

    @classmethod
    def _belongs_elsewhere(cls, steps: tuple[Step, ...]) -> str | None:
        if steps[0] not in OF_CASES_ALONE:
            return None
        return (
            f"this is a machine file, and [{steps[0]}] belongs to a case: write one with [tool], "
            '[material], [cut] and [structure] machine = "(this file)", and give the command that '
            'case; paths into the machine begin with "machine." there'
        )

    @classmethod
    def _move_references(cls, document: Any, old: Path, new: Path) -> None:
        for section in document.get("imported", {}).values():
            for key in _FILES:
                if isinstance(section.get(key), str):
                    section[key] = moved_reference(section[key], old, new)
        for section in document.get("move", {}).values():
            if isinstance(section.get("file"), str):
                section["file"] = moved_reference(section["file"], old, new)

    def _further_problems(self, data: Mapping[str, Any]) -> Sequence[tuple[str, str]]:
        problems = reference_problems(self)
        if problems:
            return problems
        problems = dimension_problems(self, data)
        if not any(getattr(self, kind) for kind in self.PARTS):
            problems.append(("", "has no parts; [body.NAME], [beam.NAME] or [imported.NAME]"))
        if self.contact is not None and self.tool_point is None:
            problems.append(("tool_point", "is missing; the contact acts there"))
        for key, make in Composition(self, {}).makers():
            try:
                make()
            except ValueError as error:
                problems.append((key, sentence(error, key)))
        return problems

    @property
    def notes(self) -> tuple[str, ...]:
        """What the user should know of the file: renamed keys, and unlikely values."""
        asked = (f"{self.name}: {text}" for text in questions_of_machine(self))
        own = {name: axis.position for name, axis in self.axis.items() if axis.position}
        return (*super().notes, *asked, *self.questions_of_positions(own))

    def questions_of_positions(self, given: Mapping[str, float | str]) -> tuple[str, ...]:
        """Ask about positions of axes that are hardly those of this machine."""
        positions = self.positions(given)
        return tuple(f"{self.name}: {text}" for text in questions_of_positions(self, positions))

    @property
    def part_names(self) -> tuple[str, ...]:
        """Names of all parts, and the ground."""
        return (*(name for kind in self.PARTS for name in getattr(self, kind)), GROUND)

    @property
    def contact_ends(self) -> tuple[tuple[str, float], ...]:
        """Points that the contact joins, and the sign of their motion."""
        ends = ((self.tool_point, 1.0), (self.workpiece, -1.0))
        return tuple((name, sign) for name, sign in ends if name is not None)

    def once(self, key: str, make: Callable[[], Any]) -> Any:
        """Return what was made of this file under a key: at the first call by `make`."""
        if key not in self._made:
            self._made[key] = make()
        return self._made[key]

    def positions(self, given: Mapping[str, float | str]) -> dict[str, float]:
        """Positions of axes, m.

        Given in m or as a quantity such as "120 mm". Raises InputError if there is no such axis, a
        position is none, or it lies beyond the travel of the axis.
        """
        read = {}
        mapping_given(given, f"{self.name}: positions: a dictionary", '{"X": "120 mm"}')
        for name, position in given.items():
            if name not in self.axis:
                known = nearest(str(name), list(self.axis)) if self.axis else "there are none"
                raise InputError(f'{self.name}: position: there is no axis "{name}"; {known}')
            drive = self.axis[name].drive
            if drive is not None and drive.is_rotary:
                raise InputError(f"{self.name}: position: axis {name} turns; it has no position")
            try:
                read[name] = _POSITION.read(position)
            except ValueError as error:
                raise InputError(f"{self.name}: position of axis {name}: {error}") from None
            if beyond := self.axis[name].beyond_travel(read[name]):
                raise InputError(f"{self.name}: position of axis {name}: {beyond}")
        return read

    def refuse_travel(self, travelled: Mapping[str, tuple[float, float]]) -> None:
        """Raise InputError where axes would go beyond their travel.

        Lowest and highest position of axes, m.
        """
        problems = [
            f"{self.name}: axis {name} would leave its travel: {beyond}"
            for name, ends in travelled.items()
            for end in ends
            if (beyond := self.axis[name].beyond_travel(end))
        ]
        if problems:
            raise InputError(problems)


def load_machine(path: str | Path, name: str = "") -> MachineFile:
    """Read a machine file, which messages call by its path, or by another name.

    Raises
    ------
    InputError
        If the file cannot be read or describes no machine; all problems found are in it.
    """
    return MachineFile.from_file(path, name)
