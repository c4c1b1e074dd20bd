"""[axis.NAME.control]: the cascade of position, velocity and current loop."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from chatter.description.machine.fields import arguments, fields_of
from chatter.description.quantities import either_quantity, quantity, whole_number
from chatter.description.section import Section, raise_if_any
from chatter.description.wording import key_problems
from dynamics.control.cascade import (
    DriveController,
    Feedforward,
    LoopTiming,
    PositionController,
    VelocityController,
)
from dynamics.control.current_loop import (
    FirstOrderCurrentLoop,
    IdealCurrentLoop,
    RegulatedMotor,
    SecondOrderCurrentLoop,
)
from dynamics.control.filters import ReferenceModel, SecondOrderFilter, low_pass, notch
from dynamics.control.measurement import MeasuringSystem

_Samples = whole_number(0, 10_000, "numbers of samples")
#: keys of every loop
_TIMING = ("sample_time", "measuring", "computing", "transmission")


class Loop(Section):
    """Sample time and dead times, in samples, of a loop."""

    sample_time: quantity("time", above=0.0)
    measuring: _Samples = Field(0, description="dead time of measuring, samples")
    computing: _Samples = Field(0, description="dead time of computing, samples")
    transmission: _Samples = Field(0, description="dead time of passing it on, samples")

    @property
    def timing(self) -> LoopTiming:
        """Timing of the loop."""
        return LoopTiming(self.sample_time, self.measuring, self.computing, self.transmission)


class PositionLoop(Loop):
    """Proportional position controller."""

    gain: quantity("gain", at_least=0.0) = Field(description="K_v; 0 for a spindle")
    velocity_limit: either_quantity("velocity", "angular_speed", above=0.0) | None = None
    set_point_delay: _Samples = 0

    def spec(self) -> PositionController:
        """The controller."""
        return PositionController(**arguments(self, PositionController, ("timing",)),
                                  timing=self.timing)  # fmt: skip


class ReferenceModelSection(Section):
    """Second-order lag before the integral part."""

    natural_frequency: quantity("frequency", above=0.0)
    damping: quantity("number", above=0.0)


class VelocityLoop(Loop):
    """PI velocity controller."""

    proportional_gain: either_quantity("rotational_damping", "damping", above=0.0) = Field(
        description="K_pn; N*s/m of a linear motor"
    )
    integral_time: quantity("time", above=0.0) | None = Field(
        None, description="T_nn; without it there is no integral part"
    )
    torque_limit: either_quantity("torque", "force", above=0.0) | None = None
    reference_model: ReferenceModelSection | None = None

    def spec(self) -> VelocityController:
        """The controller."""
        model = self.reference_model
        return VelocityController(
            **arguments(self, VelocityController, ("timing",)),
            timing=self.timing,
            reference_model=None if model is None else ReferenceModel(**model.model_dump()),
        )


_CURRENT = {
    "ideal": IdealCurrentLoop,
    "first order": FirstOrderCurrentLoop,
    "second order": SecondOrderCurrentLoop,
    "motor": RegulatedMotor,
}


class CurrentLoopSection(Loop):
    """How the torque follows its set point; the kind says which keys it has."""

    kind: Literal["ideal", "first order", "second order", "motor"] = "ideal"
    time_constant: quantity("time", above=0.0) | None = None
    natural_frequency: quantity("frequency", above=0.0) | None = None
    damping: quantity("number", above=0.0) | None = None
    resistance: quantity("resistance", above=0.0) | None = None
    inductance: quantity("inductance", above=0.0) | None = None
    torque_constant: either_quantity("torque_constant", "force_constant", above=0.0) | None = None
    proportional_gain: quantity("resistance", above=0.0) | None = Field(
        None, description="K_p of the current controller, V/A"
    )
    integral_time: quantity("time", above=0.0) | None = None
    back_emf: either_quantity("back_emf", "linear_back_emf", at_least=0.0) | None = None
    voltage_limit: quantity("voltage", above=0.0) | None = None

    @model_validator(mode="after")
    def _check_kind(self) -> CurrentLoopSection:
        raise_if_any(key_problems(self, "kind", fields_of(_CURRENT[self.kind]), _TIMING))
        return self

    def spec(self) -> IdealCurrentLoop:
        """The current loop."""
        return _CURRENT[self.kind](**arguments(self, _CURRENT[self.kind]))


_FILTERS = {
    "second order": (SecondOrderFilter, fields_of(SecondOrderFilter)),
    "low pass": (low_pass, {"frequency": True, "damping": False}),
    "notch": (notch, {"frequency": True, "numerator_damping": True, "denominator_damping": True}),
}


class FilterSection(Section):
    """Filter of the torque set point; the kind says which keys it has."""

    kind: Literal["second order", "low pass", "notch"] = "second order"
    frequency: quantity("frequency", above=0.0) | None = None
    damping: quantity("number", above=0.0) | None = None
    numerator_frequency: quantity("frequency", above=0.0) | None = None
    numerator_damping: quantity("number", at_least=0.0) | None = None
    denominator_frequency: quantity("frequency", above=0.0) | None = None
    denominator_damping: quantity("number", above=0.0) | None = None

    @model_validator(mode="after")
    def _check_kind(self) -> FilterSection:
        raise_if_any(key_problems(self, "kind", _FILTERS[self.kind][1]))
        return self

    def spec(self) -> SecondOrderFilter:
        """The filter."""
        make, keys = _FILTERS[self.kind]
        given = {key: getattr(self, key) for key in keys}
        return make(**{key: value for key, value in given.items() if value is not None})


class FeedforwardSection(Section):
    """Feedforward of velocity and torque, with delays in samples of their loops."""

    velocity: quantity("number", at_least=0.0) = Field(0.0, description="share; 1: in full")
    velocity_delay: _Samples = 0
    inertia: either_quantity("moment_of_inertia", "mass", at_least=0.0) = Field(
        0.0, description="at the motor, fed forward; a mass for a linear motor"
    )
    torque_delay: _Samples = 0


class MeasuringSection(Section):
    """What position and velocity controller measure."""

    position: Literal["encoder", "scale"] = "encoder"
    velocity: Literal["motor", "difference"] = "motor"
    encoder_resolution: either_quantity("angle", "length", at_least=0.0) = 0.0
    scale_resolution: either_quantity("length", "angle", at_least=0.0) = 0.0


class ControlSection(Section):
    """Cascade of a drive; its transmission comes from the drive."""

    position: PositionLoop
    velocity: VelocityLoop
    current: CurrentLoopSection
    filters: tuple[FilterSection, ...] = ()
    feedforward: FeedforwardSection = FeedforwardSection()
    measuring: MeasuringSection = MeasuringSection()
    motors: Literal["together", "each"] = Field(
        "together", description="one controller for all motors of the axis, or one each"
    )

    def spec(self, transmission: float) -> DriveController:
        """The controller.

        The transmission is the travel of the axis per angle of the motor, m/rad. Raises
        ControlError if sample times are not nested, or a filter lies above its Nyquist frequency.
        """
        return DriveController(
            position=self.position.spec(),
            velocity=self.velocity.spec(),
            measuring=MeasuringSystem(transmission, **self.measuring.model_dump()),
            current_timing=self.current.timing,
            current=self.current.spec(),
            filters=tuple(one.spec() for one in self.filters),
            feedforward=Feedforward(**self.feedforward.model_dump()),
        )
