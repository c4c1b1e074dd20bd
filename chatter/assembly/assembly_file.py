"""The assembly file: what is put together, at which stick-outs, for which cut."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

from pydantic import Field, model_validator

from chatter.assembly.library import Damping, Stiffness
from chatter.description.file_name import FileName
from chatter.description.patchable import Description
from chatter.description.quantities import PositiveLength, quantity, whole_number
from chatter.description.section import Section, raise_if_any
from chatter.description.toml_document import moved_reference
from chatter.description.toml_editing import Layout

_MOST_LINES = 20_000


class Named(Section):
    """An entry of a library."""

    name: str


class SpindleSection(Section):
    """A spindle of a library, or a measured one."""

    name: str | None = Field(None, description="entry of a library")
    frf: FileName | None = Field(None, description="measured: response at the end, force there")
    cross_frf: FileName | None = Field(
        None, description="measured: response behind the end for the force at the end"
    )
    behind_frf: FileName | None = Field(
        None, description="measured: response and force behind the end; for a sharper slope"
    )
    cross_distance: PositiveLength | None = Field(None, description="between the two responses")
    standard_holder: str | None = Field(
        None, description="holder of a library that it was measured with, bore empty; taken off"
    )

    @model_validator(mode="after")
    def _check_kind(self) -> SpindleSection:
        problems = []
        if (self.name is None) == (self.frf is None):
            problems.append(("", "needs either name (of a library) or frf (measured)"))
        for key in ("cross_frf", "cross_distance"):
            given = getattr(self, key) is not None
            if self.frf is not None and not given:
                text = "is missing; a measured spindle needs cross_frf and cross_distance, as a "
                problems.append((key, text + "translation alone does not hold a tool's slope"))
            if self.frf is None and given:
                problems.append((key, "belongs to a measured spindle, with frf"))
        for key in ("standard_holder", "behind_frf"):
            if getattr(self, key) is not None and self.frf is None:
                problems.append((key, "belongs to a measured spindle, with frf"))
        raise_if_any(problems)
        return self


class Joint(Section):
    """Elastic joint of the shank in the holder; rigid where it is left out."""

    stiffness: Stiffness
    rotational_stiffness: quantity("rotational_stiffness", above=0.0)
    damping: Damping = 0.0
    rotational_damping: quantity("rotational_damping", at_least=0.0) = 0.0


class StickOut(Section):
    """Lengths of the tool outside the holder."""

    shortest: PositiveLength
    longest: PositiveLength
    count: whole_number(1, 200, "stick-outs") = 7

    @model_validator(mode="after")
    def _check_order(self) -> StickOut:
        longest, shortest = 1e3 * self.longest, 1e3 * self.shortest
        text = f"{longest:.4g} mm; it must not be below the shortest, {shortest:.4g} mm"
        raise_if_any([("longest", text)] if self.longest < self.shortest else [])
        return self


class Frequencies(Section):
    """Lines of the computed responses, where no measured spindle gives them."""

    to: quantity("frequency", above=0.0) = 8000.0
    step: quantity("frequency", above=0.0) = 2.0

    @model_validator(mode="after")
    def _check_count(self) -> Frequencies:
        text = f"makes {self.to / self.step:.3g} lines; at most {_MOST_LINES} are allowed"
        raise_if_any([("step", text)] if self.to / self.step > _MOST_LINES else [])
        return self


class AssemblyFile(Description):
    """A tool in a holder on a spindle; in SI."""

    NOUN: ClassVar[str] = "assembly"
    EXAMPLE_PATH: ClassVar[str] = "stick_out.longest"
    LAYOUT: ClassVar[Layout] = Layout(headed=frozenset(), alternatives={})

    title: str = ""
    library: FileName | None = Field(None, description="own library, beside the shipped one")
    case: FileName | None = Field(None, description="tool, material and cut of the lobes")
    loss_factor: quantity("number", at_least=0.0, below=1.0) = Field(
        0.02, description="structural damping of tool, holder and shaft, their joints included"
    )
    tool: Named
    holder: Named | None = Field(
        None, description="none where the spindle was measured at the face of the holder"
    )
    spindle: SpindleSection
    joint: Joint | None = None
    stick_out: StickOut
    frequencies: Frequencies = Frequencies()

    @classmethod
    def _move_references(cls, document: Any, old: Path, new: Path) -> None:
        for table in (document, document.get("spindle", {})):
            for key in ("library", "case", "frf", "cross_frf", "behind_frf"):
                if isinstance(table.get(key), str):
                    table[key] = moved_reference(table[key], old, new)
