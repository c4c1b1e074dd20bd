"""Measured or simulated signals of a cut, as chatter detection takes them."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from chatter.description.errors import InputError

_REVOLUTION = 2.0 * math.pi
#: fewest revolutions of the spindle that suffice
FEWEST_REVOLUTIONS = 6
#: fewest samples per tooth passing
_FEWEST_SAMPLES_PER_TOOTH = 6
#: angles between teeth that differ by less count as equal, rad
_EQUAL_PITCH = 1e-4
#: runout below this share of the feed per tooth counts as none
_NEGLIGIBLE_RUNOUT = 1e-3


@dataclass(frozen=True, eq=False)
class CutRecord:
    """Signals of a cut at nearly constant spindle speed.

    Parameters
    ----------
    time : (n,) array of float
        s, uniform step.
    spindle_angle : (n,) array of float
        rad, increasing; the first tooth is at zero angle at whole revolutions.
    displacements : (n, k) array of float or None
        m, of the tool relative to the workpiece, k from 1 to 3; None if forces alone are known.
    tooth_angles : (N,) array of float
        rad, angles of the teeth on the tool, in the order in which they cut.
    feed_per_tooth : float
        m.
    forces : (n, 3) array of float or None
        N. Used only where there are no displacements.
    runout : (N,) array of float or None
        m, radial offset of each tooth; None if it is not known. Zeros declare the tool true.
    negligible : float
        Deviation from period to period, as a share of the rms of the motion, that is none: what
        the record itself does not repeat any better.
    speed_follows : bool
        Whether a drive that gives way to the cut turns the spindle, so that a speed that varies is
        a consequence of the vibration. Otherwise its variation is taken for a cause of motion.
    lowest_frequency : float
        Hz, below which the structure has no resonance and its drives no loop: slower motion is no
        chatter. 0 where it is not known.

    Raises
    ------
    InputError
        If arrays do not fit together, values are not finite, or the record is too short.
    """

    time: NDArray[np.float64]
    spindle_angle: NDArray[np.float64]
    displacements: NDArray[np.float64] | None
    tooth_angles: NDArray[np.float64]
    feed_per_tooth: float
    forces: NDArray[np.float64] | None = None
    runout: NDArray[np.float64] | None = None
    negligible: float = 0.005
    lowest_frequency: float = 0.0
    speed_follows: bool = False

    def __post_init__(self) -> None:
        for name in ("time", "spindle_angle", "tooth_angles", "runout"):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, _array(name, value, 1))
        for name in ("displacements", "forces"):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, _array(name, value, 2))
        _check_shapes(self)
        _check_motion(self)

    @property
    def signals(self) -> NDArray[np.float64]:
        """Signals (n, k) of the detection: displacements, m, or forces, N, without them."""
        signals = self.forces if self.displacements is None else self.displacements
        assert signals is not None
        return signals

    @property
    def teeth(self) -> int:
        """Number of teeth."""
        return len(self.tooth_angles)

    @property
    def revolutions(self) -> float:
        """Revolutions of the spindle in the record."""
        return float(self.spindle_angle[-1] - self.spindle_angle[0]) / _REVOLUTION

    @property
    def has_equal_pitch(self) -> bool:
        """Whether the teeth are equally spaced."""
        angles = np.sort(np.mod(self.tooth_angles - self.tooth_angles[0] + 1e-9, _REVOLUTION))
        return bool(
            np.allclose(
                angles,
                np.arange(self.teeth) * _REVOLUTION / self.teeth,
                rtol=0.0,
                atol=_EQUAL_PITCH,
            )
        )

    @property
    def is_symmetric(self) -> bool:
        """Whether the tool is declared to repeat from tooth to tooth: equal pitch, no runout."""
        if not self.has_equal_pitch:
            return False
        if self.teeth == 1:
            return True
        if self.runout is None:
            return False
        return bool(np.ptp(self.runout) <= _NEGLIGIBLE_RUNOUT * self.feed_per_tooth)


def _array(name: str, value: object, dimensions: int) -> NDArray[np.float64]:
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"cut record: {name}: must be an array of numbers") from None
    if dimensions == 2 and array.ndim == 1:
        array = array[:, None]
    if array.ndim != dimensions:
        raise InputError(
            f"cut record: {name}: has {array.ndim} dimensions, {dimensions} are needed"
        )
    if not np.all(np.isfinite(array)):
        raise InputError(f"cut record: {name}: holds values that are not finite")
    return array


def _check_shapes(record: CutRecord) -> None:
    n = len(record.time)
    if record.displacements is None and record.forces is None:
        raise InputError("cut record: displacements or forces are needed, neither is given")
    for name in ("spindle_angle", "displacements", "forces"):
        value = getattr(record, name)
        if value is not None and len(value) != n:
            raise InputError(f"cut record: {name}: {len(value)} samples, but time has {n}")
    if record.displacements is not None and not 1 <= record.displacements.shape[1] <= 3:
        raise InputError(
            f"cut record: displacements: {record.displacements.shape[1]} columns; 1 to 3 are "
            "allowed"
        )
    if record.teeth < 1:
        raise InputError("cut record: tooth_angles: at least one tooth is needed")
    if record.runout is not None and len(record.runout) != record.teeth:
        raise InputError(
            f"cut record: runout: {len(record.runout)} values for {record.teeth} teeth"
        )
    if not (math.isfinite(record.feed_per_tooth) and record.feed_per_tooth > 0.0):
        raise InputError(
            f"cut record: feed_per_tooth: {record.feed_per_tooth!r} m; it must be above zero"
        )


def _check_motion(record: CutRecord) -> None:
    if len(record.time) < 2 or not np.all(np.diff(record.time) > 0.0):
        raise InputError("cut record: time: must increase from sample to sample")
    steps = np.diff(record.time)
    if np.ptp(steps) > 0.01 * steps.mean():
        raise InputError(
            f"cut record: time: the step varies from {steps.min():g} to {steps.max():g} s; it must "
            "be uniform"
        )
    if not np.all(np.diff(record.spindle_angle) > 0.0):
        raise InputError("cut record: spindle_angle: must increase from sample to sample")
    if record.revolutions < FEWEST_REVOLUTIONS:
        raise InputError(
            f"cut record: {record.revolutions:.1f} revolutions of the spindle; at least "
            f"{FEWEST_REVOLUTIONS} are needed"
        )
    fewest = _FEWEST_SAMPLES_PER_TOOTH * record.teeth
    if len(record.time) < fewest * record.revolutions:
        raise InputError(
            f"cut record: {len(record.time) / record.revolutions:.1f} samples per revolution; at "
            f"least {fewest} are needed for {record.teeth} teeth"
        )
