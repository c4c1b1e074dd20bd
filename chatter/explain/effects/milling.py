"""Effects of the cut, the tool and the structure."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from chatter.description.case import Case
from chatter.explain.kinds.kind import Effect
from chatter.explain.measurement import Measurement
from chatter.explain.selection.fitting import Parameter

Values = Mapping[str, float]
Assignments = dict[str, Any]

#: reference thickness of the exponential law where the case has none, m
_H0 = 1e-4
#: tangential over radial process damping where the case does not say
_FRICTION = 0.3
_TURN = 2.0 * math.pi


def _free(name: str, start: float, size: float, unit: str, **bounds: float) -> Parameter:
    """A parameter without a prior."""
    return Parameter(name, start, size, prior=False, unit=unit, **bounds)


def _always(_: Measurement) -> bool:
    return True


# runout ------------------------------------------------------------------------------------------


def _runout_parameters(measurement: Measurement) -> Sequence[Parameter]:
    most = 0.1 * measurement.case.tool.diameter
    return [_free(axis, 0.0, 3e-6, "m", lower=-most, upper=most) for axis in ("across", "along")]


def _runout(case: Case, values: Values) -> Assignments:  # noqa: ARG001
    """Offset in two directions, so that none of them is singular where there is none."""
    offset = math.hypot(values["across"], values["along"])
    angle = math.atan2(values["along"], values["across"])
    return {"tool.runout": {"offset": offset, "angle": angle % _TURN}}


def _runout_told(values: Values) -> Mapping[str, tuple[float, str]]:
    offset = math.hypot(values["across"], values["along"])
    angle = math.atan2(values["along"], values["across"])
    return {"offset": (offset, "m"), "angle": (angle % _TURN, "rad")}


# edge force --------------------------------------------------------------------------------------


def _edge_parameters(measurement: Measurement) -> Sequence[Parameter]:  # noqa: ARG001
    return [_free(key, 0.0, 5e3, "N/m", lower=0.0) for key in ("Kte", "Kre")]


def _edge(case: Case, values: Values) -> Assignments:  # noqa: ARG001
    return {"material.Kte": values["Kte"], "material.Kre": values["Kre"]}


def _no_edge_force(measurement: Measurement) -> bool:
    material = measurement.case.material
    return material.law != "oblique" and not (material.Kte or material.Kre)


# process damping ---------------------------------------------------------------------------------


def _process_damping_parameters(measurement: Measurement) -> Sequence[Parameter]:  # noqa: ARG001
    return [_free("coefficient", 0.0, 5e4, "N/m", lower=0.0)]


def _process_damping(case: Case, values: Values) -> Assignments:
    friction = case.process_damping.friction if case.process_damping else _FRICTION
    return {"process_damping": {"coefficient": float(values["coefficient"]), "friction": friction}}


def _process_damping_starts(measurement: Measurement) -> Sequence[Values]:  # noqa: ARG001
    return [{"coefficient": value} for value in (0.0, 5e4, 2e5, 8e5)]


# chip exponent -----------------------------------------------------------------------------------


def _exponent_parameters(measurement: Measurement) -> Sequence[Parameter]:  # noqa: ARG001
    return [_free("exponent", 1.0, 0.03, "", lower=0.3, upper=1.0)]


def _exponent(case: Case, values: Values) -> Assignments:
    return {
        "material.law": "exponential",
        "material.h0": case.material.h0 or _H0,
        "material.exponent": float(values["exponent"]),
    }


# missing mode ------------------------------------------------------------------------------------


def _mode_parameters(measurement: Measurement) -> Sequence[Parameter]:
    modes = measurement.case.structure.mode
    compliance = max(1.0 / (m.modal_mass * (_TURN * m.frequency) ** 2) for m in modes)
    return [
        _free("frequency", 300.0, 5.0, "Hz", lower=5.0, upper=2e4),
        Parameter("damping", 0.03, 0.01, 0.002, 0.3, True, ""),
        _free("compliance", 0.01 * compliance, 0.02 * compliance, "m/N", lower=0.0),
        _free("angle", 0.0, 0.3, "rad"),
    ]


def _missing_mode(case: Case, values: Values) -> Assignments:
    frequency = float(values["frequency"])
    stiffness = 1.0 / max(float(values["compliance"]), 1e-16)
    angle = float(values["angle"])
    known = [mode.model_dump(exclude_none=True) for mode in case.structure.mode]
    added = {
        "frequency": frequency,
        "damping": float(values["damping"]),
        "mass": stiffness / (_TURN * frequency) ** 2,
        "direction": [math.cos(angle), math.sin(angle), 0.0],
        "side": "tool",
    }
    return {"structure.mode": [*known, added]}


def _mode_told(values: Values) -> Mapping[str, tuple[float, str]]:
    """Frequency, damping, mass, and the direction as an angle from x within half a turn."""
    stiffness = 1.0 / max(values["compliance"], 1e-16)
    return {
        "frequency": (values["frequency"], "Hz"),
        "damping": (values["damping"], ""),
        "mass": (stiffness / (_TURN * values["frequency"]) ** 2, "kg"),
        "direction": (values["angle"] % math.pi, "rad"),
    }


def _mode_starts(measurement: Measurement) -> Sequence[Values]:
    """Frequencies around and between the known modes, along x and y."""
    known = sorted(mode.frequency for mode in measurement.case.structure.mode)
    frequencies = np.geomspace(0.3 * known[0], 2.5 * known[-1], 14)
    return [
        {"frequency": float(frequency), "angle": angle}
        for angle in (0.0, 0.5 * math.pi)
        for frequency in frequencies
    ]


# speed-dependent frequency -----------------------------------------------------------------------


def _several_speeds(measurement: Measurement) -> bool:
    if measurement.kind == "stability":
        return True
    speeds = {str(run.overrides.get("cut.spindle_speed")) for run in measurement.runs}
    return len(speeds) > 2


def _shift_parameters(measurement: Measurement) -> Sequence[Parameter]:  # noqa: ARG001
    # one part in a thousand at 1000 rpm
    return [_free("slope", 0.0, 1e-5, "s/rad", lower=-1e-3, upper=1e-3)]


def _shift(case: Case, values: Values) -> Assignments:
    return {
        f"structure.mode[{place}].frequency_slope": float(values["slope"])
        for place in range(len(case.structure.mode))
    }


def _shift_starts(measurement: Measurement) -> Sequence[Values]:  # noqa: ARG001
    return [{"slope": value} for value in (0.0, 2e-5, -2e-5, 6e-5, -6e-5)]


# pitch -------------------------------------------------------------------------------------------


def _pitch_parameters(measurement: Measurement) -> Sequence[Parameter]:
    teeth = measurement.case.tool.teeth
    return [
        _free(f"tooth_{place + 2}", 0.0, 0.01, "rad", lower=-0.3, upper=0.3)
        for place in range(teeth - 1)
    ]


def _pitch(case: Case, values: Values) -> Assignments:
    """Teeth turned from where they are declared, the first standing still."""
    teeth = case.tool.teeth
    declared = np.asarray(case.tool.pitch or (_TURN / teeth,) * teeth)
    places = np.concatenate([[0.0], np.cumsum(declared)[:-1]])
    places[1:] += [values[f"tooth_{place + 2}"] for place in range(teeth - 1)]
    return {"tool.pitch": np.diff(np.append(places, _TURN)).tolist()}


# wear --------------------------------------------------------------------------------------------


def _cut_times_differ(measurement: Measurement) -> bool:
    return len({run.cut_time for run in measurement.runs}) > 2


def _wear_parameters(measurement: Measurement) -> Sequence[Parameter]:
    longest = max(run.cut_time for run in measurement.runs)
    return [
        _free("edge_tangential", 0.0, 3e3 / longest, "N/m/s"),
        _free("edge_radial", 0.0, 3e3 / longest, "N/m/s"),
        _free("cutting", 0.0, 0.02 / longest, "1/s"),
    ]


def _wear(case: Case, values: Values) -> Assignments:  # noqa: ARG001
    keys = ("edge_tangential", "edge_radial", "cutting")
    return {"wear": {key: float(values[key]) for key in keys}}


# contact -----------------------------------------------------------------------------------------


def _contact_parameters(measurement: Measurement) -> Sequence[Parameter]:
    modes = measurement.case.structure.mode
    stiffness = min(m.modal_mass * (_TURN * m.frequency) ** 2 for m in modes)
    slowest = min(m.frequency for m in modes)
    return [
        _free("stiffness", 0.0, 0.01 * stiffness, "N/m", lower=0.0),
        _free("damping", 0.0, 0.01 * stiffness / (_TURN * slowest), "N*s/m", lower=0.0),
    ]


def _contact(full_at: float):
    def patch(case: Case, values: Values) -> Assignments:  # noqa: ARG001
        given = {key: float(values[key]) for key in ("stiffness", "damping")}
        return {"contact": {**given, "full_at": full_at}}

    return patch


# dynamometer -------------------------------------------------------------------------------------


def _forces_measured(measurement: Measurement) -> bool:
    return any("Fx" in run.signals for run in measurement.runs)


def _dynamometer_parameters(measurement: Measurement) -> Sequence[Parameter]:  # noqa: ARG001
    return [
        _free("frequency", 2000.0, 30.0, "Hz", lower=100.0, upper=5e4),
        Parameter("damping", 0.03, 0.02, 0.002, 0.7, True, ""),
    ]


def _dynamometer(case: Case, values: Values) -> Assignments:  # noqa: ARG001
    return {"dynamometer": {key: float(values[key]) for key in ("frequency", "damping")}}


def _dynamometer_starts(measurement: Measurement) -> Sequence[Values]:
    time = next(iter(measurement.runs)).signals["time"]
    highest = 0.5 / float(np.median(np.diff(time)))
    return [{"frequency": float(f)} for f in np.geomspace(400.0, 1.2 * highest, 14)]


# slide friction ----------------------------------------------------------------------------------


def _slide_parameters(measurement: Measurement) -> Sequence[Parameter]:
    """Friction on every mode, and the velocity below which it falls to zero."""
    size = 0.1 * _typical_force(measurement)
    modes = range(len(measurement.case.structure.mode))
    return [
        *(_free(f"coulomb_{place + 1}", 0.0, size, "N", lower=0.0) for place in modes),
        Parameter("smoothing_velocity", 1e-3, 5e-4, 5e-5, 2e-2, True, "m/s"),
    ]


def _typical_force(measurement: Measurement) -> float:
    forces = [
        float(np.sqrt(np.mean(run.signals[name] ** 2)))
        for run in measurement.runs
        for name in ("Fx", "Fy")
        if name in run.signals
    ]
    return float(np.median(forces)) if forces else 100.0


def _slide(case: Case, values: Values) -> Assignments:
    velocity = float(values["smoothing_velocity"])
    given: Assignments = {}
    for place in range(len(case.structure.mode)):
        coulomb = float(values[f"coulomb_{place + 1}"])
        if coulomb > 0.0:
            given[f"friction.slide_{place + 1}"] = {
                "law": "smooth-coulomb",
                "coulomb": coulomb,
                "smoothing_velocity": velocity,
            }
            given[f"structure.mode[{place}].friction"] = f"slide_{place + 1}"
    return given


def _slide_starts(measurement: Measurement) -> Sequence[Values]:
    force = 0.1 * _typical_force(measurement)
    modes = range(len(measurement.case.structure.mode))
    return [{f"coulomb_{place + 1}": force} for place in modes]


def _slide_told(values: Values) -> Mapping[str, tuple[float, str]]:
    """The strongest friction, on which mode, counted from 1, and the others."""
    levels = {key: v for key, v in values.items() if key.startswith("coulomb_")}
    strongest = max(levels, key=levels.__getitem__)
    return {
        "coulomb": (levels[strongest], "N"),
        "mode": (float(strongest.rpartition("_")[2]), ""),
        "smoothing_velocity": (values["smoothing_velocity"], "m/s"),
        **{key: (level, "N") for key, level in levels.items() if key != strongest},
    }


def _no_friction(measurement: Measurement) -> bool:
    modes = measurement.case.structure.mode if measurement.case.structure else ()
    return bool(modes) and not any(mode.friction for mode in modes)


def _has_modes(measurement: Measurement) -> bool:
    case = measurement.case
    return case.structure is not None and bool(case.structure.mode)


def _linear_law(measurement: Measurement) -> bool:
    return measurement.case.material.law == "linear"


def _several_teeth(measurement: Measurement) -> bool:
    return measurement.case.tool.teeth > 1


MILLING_EFFECTS: tuple[Effect, ...] = (
    Effect(
        "runout",
        ("milling",),
        lambda m: m.case.tool.runout is None and m.case.tool.teeth > 1,
        _runout_parameters,
        _runout,
        says="the teeth run off the spindle axis",
        told=_runout_told,
    ),
    Effect(
        "edge_force",
        ("milling",),
        _no_edge_force,
        _edge_parameters,
        _edge,
        says="the edge rubs with a force that does not depend on the chip",
    ),
    Effect(
        "process_damping",
        ("milling", "stability"),
        lambda m: m.case.process_damping is None,
        _process_damping_parameters,
        _process_damping,
        _process_damping_starts,
        says="the flank resists vibration into the work, the more the slower the cut",
    ),
    Effect(
        "chip_exponent",
        ("milling",),
        _linear_law,
        _exponent_parameters,
        _exponent,
        says="thin chips cost more force a thickness than thick ones",
    ),
    Effect(
        "missing_mode",
        ("milling", "frf"),
        _has_modes,
        _mode_parameters,
        _missing_mode,
        _mode_starts,
        says="the structure has a mode more",
        told=_mode_told,
    ),
    Effect(
        "mode_shift",
        ("milling", "stability"),
        lambda m: _has_modes(m) and _several_speeds(m),
        _shift_parameters,
        _shift,
        _shift_starts,
        says="natural frequencies change with the spindle speed",
    ),
    Effect(
        "pitch",
        ("milling",),
        _several_teeth,
        _pitch_parameters,
        _pitch,
        says="the teeth do not stand where they should",
    ),
    Effect(
        "wear",
        ("milling",),
        _cut_times_differ,
        _wear_parameters,
        _wear,
        says="forces grow with the time that the tool has cut",
    ),
    *(
        Effect(
            "contact",
            kinds,
            lambda m: _has_modes(m) and m.case.contact is None,
            _contact_parameters,
            _contact(full_at),
            says="tool and workpiece touch like a spring and a damper while in the cut",
        )
        # in proportion to the engaged depth, or whole as soon as an edge cuts
        for kinds, full_at in ((("milling", "frf"), 1.0), (("milling",), 1e-3))
    ),
    Effect(
        "dynamometer",
        ("milling",),
        lambda m: m.case.dynamometer is None and _forces_measured(m),
        _dynamometer_parameters,
        _dynamometer,
        _dynamometer_starts,
        says="the force sensor has a resonance of its own",
    ),
    Effect(
        "slide_friction",
        ("milling",),
        _no_friction,
        _slide_parameters,
        _slide,
        _slide_starts,
        says="dry friction rubs on a mode of the structure",
        told=_slide_told,
    ),
)
