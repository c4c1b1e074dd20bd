"""Specification of a sampled cascade: position, velocity and current controller of one drive.

The structure is that of numerical controls: a proportional position controller (K_v), a PI
velocity controller (K_pn, T_nn) whose integral part may follow a reference model, set-point
filters, a current loop, and feedforward of velocity and torque with delays of their own. Each
loop has its sample time, and whole samples of dead time for measuring, computing and
transmission. Within one instant the loops are evaluated from the outside to the inside.

A spindle under velocity control has position gain 0 and velocity feedforward 1; its velocity set
point is v_set.
"""

import math
from dataclasses import dataclass

from dynamics.control.current_loop import CurrentLoop, IdealCurrentLoop
from dynamics.control.filters import ReferenceModel, SecondOrderFilter
from dynamics.control.measurement import MeasuringSystem
from dynamics.control.sampling import (
    require_limit,
    require_not_negative,
    require_positive,
    require_samples,
    whole_ratio,
)


@dataclass(frozen=True)
class LoopTiming:
    """Sample time and dead times of one loop.

    Parameters
    ----------
    sample_time : float
        s.
    measuring, computing, transmission : int
        Dead times in samples of this loop: measuring delays what it measures, computing and
        transmission delay what it puts out.

    Raises
    ------
    ControlError
        If the sample time is not above 0 or a dead time no whole number of samples.
    """

    sample_time: float
    measuring: int = 0
    computing: int = 0
    transmission: int = 0

    def __post_init__(self):
        require_positive("loop timing", "sample time", self.sample_time)
        for key in ("measuring", "computing", "transmission"):
            require_samples("loop timing", f"{key} dead time", getattr(self, key))

    @property
    def output_delay(self) -> int:
        """Samples from reading the measurement to the output taking effect."""
        return self.computing + self.transmission


@dataclass(frozen=True)
class PositionController:
    """v = K_v (x_set - x).

    Raises
    ------
    ControlError
        If a value is out of its range.
    """

    gain: float  # K_v, 1/s; 1 m/(min mm) is 16.67 1/s
    timing: LoopTiming
    #: of the velocity set point with feedforward, m/s (rad/s for a rotary axis)
    velocity_limit: float = math.inf
    #: samples by which the set point is delayed against the measured position, so that it meets the
    #: feedforward's motion
    set_point_delay: int = 0

    def __post_init__(self):
        require_not_negative("position controller", "gain", self.gain)
        require_limit("position controller", "velocity limit", self.velocity_limit)
        require_samples("position controller", "set point delay", self.set_point_delay)


@dataclass(frozen=True)
class VelocityController:
    """M = K_pn (n_set - n) + sum of K_pn T/T_nn (reference model of n_set - n).

    The sum includes the present sample, and grows no further than to where M meets its limit
    (conditional integration; Åström and Hägglund 2006, Advanced PID Control, section 3.5).

    Raises
    ------
    ControlError
        If a value is out of its range.
    """

    proportional_gain: float  # K_pn, N m s/rad
    timing: LoopTiming
    integral_time: float = math.inf  # T_nn, s; infinite: no integral part
    #: N m, of the controller's output and of the set point behind the filters
    torque_limit: float = math.inf
    reference_model: ReferenceModel | None = None

    def __post_init__(self):
        part = "velocity controller"
        require_positive(part, "proportional gain", self.proportional_gain)
        require_limit(part, "integral time", self.integral_time)
        require_limit(part, "torque limit", self.torque_limit)


@dataclass(frozen=True)
class Feedforward:
    """Velocity and torque that the set points ask for, added behind the controllers.

    Set points are read with the position loop; the torque enters before the set-point filters.

    Raises
    ------
    ControlError
        If a value is out of its range.
    """

    velocity: float = 0.0  # share of the velocity set point; 1: in full, 0: none
    velocity_delay: int = 0  # samples of the position loop
    inertia: float = 0.0  # moment of inertia at the motor that is fed forward, kg m^2; 0: none
    torque_delay: int = 0  # samples of the velocity loop

    def __post_init__(self):
        require_not_negative("feedforward", "velocity", self.velocity)
        require_not_negative("feedforward", "inertia", self.inertia)
        require_samples("feedforward", "velocity delay", self.velocity_delay)
        require_samples("feedforward", "torque delay", self.torque_delay)


@dataclass(frozen=True)
class DriveController:
    """Cascade of one drive.

    Raises
    ------
    ControlError
        If the sample times are not nested: position a whole multiple of velocity, velocity of
        current; or if a filter lies above the Nyquist frequency of its loop.
    """

    position: PositionController
    velocity: VelocityController
    measuring: MeasuringSystem
    current_timing: LoopTiming  # of the current loop and of the set-point filters
    current: CurrentLoop = IdealCurrentLoop()  # noqa: RUF009
    filters: tuple[SecondOrderFilter, ...] = ()  # of the current (torque) set point, in series
    feedforward: Feedforward = Feedforward()

    def __post_init__(self):
        p, v, c = (timing.sample_time for timing in self.timings)
        whole_ratio("position", p, "the velocity loop's", v)
        whole_ratio("velocity", v, "the current loop's", c)
        for one in self.filters:
            one.sampled(c)
        if self.velocity.reference_model is not None:
            self.velocity.reference_model.sampled(v)

    @property
    def timings(self) -> tuple[LoopTiming, LoopTiming, LoopTiming]:
        """Timing of position, velocity and current loop."""
        return self.position.timing, self.velocity.timing, self.current_timing

    def steps_per_sample(self, step: float) -> tuple[int, int, int]:
        """Return the steps per sample of the position, velocity and current loop.

        The step is that of the simulation, s. Raises ControlError if it is not a number above 0 or
        a sample time is not a whole multiple of it; the message names loop, sample time and step.
        """
        require_positive("simulation", "step", step)
        names = ("position", "velocity", "current")
        return tuple(
            whole_ratio(name, timing.sample_time, "the simulation step", step)
            for name, timing in zip(names, self.timings, strict=True)
        )

    @property
    def integral_gain(self) -> float:
        """Torque per velocity deviation and sample of the integral part, N m s/rad."""
        velocity = self.velocity
        return velocity.proportional_gain * velocity.timing.sample_time / velocity.integral_time
