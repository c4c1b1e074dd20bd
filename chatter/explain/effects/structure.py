"""Effects of the structure: a frequency that shifts, contact, dry friction."""

import itertools
import math

import numpy as np

from chatter.compile.machine_cut import machine_cut
from chatter.description.case import Case
from chatter.explain.effects.effect import Effect, Patch, Reported, Values, free
from chatter.explain.measurement import Measurement
from chatter.explain.parameters import Parameter

#: modes of which each may shift alone
_MOST_MODES = 4
#: speeds of a table, over that of the declared case, and the least frequency over that at rest
_TABLE_SPEEDS, _LEAST_FREQUENCY = np.linspace(0.0, 3.0, 61), 0.05
#: force of a typical cut where none was measured, N
_TYPICAL_FORCE = 100.0
#: speeds that a shift needs, and share by which they differ: a nominal speed is found to the rpm
_LEAST_SPEEDS, _APART = 3, 0.01


def stiffness_of(frequency: float, mass: float) -> float:
    """Modal stiffness, N/m, of a frequency, Hz, and a modal mass, kg."""
    return mass * (2.0 * math.pi * frequency) ** 2


def has_modes(measurement: Measurement) -> bool:
    """Whether the declared structure is one of modes."""
    case = measurement.case
    return case.structure is not None and bool(case.structure.mode)


def _speeds_apart(measurement: Measurement) -> int:
    """Number of spindle speeds of the runs that are speeds of their own."""
    cuts = (run.of(measurement.case).cut for run in measurement.runs)
    speeds = sorted(cut.spindle_speed for cut in cuts if cut is not None)
    return 1 + sum(b - a > _APART * b for a, b in itertools.pairwise(speeds))


class ModeShift(Effect):
    """Natural frequencies in proportion to the spindle speed."""

    name = "mode_shift"
    label = "speed-dependent natural frequencies"
    help = "natural frequencies change with the spindle speed"
    kinds = ("milling", "stability")

    @property
    def variants(self) -> tuple[Effect, ...]:
        """All modes alike, or one of them; with the speed or its square."""
        single = (ModeShiftOf(mode, square) for mode in range(_MOST_MODES) for square in (0, 1))
        return (self, *single)

    @property
    def richer(self) -> tuple[Effect, ...]:
        """Each mode in its own way."""
        return (ModeShiftOfEach(),)

    def applies(self, measurement: Measurement) -> bool:
        """Of modes at several speeds."""
        return has_modes(measurement) and (
            "stability" in measurement.kinds or _speeds_apart(measurement) >= _LEAST_SPEEDS
        )

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Relative change of the frequencies with the speed: one in a thousand at 1000 rpm."""
        return [free("slope", 0.0, 1e-5, "s/rad", lower=-1e-3, upper=1e-3)]

    def patch(self, case: Case, values: Values) -> Patch:
        """Slope of every mode."""
        return {
            f"structure.mode[{index}].frequency_slope": float(values["slope"])
            for index in range(len(case.structure.mode))
        }

    def starts(self, measurement: Measurement) -> list[Values]:
        """Falling and rising."""
        return [{"slope": value} for value in (0.0, 2e-5, -2e-5, 6e-5, -6e-5)]


class ModeShiftOfEach(ModeShift):
    """Natural frequencies that change with the speed and its square, each mode in its own way."""

    kinds = ("milling",)

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Relative change with the speed, and with its square over that of the declared case."""
        return [
            free(f"{key}_{mode + 1}", 0.0, 0.01, "", lower=-0.6, upper=1.0)
            for mode in self._shifted(measurement.case)
            for key in ("linear", "square")
        ]

    def patch(self, case: Case, values: Values) -> Patch:
        """Table of the frequency of each mode over the spindle speed."""
        given: Patch = {}
        for mode in self._shifted(case):
            linear, square = (values.get(f"{key}_{mode + 1}", 0.0) for key in ("linear", "square"))
            declared = case.structure.mode[mode]
            share = _TABLE_SPEEDS
            factor = np.maximum(1.0 + linear * share + square * share**2, _LEAST_FREQUENCY)
            table = declared.speed_dependence
            given[f"structure.mode[{mode}].speed_dependence"] = {
                **({} if table is None else table.model_dump(exclude_none=True)),
                "speeds": (case.cut.spindle_speed * share).tolist(),
                "frequency": (declared.frequency * factor).tolist(),
            }
        return given

    def applies(self, measurement: Measurement) -> bool:
        """Of modes without a table over the speed."""
        modes = measurement.case.structure.mode if measurement.case.structure else ()
        alone = all(mode.speed_dependence is None for mode in modes)
        return super().applies(measurement) and alone and self._is_other(len(modes))

    def starts(self, measurement: Measurement) -> list[Values]:
        """No shift: what follows is nearly linear in it."""
        return [{}]

    def _is_other(self, modes: int) -> bool:
        """Whether it is another effect than that of all modes, where there are so many."""
        return modes > 0

    def _shifted(self, case: Case) -> tuple[int, ...]:
        return tuple(range(min(len(case.structure.mode), _MOST_MODES)))


