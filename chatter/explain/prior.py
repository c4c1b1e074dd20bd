"""How far declared values may be off: their standard deviations by key."""

from __future__ import annotations

from collections.abc import Sequence

from chatter.explain.fitting import Parameter
from chatter.explain.measurement import Measurement

#: last key of a path -> relative standard deviation of a declared value
TOLERANCES = {
    "frequency": 0.02,
    "damping": 0.20,
    "mass": 0.08,
    "stiffness": 0.10,
    "Ktc": 0.10,
    "Krc": 0.10,
    "Kac": 0.10,
    "Kte": 0.15,
    "Kre": 0.15,
    "Kae": 0.15,
    "coefficient": 0.20,
    "offset": 0.20,
    "moving_mass": 0.10,
    "viscous_friction": 0.15,
    "coulomb_friction": 0.10,
}
_OTHERS = 0.05


def with_priors(measurement: Measurement, paths: Sequence[str]) -> list[Parameter]:
    """Declared values as parameters with a prior.

    The standard deviation is that of the measurement's [tolerance], by path or last key, or that
    written in the case ("1650 +- 80 MPa"), or a few percent by the kind of value.
    """
    declared = measurement.case.deviations()
    found = []
    for path in paths:
        value = float(measurement.case.get(path))
        key = path.rpartition(".")[2]
        share = measurement.tolerances.get(path, measurement.tolerances.get(key))
        if share is not None:
            deviation = share * abs(value)
        elif path in declared:
            deviation = declared[path]
        else:
            deviation = TOLERANCES.get(key, _OTHERS) * abs(value)
        if deviation > 0.0:
            found.append(Parameter(path, value, deviation, lower=0.02 * value))
    return found
