"""Measuring systems of a drive: motor encoder (semi-closed loop) and direct scale.

A resolution rounds the position to the nearest count. The velocity that the controller sees is
either that of the motor itself, or the difference of two encoder positions over its sample time,
which delays it by half a sample and turns a resolution into velocity noise.
"""

import math
from dataclasses import dataclass
from typing import Literal

from numba.extending import register_jitable

from dynamics.compiled import INLINED
from dynamics.control.sampling import ControlError, require_not_negative, require_positive


@dataclass(frozen=True)
class MeasuringSystem:
    """What the position and velocity controllers measure.

    Raises
    ------
    ControlError
        If the transmission is zero, a resolution negative or a choice unknown.
    """

    #: axis displacement per motor angle, m/rad: lead/(2 pi) of a ball screw; 1 for a spindle or a
    #: direct drive
    transmission: float
    #: encoder: motor angle times transmission (semi-closed loop); scale: position of the slide
    #: (direct measuring system)
    position: Literal["encoder", "scale"] = "encoder"
    #: that of the motor as it is, or the difference of encoder positions over a sample
    velocity: Literal["motor", "difference"] = "motor"
    encoder_resolution: float = 0.0  # rad per count; 0: none
    scale_resolution: float = 0.0  # m per count; 0: none

    def __post_init__(self):
        part = "measuring system"
        if math.isnan(self.transmission):
            raise ControlError(f"{part}: transmission is {self.transmission}")
        require_positive(part, "size of the transmission", abs(self.transmission))
        require_not_negative(part, "encoder resolution", self.encoder_resolution)
        require_not_negative(part, "scale resolution", self.scale_resolution)
        if self.position not in ("encoder", "scale"):
            raise ControlError(f"{part}: position is {self.position!r}; encoder or scale")
        if self.velocity not in ("motor", "difference"):
            raise ControlError(f"{part}: velocity is {self.velocity!r}; motor or difference")


@register_jitable(**INLINED)
def quantised(value, resolution):
    """Value rounded to the nearest count; resolution 0 leaves it as it is."""
    if resolution > 0.0:
        return resolution * math.floor(value / resolution + 0.5)
    return value
