"""Numbers that are fitted, and declared values as such numbers with a prior."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from chatter.explain.criteria import REFITTED_WITHIN
from chatter.explain.measurement import Measurement

#: standard deviation, in sizes, of a parameter that has no declared value and begins at nothing:
#: of values that the data do not tell apart, the smallest
FREE_SIZES = 30.0


@dataclass(frozen=True)
class Parameter:
    """A number that is fitted."""

    name: str  # path in the case, or name within an effect
    start: float  # SI
    size: float  # standard deviation of the prior, or a typical size where there is none
    lower: float = -np.inf
    upper: float = np.inf
    prior: bool = True  # whether the start is a declared value with a standard deviation
    unit: str = ""  # SI unit, for reports

    @property
    def weight(self) -> float:
        """Weight of the row that holds it near its start; 0 where nothing does."""
        if self.prior:
            return 1.0
        return 1.0 / FREE_SIZES if self.start == 0.0 else 0.0

    def counted(self, value: float) -> float:
        """Distance of a value from the start, in sizes."""
        return (value - self.start) / self.size

    def value(self, counted: float) -> float:
        """Value at a distance from the start that is counted in sizes."""
        return self.start + counted * self.size

    def per_size(self, counted: float) -> float:  # noqa: ARG002
        """Change of the value with a size, at a distance from the start."""
        return self.size

    def moved(self, value: float, change: float) -> float:
        """Value that is so many sizes away from another, within the bounds."""
        return float(np.clip(self.value(self.counted(value) + change), self.lower, self.upper))

    def slope(self, value: float) -> float:
        """Change of the value with a size, where it is so large."""
        return self.per_size(self.counted(value))


@dataclass(frozen=True)
class KnownByFactor(Parameter):
    """A positive number that is known by a factor, 1 + size/start, up or down.

    Its logarithm scatters: twice as much as declared is as far as half of it.
    """

    @property
    def _unit_of_logarithm(self) -> float:
        return math.log1p(self.size / self.start)

    def counted(self, value: float) -> float:
        """Logarithm of the factor, in that of the declared one."""
        if value <= 0.0:
            return -math.inf
        return math.log(value / self.start) / self._unit_of_logarithm

    def value(self, counted: float) -> float:
        """Value at so many factors."""
        return self.start * np.exp(counted * self._unit_of_logarithm)

    def per_size(self, counted: float) -> float:
        """Change of the value with a factor more."""
        return self.value(counted) * self._unit_of_logarithm


def by_factor(one: Parameter) -> KnownByFactor:
    """Return a positive parameter as known by a factor."""
    return KnownByFactor(one.name, one.start, one.size, one.lower, one.upper, one.prior, one.unit)


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
    written in the case ("1650 +- 80 MPa"), or a few percent by the kind of value. A value that is
    named in [tolerance] by its whole path, such as tool.helix, is one of them too.
    """
    declared = measurement.case.deviations()
    found = []
    named = [path for path in measurement.tolerances if "." in path]
    for path in dict.fromkeys([*paths, *named]):
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
            lowest = 0.02 * value if value > 0.0 else -np.inf
            found.append(Parameter(path, value, deviation, lower=lowest))
    return found


def within_reach(parameters: Sequence[Parameter]) -> list[Parameter]:
    """Declared values with bounds within which they are refitted.

    Damping ratios are known by a factor: next to no damping is not as near as twice of it. With a
    normal prior, fits to a real slot ended with a mode of a fiftieth of its declared damping.
    """
    found = []
    for one in parameters:
        known = by_factor(one) if one.name.endswith(".damping") and one.start > 0.0 else one
        lowest = max(known.lower, known.value(-REFITTED_WITHIN))
        found.append(replace(known, lower=lowest, upper=known.value(REFITTED_WITHIN)))
    return found
