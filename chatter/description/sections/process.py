"""The smaller sections: process damping, contact, friction, axis, simulation, lobes."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, ClassVar, Literal

from pydantic import Field, field_validator, model_validator

from chatter.description.quantities import (
    PositiveLength,
    QuantityField,
    list_reader,
    list_type,
    quantity,
    whole_number,
)
from chatter.description.section import Section, raise_if_any
from chatter.description.sections.program import Program
from chatter.description.stated_range import StatedRange
from chatter.description.units import rpm

if TYPE_CHECKING:
    from typing_extensions import Self

#: most points a side of a diagram, and in all
MOST_POINTS_A_SIDE = 20_000
MOST_POINTS = 20_000_000
#: by which shares may be more than the whole
_ROUNDED = 1e-9


class ProcessDamping(Section):
    """Process damping: viscous, F_r += C (b/V) r_dot, or by the material that the flank ploughs."""

    coefficient: quantity("line_force", at_least=0.0) | None = Field(
        None, description="C of the viscous form"
    )
    indentation_force: quantity("pressure_gradient", above=0.0) | None = Field(
        None, description="force per ploughed volume; the form for the time domain"
    )
    friction: quantity("number", at_least=0.0) = Field(
        0.0, description="mu, tangential over radial force"
    )

    @model_validator(mode="after")
    def _check_form(self) -> ProcessDamping:
        given = [
            key for key in ("coefficient", "indentation_force") if getattr(self, key) is not None
        ]
        problems = []
        if not given:
            problems.append(("coefficient", "is missing; give it, or indentation_force"))
        if len(given) == 2:
            problems.append(("", "coefficient and indentation_force are both given; give one form"))
        raise_if_any(problems)
        return self


class Contact(Section):
    """Contact of tool and workpiece while in cut."""

    stiffness: quantity("stiffness", at_least=0.0)
    damping: quantity("damping", at_least=0.0) = 0.0
    full_engagement_share: quantity("number", above=0.0, at_most=1.0) = Field(
        1.0,
        description="engaged share of the depth from which on the contact acts whole; 1: it grows "
        "until the whole depth is engaged, near 0: it acts whole as soon as any edge cuts",
    )


class Chipping(Section):
    """Damage of the edge at once: what the coefficients grow by from then on."""

    time: quantity("time", at_least=0.0) = Field(description="cutting time at which the edge chips")
    edge_tangential: quantity("line_force") = Field(0.0, description="added to Kte")
    edge_radial: quantity("line_force") = Field(0.0, description="added to Kre")
    cutting: quantity("number", above=-1.0) = Field(
        0.0, description="of Ktc, Krc and Kac, as a share of them"
    )
    cutting_radial: quantity("number", above=-1.0) | None = Field(
        None, description="of Krc alone; as cutting where it is left out"
    )
    process_damping: quantity("number", above=-1.0) = Field(
        0.0, description="of process_damping.coefficient, as a share of it"
    )
    ploughing: quantity("line_force") = Field(
        0.0, description="added to process_damping.coefficient, also where there was none"
    )


class Wear(Section):
    """Forces of a worn tool: by its worn land, and growing with the cutting time."""

    edge_tangential: quantity("line_force_rate") = Field(0.0, description="of Kte per cutting time")
    edge_radial: quantity("line_force_rate") = Field(0.0, description="of Kre per cutting time")
    cutting: quantity("rate") = Field(
        0.0, description="of Ktc, Krc and Kac per cutting time, as a share of them"
    )
    cutting_radial: quantity("rate") | None = Field(
        None, description="of Krc alone per cutting time; as cutting where it is left out"
    )
    process_damping: quantity("rate") = Field(
        0.0, description="of process_damping.coefficient per cutting time, as a share of it"
    )
    ploughing: quantity("line_force_rate") = Field(
        0.0,
        description="added to process_damping.coefficient per cutting time, also where there was "
        "none",
    )
    flank_pressure: quantity("pressure", at_least=0.0) | None = Field(
        None, description="mean on tool.flank_wear; by default a tenth of the cutting pressure"
    )
    flank_friction: quantity("number", at_least=0.0, at_most=1.0) | None = Field(
        None, description="of tool.flank_wear on the work; 0.3 by default"
    )
    saturation_time: quantity("time", above=0.0) | None = Field(
        None, description="time constant with which the growth ends; without it, it goes on"
    )
    chipping: Chipping | None = None

    def grown_time(self, cut_time: float) -> float:
        """Time (s) that rates count after a cutting time, s: less as wear saturates."""
        if self.saturation_time is None:
            return cut_time
        return -self.saturation_time * math.expm1(-cut_time / self.saturation_time)

    def increase(self, key: str, cut_time: float) -> float:
        """Increase of what a key names after a cutting time (s), by rate and by chipping, SI."""
        grown = _given(self, key) * self.grown_time(cut_time)
        chipped = self.chipping is not None and cut_time >= self.chipping.time
        return grown + (_given(self.chipping, key) if chipped else 0.0)


def _given(section: Wear | Chipping, key: str) -> float:
    """Value of a key; of the radial coefficient as of all where it is left out."""
    value = getattr(section, key)
    return section.cutting if value is None else value


class ToolLife(Section):
    """Life of the edge over the cutting speed: v T^n = C (Taylor 1907, Trans. ASME 28:31)."""

    cutting_speed: quantity("velocity", above=0.0) = Field(description="at which the life is known")
    life: quantity("time", above=0.0) = Field(description="cutting time at that speed")
    exponent: quantity("number", above=0.0, below=1.0) = Field(
        description="n of Taylor: some 0.1 to 0.15 for high-speed steel, 0.2 to 0.3 for carbide"
    )

    def life_at(self, cutting_speed: float) -> float:
        """Life (s) at a cutting speed, m/s."""
        return self.life * (self.cutting_speed / cutting_speed) ** (1.0 / self.exponent)

    def cutting_speed_for(self, life: float) -> float:
        """Cutting speed (m/s) at which the edge lasts for a time, s."""
        return self.cutting_speed * (self.life / life) ** self.exponent


class SensorResonance(Section):
    """One of several resonances of the sensor that measures the forces."""

    frequency: quantity("frequency", above=0.0)
    damping: quantity("number", above=0.0, below=1.0) = Field(description="damping ratio")
    axis: Literal["x", "y", "z"] | None = Field(
        None, description="of the case, along which it acts; along all where it is left out"
    )
    share: quantity("number", above=0.0, at_most=1.0) = Field(
        1.0, description="of the static force that goes through it; the rest is seen as it is"
    )


class Dynamometer(Section):
    """Resonance of the sensor that measures the forces, or several."""

    frequency: quantity("frequency", above=0.0) | None = None
    damping: quantity("number", above=0.0, below=1.0) | None = Field(
        None, description="damping ratio"
    )
    resonance: tuple[SensorResonance, ...] = Field(
        (), description="several resonances, each by its axis and its share"
    )

    @model_validator(mode="after")
    def _check_resonances(self) -> Self:
        keys = ("frequency", "damping")
        given = [key for key in keys if getattr(self, key) is not None]
        problems = []
        if self.resonance:
            problems += [(key, "is given beside resonance; give one of them") for key in given]
        else:
            missing = [key for key in keys if key not in given]
            problems += [(key, "is missing; give it, or resonance") for key in missing]
        for axis in "xyz" if self.resonance else "":
            if sum(one.share for one in self.along(axis)) > 1.0 + _ROUNDED:
                problems.append(("resonance", f"has shares of more than 1 together along {axis}"))
        raise_if_any(problems)
        return self

    def along(self, axis: str) -> tuple[SensorResonance, ...]:
        """Resonances through which a force along an axis of the case is seen."""
        if not self.resonance:
            return (SensorResonance(frequency=self.frequency, damping=self.damping),)
        return tuple(one for one in self.resonance if one.axis in (None, axis))


class Cogging(Section):
    """Force that repeats along the axis."""

    amplitude: quantity("force", at_least=0.0)
    period: quantity("length", above=0.0)
    phase: quantity("angle") = 0.0


class WarmUp(Section):
    """Friction that falls as the axis warms up."""

    share: quantity("number", above=-1.0) = Field(
        description="of the viscous friction at the start that is lost in the end"
    )
    time: quantity("time", above=0.0) = Field(description="constant of the decay")
    begins: Literal["day", "move"] = Field(
        "day", description="cold at the first of all moves, or again at the start of each"
    )


class Axis(Section):
    """A feed axis as a moving mass with friction."""

    moving_mass: quantity("mass", above=0.0)
    viscous_friction: quantity("damping", at_least=0.0) = 0.0
    coulomb_friction: quantity("force", at_least=0.0) = 0.0
    static_friction: quantity("force", at_least=0.0) | None = None
    stribeck_velocity: quantity("velocity", above=0.0) | None = None
    presliding_stiffness: quantity("stiffness", above=0.0) | None = None
    presliding_damping: quantity("damping", at_least=0.0) | None = None
    asymmetry: quantity("force") = Field(
        0.0, description="Coulomb friction forwards above the mean of both directions"
    )
    offset: quantity("force") = Field(0.0, description="constant force that is held")
    quadratic_drag: quantity("drag", at_least=0.0) = 0.0
    cogging: Cogging | None = None
    backlash: quantity("length", at_least=0.0) = 0.0
    motor_mass: quantity("mass", at_least=0.0) | None = Field(
        None, description="part of the moving mass on the motor's side of the backlash"
    )
    warm_up: WarmUp | None = None
    force_delay: quantity("time") = Field(
        0.0, description="time by which the force was recorded later than the motion"
    )


_COORDINATE = QuantityField("length", above=-100.0, below=100.0)
PlanePoint = list_type(
    tuple[float, float],
    list_reader(_COORDINATE, 'is not a point; two lengths are required: ["0 mm", "5 mm"]', 2, 2),
    _COORDINATE,
    fewest=2,
    most=2,
)


class StockBox(Section):
    """A block of material, or a pocket in it; the tool starts with its tip at the origin."""

    x: PlanePoint = Field(description="from and to")
    y: PlanePoint = Field(description="from and to")
    z: PlanePoint = Field(description="from and to")
    remove: bool = Field(False, description="take this block away instead")

    @field_validator("x", "y", "z")
    @classmethod
    def _check_order(cls, given: tuple[float, float]) -> tuple[float, float]:
        if given[0] >= given[1]:
            raise ValueError(f"is empty: from {given[0]:g} m is not less than to {given[1]:g} m")
        return given


class Stock(Section):
    """The workpiece before the cut, as blocks added and taken away in their order."""

    box: tuple[StockBox, ...] = Field(min_length=1)


class Simulation(Section):
    """Time-domain simulation."""

    chip: Literal["delay", "dexel", "voxel"] = "delay"
    duration: quantity("time", above=0.0) | None = None
    revolutions: quantity("number", above=0.0) | None = None
    resolution: PositiveLength | None = Field(
        None, description="spacing of dexels or size of voxels"
    )
    steps: whole_number(16, 4_000_000, "steps a revolution") | None = Field(
        None, description="steps a revolution; by default they are chosen"
    )
    slices: whole_number(1, 5_000, "slices of the edge") | None = Field(
        None, description="slices of what of the edge is in the cut; by default they are chosen"
    )
    force_tolerance: quantity("number", at_least=1e-5, at_most=0.05) = Field(
        0.005,
        description="relative error of mean forces that slices and steps aim at; twice it of peaks",
    )
    path: tuple[PlanePoint, ...] | None = Field(
        None, description="corners of the tool path, [x, y] each; dexel and voxel chips follow it"
    )
    program: Program | None = Field(
        None, description="NC program or recorded set points that the tool follows"
    )

    @property
    def has_own_path(self) -> bool:
        """Whether the tool follows a path that is not the straight one of [cut]."""
        return self.path is not None or self.program is not None

    @model_validator(mode="after")
    def _check_length(self) -> Simulation:
        problems = []
        if self.duration is not None and self.revolutions is not None:
            problems.append(("", "give duration or revolutions, not both"))
        if self.path is not None and self.program is not None:
            problems.append(("", "give path or program, not both"))
        raise_if_any(problems)
        return self

    @field_validator("path")
    @classmethod
    def _check_path(cls, given: tuple[PlanePoint, ...] | None) -> tuple[PlanePoint, ...] | None:
        if given is not None and len(given) < 2:
            raise ValueError("has fewer than two corners")
        if given is not None and any(a == b for a, b in itertools.pairwise(given)):
            raise ValueError("has two corners in a row at the same place")
        return given


Count = whole_number(2, MOST_POINTS_A_SIDE, "counts")


class Range(StatedRange):
    """Values from one to another; lengths, unless a class says otherwise."""

    #: unit of messages, and a value in it over SI
    UNIT: ClassVar[tuple[str, float]] = ("mm", 1e3)
    EXAMPLE: ClassVar[str] = "1..5 mm"
    from_: PositiveLength = Field(alias="from")
    to: PositiveLength

    @model_validator(mode="after")
    def _check_order(self) -> Self:
        unit, factor = self.UNIT
        if self.from_ is not None and self.from_ >= self.to:
            first, last = (f"{value * factor:g} {unit}" for value in (self.from_, self.to))
            text = f"the range is empty: from ({first}) is not less than to ({last})"
            raise_if_any([("", text)])
        return self


class SpeedBand(Range):
    """Spindle speeds that may be chosen."""

    UNIT: ClassVar[tuple[str, float]] = ("rpm", rpm(1.0))
    EXAMPLE: ClassVar[str] = "3000..9000 rpm"
    from_: quantity("angular_speed", above=0.0) = Field(alias="from")
    to: quantity("angular_speed", above=0.0)


class SpeedRange(SpeedBand):
    """Spindle speeds of the diagram."""

    EXAMPLE: ClassVar[str] = "3000..9000 rpm:200"
    count: Count = 400


class DepthRange(StatedRange):
    """Axial depths of the diagram."""

    EXAMPLE: ClassVar[str] = "0..5 mm:50"
    to: PositiveLength
    count: Count = 100


class Lobes(Section):
    """The stability diagram."""

    speeds: SpeedRange | None = None
    depths: DepthRange | None = None
    method: str | None = Field(None, description="stability method; by default it is chosen")
    steps: whole_number(4, 20_000, "steps a tooth period") | None = Field(
        None, description="fixes the steps a tooth period; by default they are chosen"
    )
    tolerance: quantity("number", at_least=1e-6, at_most=0.05) = Field(
        1e-3,
        description="largest estimated error of critical depths, relative; the resolution follows",
    )

    @model_validator(mode="after")
    def _check_size(self) -> Lobes:
        points = (self.speeds.count if self.speeds else 400) * (
            self.depths.count if self.depths else 100
        )
        text = f"{points} points in all; at most {MOST_POINTS} are allowed"
        raise_if_any([("", text)] if points > MOST_POINTS else [])
        return self


class Correlation(Section):
    """How two uncertain values go together."""

    between: tuple[str, str] = Field(
        description="paths of values with a standard deviation",
        examples=[["material.Ktc", "material.Krc"]],
    )
    coefficient: quantity("number", above=-1.0, below=1.0) = Field(
        description="of correlation, of the normal distributions"
    )


class Uncertainty(Section):
    """What is known of values given with a standard deviation, besides it."""

    correlation: tuple[Correlation, ...] = ()
