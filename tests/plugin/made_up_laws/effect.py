"""The weight of a slide on a guide that is not level."""

from __future__ import annotations

import math

from chatter.explain.effects.effect import Effect, free

GRAVITY = 9.81  # m/s^2


class TiltedGuide(Effect):
    name = "tilted_guide"
    label = "tilted guide"
    help = "a share of the weight acts along the axis"
    kinds = ("axis",)

    def applies(self, measurement):
        return measurement.case.axis.offset == 0.0

    def parameters(self, measurement):
        return [free("tilt", 0.0, 0.05, "rad", lower=-0.5, upper=0.5)]

    def patch(self, case, values):
        return {"axis.offset": case.axis.moving_mass * GRAVITY * math.sin(values["tilt"])}


EFFECT = TiltedGuide()
