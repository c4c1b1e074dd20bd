"""Effects of the tool: runout, pitch, wear."""

import math
from itertools import pairwise

import numpy as np

from chatter.description.case import Case
from chatter.explain.effects.effect import Effect, Patch, Reported, Values, free, polar
from chatter.explain.measurement import Measurement
from chatter.explain.parameters import Parameter

#: directions within a pitch where teeth are not known, and offset, m, from which runout is sought
_DIRECTIONS, _FIRST_OFFSET = 3, 5e-6
#: the same as a share of the feed per tooth: where one tooth hardly cuts is another minimum
_OFFSET_OF_FEED = 0.25


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

    def starts(self, measurement: Measurement) -> list[Values]:
        """None and little all round; where no tooth is known, in directions within a pitch.

        What a tooth cuts has a kink where there is no runout. Where no tooth is known, every run
        chooses its own, and a start without runout leaves that to chance.
        """
        if all(getattr(run.record, "knows_tooth", True) for run in measurement.runs):
            around = [(_FIRST_OFFSET, 0.0), (0.0, _FIRST_OFFSET)]
            little = [(sign * a, sign * b) for sign in (1.0, -1.0) for a, b in around]
            return [{}, *({"across": across, "along": along} for across, along in little)]
        pitch = 2.0 * math.pi / measurement.case.tool.teeth
        angles = pitch * np.arange(_DIRECTIONS) / _DIRECTIONS
        feeds = [run.of(measurement.case).cut.feed_per_tooth for run in measurement.runs]
        offsets = (_FIRST_OFFSET, _OFFSET_OF_FEED * float(np.median(feeds)))
        return [
            {"across": offset * math.cos(angle), "along": offset * math.sin(angle)}
            for offset in offsets
            for angle in angles
        ]

    def patch(self, case: Case, values: Values) -> Patch:
        """Runout of the tool."""
        offset, angle = polar(values["along"], values["across"])
        return {"tool.runout": {"offset": offset, "angle": angle}}

    def reported(self, values: Values) -> Reported:
        """Offset and angle."""
        offset, angle = polar(values["along"], values["across"])
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


#: shares of the longest cut time after which wear may saturate
_SATURATIONS = (0.15, 0.4, 1.0)


class Wear(Effect):
    """Forces that grow with the cut time of the runs."""

    name = "wear"
    label = "tool wear"
    help = "forces grow with the time that the tool has cut"
    kinds = ("milling",)
    section = "wear"

    @property
    def richer(self) -> tuple[Effect, ...]:
        """Less and less, or at once; of every coefficient by itself."""
        return (SaturatingWear(), Chipping(), WearOfAll())

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
            *self._of_process_damping(measurement, 0.1 / longest, "1/s"),
        ]

    @staticmethod
    def _of_process_damping(measurement: Measurement, size: float, unit: str) -> list[Parameter]:
        """Growth of the process damping, where there is any."""
        declared = measurement.case.process_damping
        if declared is None or not declared.coefficient:
            return []
        return [free("process_damping", 0.0, size, unit)]


class _OfAll(Effect):
    """Growth of the radial cutting coefficient by itself, and of a process damping from nothing."""

    @property
    def richer(self) -> tuple[Effect, ...]:
        """None that has more."""
        return ()

    def _of_all(self, measurement: Measurement, time: float, per_time: str) -> list[Parameter]:
        """Growth of each within a time, s; one of a step."""
        radial = free("cutting_radial", 0.0, 0.02 / time, per_time)
        if measurement.case.process_damping is not None:
            return [radial]
        unit = "N/m/s" if per_time else "N/m"
        return [radial, free("ploughing", 0.0, 2e4 / time, unit, lower=0.0)]


class WearOfAll(_OfAll, Wear):
    """Every coefficient and the process damping grow with the cut time of the runs."""

    @property
    def richer(self) -> tuple[Effect, ...]:
        """The same less and less, or at once."""
        return (SaturatingWearOfAll(), ChippingOfAll())

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Growth a second."""
        longest = max(run.cut_time for run in measurement.runs)
        return [*super().parameters(measurement), *self._of_all(measurement, longest, "1/s")]


class SaturatingWear(Wear):
    """Forces that grow less and less with the cut time of the runs."""

    @property
    def richer(self) -> tuple[Effect, ...]:
        """The same of every coefficient by itself."""
        return (SaturatingWearOfAll(),)

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Growth at first, and the time in which it dies away."""
        longest = max(run.cut_time for run in measurement.runs)
        bounds = {"lower": 0.02 * longest, "upper": 20.0 * longest}
        time = free("saturation_time", 0.5 * longest, 0.1 * longest, "s", **bounds)
        return [*super().parameters(measurement), time]

    def starts(self, measurement: Measurement) -> list[Values]:
        """Early and late."""
        longest = max(run.cut_time for run in measurement.runs)
        return [{"saturation_time": share * longest} for share in _SATURATIONS]


class SaturatingWearOfAll(_OfAll, SaturatingWear):
    """Every coefficient and the process damping grow less and less."""

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Growth at first, and the time in which it dies away."""
        longest = max(run.cut_time for run in measurement.runs)
        return [*super().parameters(measurement), *self._of_all(measurement, longest, "1/s")]


class Chipping(Wear):
    """Forces that grow at once, at some cut time between two runs."""

    @property
    def richer(self) -> tuple[Effect, ...]:
        """The same of every coefficient by itself."""
        return (ChippingOfAll(),)

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Growth, and when it comes."""
        times = sorted({run.cut_time for run in measurement.runs})
        return [
            free("edge_tangential", 0.0, 3e3, "N/m"),
            free("edge_radial", 0.0, 3e3, "N/m"),
            free("cutting", 0.0, 0.02, ""),
            *self._of_process_damping(measurement, 0.1, ""),
            free("time", times[1], 0.1 * times[-1], "s", lower=times[0], upper=times[-1]),
        ]

    def patch(self, case: Case, values: Values) -> Patch:
        """Chipping of the edge."""
        return {"wear.chipping": {key: float(value) for key, value in values.items()}}

    def starts(self, measurement: Measurement) -> list[Values]:
        """Between every two runs."""
        times = sorted({run.cut_time for run in measurement.runs})
        return [{"time": 0.5 * (one + other)} for one, other in pairwise(times)]


class ChippingOfAll(_OfAll, Chipping):
    """Every coefficient and the process damping grow at once."""

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Growth, and when it comes."""
        return [*super().parameters(measurement), *self._of_all(measurement, 1.0, "")]
