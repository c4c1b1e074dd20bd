"""Effects of the tool: runout, pitch, wear."""

import math

import numpy as np

from chatter.description.case import Case
from chatter.explain.effects.effect import Effect, Patch, Reported, Values, free, polar
from chatter.explain.fitting import Parameter
from chatter.explain.measurement import Measurement


class Runout(Effect):
    """Offset in two directions, so that none of them is singular where there is none."""

    name = "runout"
    label = "radial runout"
    help = "the teeth run off the spindle axis"
    kinds = ("milling",)

    def applies(self, measurement: Measurement) -> bool:
        """Of several teeth whose runout is not declared."""
        return measurement.case.tool.runout is None and measurement.case.tool.teeth > 1

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Offset across and along the first tooth."""
        most = 0.1 * measurement.case.tool.diameter
        return [free(key, 0.0, 3e-6, "m", lower=-most, upper=most) for key in ("across", "along")]

    def patch(self, case: Case, values: Values) -> Patch:
        """Runout of the tool."""
        offset, angle = polar(values["across"], values["along"])
        return {"tool.runout": {"offset": offset, "angle": angle}}

    def reported(self, values: Values) -> Reported:
        """Offset and angle."""
        offset, angle = polar(values["across"], values["along"])
        return {"offset": (offset, "m"), "angle": (angle, "rad")}


class Pitch(Effect):
    """Teeth turned from where they are declared, the first standing still."""

    name = "pitch"
    label = "tooth pitch"
    help = "the teeth do not stand where they should"
    kinds = ("milling",)

    def applies(self, measurement: Measurement) -> bool:
        """Of several teeth."""
        return measurement.case.tool.teeth > 1

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Angle by which every tooth but the first is off."""
        teeth = range(2, measurement.case.tool.teeth + 1)
        return [free(f"tooth_{k}", 0.0, 0.01, "rad", lower=-0.3, upper=0.3) for k in teeth]

    def patch(self, case: Case, values: Values) -> Patch:
        """Pitch of the tool."""
        teeth = case.tool.teeth
        declared = np.asarray(case.tool.pitch or (2.0 * math.pi / teeth,) * teeth)
        angles = np.concatenate([[0.0], np.cumsum(declared)[:-1]])
        angles[1:] += [values[f"tooth_{k}"] for k in range(2, teeth + 1)]
        return {"tool.pitch": np.diff(np.append(angles, 2.0 * math.pi)).tolist()}


class Wear(Effect):
    """Forces that grow with the cut time of the runs."""

    name = "wear"
    label = "tool wear"
    help = "forces grow with the time that the tool has cut"
    kinds = ("milling",)
    section = "wear"

    def applies(self, measurement: Measurement) -> bool:
        """Of runs at several cut times."""
        return len({run.cut_time for run in measurement.runs}) > 2

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Growth of the edge forces and of the cutting forces a second."""
        longest = max(run.cut_time for run in measurement.runs)
        return [
            free("edge_tangential", 0.0, 3e3 / longest, "N/m/s"),
            free("edge_radial", 0.0, 3e3 / longest, "N/m/s"),
            free("cutting", 0.0, 0.02 / longest, "1/s"),
        ]