class ModeShiftOf(ModeShiftOfEach):
    """Natural frequency of one mode with the spindle speed, or with its square."""

    def __init__(self, mode: int, square: int) -> None:
        self.mode = mode
        self.key = ("linear", "square")[square]

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Relative change at the speed of the declared case."""
        own = f"{self.key}_{self.mode + 1}"
        return [one for one in super().parameters(measurement) if one.name == own]

    def reported(self, values: Values) -> Reported:
        """Relative change at the speed of the declared case, with which power, of which mode."""
        change = values[f"{self.key}_{self.mode + 1}"]
        power = 1.0 if self.key == "linear" else 2.0
        return {"change": (change, ""), "power": (power, ""), "mode": (self.mode + 1.0, "")}

    def _is_other(self, modes: int) -> bool:
        return self.mode < modes and (modes > 1 or self.key == "square")

    def _shifted(self, case: Case) -> tuple[int, ...]:
        return (self.mode,)


class Contact(Effect):
    """Spring and damper between tool and workpiece, in proportion to the engaged depth.

    From `full_engagement_share`, of the depth engaged, on, the contact is whole.
    """

    name = "contact"
    label = "tool-workpiece contact"
    help = "tool and workpiece touch like a spring and a damper while in the cut"

    kinds = ("milling", "frf")
    section = "contact"
    # surfaces that touch hold each other: what only damps in the cut is something else
    essential = ("stiffness",)

    def __init__(self, full_engagement_share: float = 1.0) -> None:
        self.full_engagement_share = full_engagement_share

    @property
    def variants(self) -> tuple[Effect, ...]:
        """In proportion to the engaged depth, or whole as soon as an edge cuts."""
        return (self, ContactAtOnce(1e-3))

    def applies(self, measurement: Measurement) -> bool:
        """Of modes, or a machine, without a contact."""
        case = measurement.case
        if case.on_machine:
            return case.contact is None and case.machine_file().contact is None
        return has_modes(measurement) and case.contact is None

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Stiffness and damping."""
        stiffness, lowest = self._softest(measurement.case)
        damping = 0.01 * stiffness / (2.0 * math.pi * lowest)
        return [
            free("stiffness", 0.0, 0.01 * stiffness, "N/m", lower=0.0),
            free("damping", 0.0, damping, "N*s/m", lower=0.0),
        ]

    def _softest(self, case: Case) -> tuple[float, float]:
        """Least modal stiffness at the tool point, N/m, and lowest frequency, Hz."""
        if case.on_machine:
            modes = machine_cut(case).modes()
            return min(one.stiffness for one in modes), min(one.frequency for one in modes)
        given = case.structure.mode
        stiffness = min(stiffness_of(one.frequency, one.modal_mass) for one in given)
        return stiffness, min(one.frequency for one in given)

    def patch(self, case: Case, values: Values) -> Patch:
        """The contact."""
        share = {"contact.full_engagement_share": self.full_engagement_share}
        return {**super().patch(case, values), **share}


class ContactAtOnce(Contact):
    """Contact that is whole as soon as an edge cuts."""

    kinds = ("milling",)


class SlideFriction(Effect):
    """Dry friction on every mode, and the velocity below which it falls to zero."""

    name = "slide_friction"
    label = "friction on a mode"
    help = "dry friction rubs on a mode of the structure"
    kinds = ("milling",)

    def applies(self, measurement: Measurement) -> bool:
        """Of modes without friction."""
        return has_modes(measurement) and not any(
            mode.friction for mode in measurement.case.structure.mode
        )

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Friction of every mode, and the smoothing velocity."""
        size = self._size(measurement)
        modes = range(1, len(measurement.case.structure.mode) + 1)
        return [
            *(free(f"coulomb_{mode}", 0.0, size, "N", lower=0.0) for mode in modes),
            Parameter("smoothing_velocity", 1e-3, 5e-4, 5e-5, 2e-2, True, "m/s"),
        ]

    def patch(self, case: Case, values: Values) -> Patch:
        """Friction laws, and the modes that they act on."""
        given: Patch = {}
        for index in range(len(case.structure.mode)):
            # a mode that another effect adds has none
            coulomb = float(values.get(f"coulomb_{index + 1}", 0.0))
            if coulomb > 0.0:
                given[f"friction.slide_{index + 1}"] = {
                    "law": "smooth-coulomb",
                    "coulomb": coulomb,
                    "smoothing_velocity": float(values["smoothing_velocity"]),
                }
                given[f"structure.mode[{index}].friction"] = f"slide_{index + 1}"
        return given

    def starts(self, measurement: Measurement) -> list[Values]:
        """On each of the modes."""
        modes = range(1, len(measurement.case.structure.mode) + 1)
        return [{f"coulomb_{mode}": self._size(measurement)} for mode in modes]

    def reported(self, values: Values) -> Reported:
        """The strongest friction, on which mode, counted from 1, and the others."""
        levels = {key: value for key, value in values.items() if key.startswith("coulomb_")}
        strongest = max(levels, key=levels.__getitem__)
        return {
            "coulomb": (levels[strongest], "N"),
            "mode": (float(strongest.rpartition("_")[2]), ""),
            "smoothing_velocity": (values["smoothing_velocity"], "m/s"),
            **{key: (level, "N") for key, level in levels.items() if key != strongest},
        }

    @staticmethod
    def _size(measurement: Measurement) -> float:
        """Share of the typical in-plane force, N."""
        forces = [
            float(np.sqrt(np.mean(run.signals[name] ** 2)))
            for run in measurement.runs
            for name in ("Fx", "Fy")
            if name in run.signals
        ]
        return 0.1 * (float(np.median(forces)) if forces else _TYPICAL_FORCE)
