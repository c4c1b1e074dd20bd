"""[beam.NAME]: shafts, spindles and tools as lines of beam elements."""

from __future__ import annotations

from pydantic import Field, model_validator

from chatter.description.directions import Direction
from chatter.description.machine.fields import Position, arguments, pair
from chatter.description.quantities import quantity, whole_number
from chatter.description.section import Section, raise_if_any
from dynamics.beam.element import Material, Segment
from dynamics.beam.shaft import BeamLine, Bearing, Disc
from dynamics.structure.bodies import GROUND


class MaterialSection(Section):
    """Elastic material."""

    young: quantity("pressure", above=0.0) = Field(description="Young's modulus")
    density: quantity("density", above=0.0)
    poisson: quantity("number", above=-1.0, at_most=0.5) = 0.3

    def spec(self) -> Material:
        """The material."""
        return Material(self.young, self.density, self.poisson)


_STEEL = MaterialSection.model_construct(young=206e9, density=7850.0, poisson=0.3)


class SegmentSection(Section):
    """Stretch of one round section."""

    length: quantity("length", above=0.0)
    outer: quantity("length", above=0.0) = Field(description="outer diameter")
    inner: quantity("length", at_least=0.0) = Field(0.0, description="bore")
    elements: whole_number(1, 1000, "numbers of elements") = 4
    material: MaterialSection | None = Field(None, description="where it is not the beam's")

    def spec(self, material: MaterialSection) -> Segment:
        """The segment, of the beam's material if it has none of its own."""
        own = (self.material or material).spec()
        return Segment(self.length, self.outer, own, self.inner, self.elements)


class DiscSection(Section):
    """Rigid disc: by mass and moments of inertia, or by its size."""

    station: quantity("length", at_least=0.0) = Field(description="place along the beam")
    mass: quantity("mass", above=0.0) | None = None
    polar_inertia: quantity("moment_of_inertia", above=0.0) | None = None
    diametral_inertia: quantity("moment_of_inertia", above=0.0) | None = None
    width: quantity("length", above=0.0) | None = None
    outer: quantity("length", above=0.0) | None = Field(None, description="outer diameter")
    inner: quantity("length", at_least=0.0) | None = Field(None, description="bore")
    density: quantity("density", above=0.0) | None = None

    @model_validator(mode="after")
    def _check_form(self) -> DiscSection:
        forms = (("mass", "polar_inertia", "diametral_inertia"), ("width", "outer", "density"))
        given = [[getattr(self, key) is not None for key in keys] for keys in forms]
        whole = [all(one) for one in given]
        others = given[1 - whole.index(True)] if any(whole) else [True]
        text = f"give either {', '.join(forms[0])}, or {', '.join(forms[1])} and perhaps inner"
        raise_if_any([("", text)] if any(others) else [])
        return self

    def spec(self) -> Disc:
        """The disc."""
        if self.mass is not None:
            return Disc(**arguments(self, Disc))
        return Disc.from_size(self.station, self.width, self.inner or 0.0, self.outer, self.density)


class BearingSection(Section):
    """Bearing in the beam's own directions: radial twice, axial, tilt twice, torsion."""

    name: str = Field(examples=["front"])
    station: quantity("length", at_least=0.0) = Field(description="place along the beam")
    on: str = Field(GROUND, description="what carries the bearing")
    radial: pair("stiffness", at_least=0.0)
    axial: quantity("stiffness", at_least=0.0) = 0.0
    tilt: pair("rotational_stiffness", at_least=0.0) = (0.0, 0.0)
    torsion: quantity("rotational_stiffness", at_least=0.0) = 0.0
    radial_damping: pair("damping", at_least=0.0) = (0.0, 0.0)
    axial_damping: quantity("damping", at_least=0.0) = 0.0
    tilt_damping: pair("rotational_damping", at_least=0.0) = (0.0, 0.0)
    torsion_damping: quantity("rotational_damping", at_least=0.0) = 0.0

    def spec(self) -> Bearing:
        """The bearing."""
        return Bearing(**arguments(self, Bearing), body=self.on)


class BeamSection(Section):
    """Line of stepped round segments; stations count from its origin."""

    origin: Position = Field(description="first end")
    axis: Direction = (0.0, 0.0, 1.0)
    first_radial: Direction | None = Field(
        None, description="first radial direction, made perpendicular to the axis"
    )
    segments: tuple[SegmentSection, ...] = Field(min_length=1)
    material: MaterialSection = Field(_STEEL, description="steel by default")
    discs: tuple[DiscSection, ...] = ()
    bearings: tuple[BearingSection, ...] = ()
    stiffness_damping: quantity("time", at_least=0.0) = Field(
        0.0, description="damping over stiffness: ratio pi f times this"
    )

    @model_validator(mode="after")
    def _check_names(self) -> BeamSection:
        names = [one.name for one in self.bearings]
        twice = {name for name in names if names.count(name) > 1}
        raise_if_any([("bearings", f'"{name}" is there twice') for name in sorted(twice)])
        return self

    def part(self, name: str) -> BeamLine:
        """The beam at position 0 of the axes that carry it."""
        return BeamLine(
            name,
            [segment.spec(self.material) for segment in self.segments],
            self.origin,
            self.axis,
            [disc.spec() for disc in self.discs],
            [bearing.spec() for bearing in self.bearings],
            self.first_radial,
            self.stiffness_damping,
        )
