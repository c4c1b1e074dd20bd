"""Libraries of tools, holders and spindles: a TOML file, and the one that is shipped."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Annotated, ClassVar

from pydantic import Field, model_validator

from chatter.description.patchable import Description
from chatter.description.quantities import Length, PositiveLength, quantity, whole_number
from chatter.description.section import Section, raise_if_any
from chatter.description.toml_editing import Layout
from dynamics.beam.element import Material

#: Young's modulus, density, Poisson's ratio: usual values, of K10 to K40 carbide (ISO 3312 tests)
MATERIALS = {
    "carbide": Material(580e9, 14400.0, 0.22),
    "hss": Material(210e9, 8100.0, 0.29),
    "steel": Material(210e9, 7850.0, 0.29),
}
_SHIPPED = Path(__file__).with_name("library.toml")

MaterialName = Annotated[str, Field(pattern="^(carbide|hss|steel)$")]
#: stiffness and damping that a joint or bearing may have
Stiffness = quantity("stiffness", above=0.0)
Damping = quantity("damping", at_least=0.0)


class RoundSection(Section):
    """RoundSection of a line with a round section, or a cone."""

    length: PositiveLength
    diameter: PositiveLength
    end_diameter: PositiveLength | None = Field(None, description="of a cone; else the same")
    bore: Length = 0.0

    @model_validator(mode="after")
    def _check_bore(self) -> RoundSection:
        smallest = min(self.diameter, self.end_diameter or self.diameter)
        text = f"{self.bore:g} m; it must be below the diameter, {smallest:g} m"
        raise_if_any([("bore", text)] if self.bore >= smallest else [])
        return self


class ToolEntry(Section):
    """An end mill."""

    diameter: PositiveLength
    shank_diameter: PositiveLength
    flute_length: PositiveLength
    length: PositiveLength = Field(description="overall")
    teeth: whole_number(1, 100, "teeth") = 4
    material: MaterialName = "carbide"
    flute_ratio: quantity("number", above=0.0, at_most=1.0) = Field(
        0.8,
        description="equivalent diameter of the fluted part over the diameter (Kops and Vo 1990)",
    )
    source: str = ""

    @model_validator(mode="after")
    def _check_length(self) -> ToolEntry:
        text = f"{self.flute_length:g} m; it must be below the length, {self.length:g} m"
        raise_if_any([("flute_length", text)] if self.flute_length >= self.length else [])
        return self


class HolderEntry(Section):
    """A tool holder from its face to the gauge plane, outside the spindle."""

    taper: str
    bore: PositiveLength = Field(description="that takes the shank")
    clamping_length: PositiveLength = Field(description="shank that must be in the holder at least")
    bore_depth: PositiveLength = Field(description="from the face")
    sections: tuple[RoundSection, ...] = Field(min_length=1, description="from the face on")
    source: str = ""


class BearingEntry(Section):
    """A bearing of a spindle."""

    station: Length = Field(description="from the nose")
    stiffness: Stiffness
    damping: Damping = 0.0
    tilt_stiffness: quantity("rotational_stiffness", at_least=0.0) = 0.0


class SpindleEntry(Section):
    """A spindle shaft on its bearings."""

    taper: str
    sections: tuple[RoundSection, ...] = Field(min_length=1, description="from the nose on")
    bearings: tuple[BearingEntry, ...] = Field(min_length=1)
    source: str = ""


class Library(Description):
    """Tools, holders and spindles by name; in SI."""

    NOUN: ClassVar[str] = "library"
    EXAMPLE_PATH: ClassVar[str] = "tool.NAME.diameter"
    LAYOUT: ClassVar[Layout] = Layout(
        headed=frozenset({("tool", "*"), ("holder", "*"), ("spindle", "*")}), alternatives={}
    )

    title: str = ""
    tool: dict[str, ToolEntry] = Field(default_factory=dict)
    holder: dict[str, HolderEntry] = Field(default_factory=dict)
    spindle: dict[str, SpindleEntry] = Field(default_factory=dict)

    def over(self, other: Library) -> Mapping[str, Mapping[str, Section]]:
        """Entries of both by kind; those of this library hide others of the same name."""
        return {
            kind: {**getattr(other, kind), **getattr(self, kind)}
            for kind in ("tool", "holder", "spindle")
        }


@cache
def shipped_library() -> Library:
    """Library that comes with the program, from dimensions of public standards."""
    return Library.from_file(_SHIPPED)
