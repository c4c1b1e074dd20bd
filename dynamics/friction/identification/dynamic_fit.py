"""A whole friction law fitted to time records, presliding and reversals included.

The law runs along the measured motion with its own time-stepping leaves, and the effort it
predicts, with inertia and offset, is compared with the measured one:
effort = inertia x acceleration + friction(motion) + offset. Nothing is simulated in closed loop,
so an error of the law at one reversal does not move the next.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from dynamics.compiled import njit
from dynamics.frf.container import MeasurementError
from dynamics.friction.identification.filtering import LowPass
from dynamics.friction.identification.intervals import Estimate
from dynamics.friction.identification.law_fit import law_parameters, search
from dynamics.friction.identification.record import DriveRecord
from dynamics.friction.laws import BY_SPEC, FrictionLaw


@cache
def _runner(kind: type) -> Callable[..., None]:
    """Compiled run of one kind of law along motions."""
    force, advance = BY_SPEC[kind].force, BY_SPEC[kind].advance

    @njit
    def run(law, motions, time, resisted):
        for k in range(len(motions)):
            resisted[k] = force(law, 0, motions[k], time)
            advance(law, 0, motions[k], time)

    return run


def friction_along(
    law: FrictionLaw, position: NDArray[np.float64], sample_time: float
) -> NDArray[np.float64]:
    """Friction (n,) along a measured motion that starts with a law at rest.

    Positions (n,), m or rad, are every `sample_time`, s. Friction, N or N m, is positive against
    positive motion; at a sample the mean of the two intervals beside it.
    """
    if type(law) not in BY_SPEC:
        raise TypeError(
            f"friction fit: {type(law).__name__} is none of "
            f"{', '.join(kind.__name__ for kind in BY_SPEC)}"
        )
    motions = np.diff(np.asarray(position, dtype=np.float64))
    resisted = np.empty(len(motions))
    _runner(type(law))(BY_SPEC[type(law)].columns([law], [0]), motions, sample_time, resisted)
    ends = np.concatenate((resisted[:1], resisted, resisted[-1:]))
    return 0.5 * (ends[1:] + ends[:-1])


@dataclass(frozen=True)
class AxisModel:
    """An axis as a drive feels it: inertia, friction and a constant load."""

    law: FrictionLaw
    inertia: float  # kg or kg m^2
    offset: float = 0.0  # constant effort such as weight, N or N m

    def effort(self, record: DriveRecord, low_pass: LowPass) -> NDArray[np.float64]:
        """Effort (n,) that the measured motion of a record needs, N or N m.

        The effort of the record is not used; the low pass is for the acceleration alone, which is
        noise without it.
        """
        friction = friction_along(self.law, record.position, record.sample_time)
        acceleration = low_pass.apply(_acceleration(record), record.sample_time)
        return self.inertia * acceleration + friction + self.offset


@dataclass(frozen=True)
class AxisFit:
    """Result of `fit_axis`."""

    model: AxisModel  # with the fitted values
    estimates: dict[str, Estimate]  # fitted parameters with 95 % intervals
    #: rms of the residual of the judged low-passed effort, over its deviation
    relative_residual: float
    unsupported: tuple[str, ...]  # parameters that the records do not decide
    agreeing_starts: int  # starts of the search that ended at this optimum


def fit_axis(
    records: Sequence[DriveRecord],
    guess: AxisModel,
    free: Sequence[str],
    *,
    low_pass: LowPass,
    minimum_speed: float = 0.0,
    settling: float = 0.0,
    starts: int = 4,
    seed: int = 0,
) -> AxisFit:
    """Fit parameters of a friction law, inertia and offset to drive records.

    Records are in the same units; each starts with the law unbent, at rest. Free are parameters of
    the law by name, ``"inertia"``, ``"offset"``; what is not free stays as in the guess. The
    low-pass acts alike on measured effort, acceleration and predicted friction. Samples slower than
    the minimum speed, m/s or rad/s, are not judged; needed for a law without presliding. Nor is the
    settling time, s, at the start of each record: where the axis was at rest under load, or already
    moving, the law's state is not known at first. The seed is that of the starts of the search
    after the first. MeasurementError if too few samples are judged, ValueError if a parameter is
    unknown or its guess is out of range.
    """
    if not records:
        raise MeasurementError("drive records: none given")
    own = {"inertia": guess.inertia, "offset": guess.offset}
    of_law = [name for name in free if name not in own]
    first = law_parameters(guess.law, of_law)
    first |= {name: own[name] for name in free if name in own}
    prepared = [_prepare(r, low_pass, minimum_speed, settling) for r in records]
    judged = np.concatenate([effort[kept] for effort, _, kept in prepared])
    if len(judged) < 10 * len(first):
        raise MeasurementError(
            f"{records[0].name}: {len(judged)} samples are judged; {len(first)} parameters need "
            f"at least {10 * len(first)}"
        )

    def model(values: dict[str, float]) -> AxisModel:
        law = replace(guess.law, **{name: values[name] for name in of_law})
        changed = {name: values[name] for name in own if name in values}
        return replace(guess, law=law, **changed)

    def residual(values: dict[str, float]) -> NDArray[np.float64]:
        tried = model(values)
        parts = []
        for record, (effort, acceleration, kept) in zip(records, prepared, strict=True):
            friction = friction_along(tried.law, record.position, record.sample_time)
            smooth = low_pass.apply(friction, record.sample_time)
            parts.append((tried.inertia * acceleration + smooth + tried.offset - effort)[kept])
        return np.concatenate(parts)

    scale = max(float(np.std(judged)), np.finfo(float).tiny)
    signed = {"offset": scale} if "offset" in first else {}
    found = search(residual, first, signed=signed, starts=starts, seed=seed)
    return AxisFit(
        model(found.values),
        found.estimates,
        float(np.sqrt(np.mean(found.residual**2))) / scale,
        found.unsupported,
        found.agreeing_starts,
    )


def _acceleration(record: DriveRecord) -> NDArray[np.float64]:
    if record.acceleration is not None:
        return record.acceleration
    return np.gradient(record.velocity, record.sample_time)


def _prepare(
    record: DriveRecord, low_pass: LowPass, minimum_speed: float, settling: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
    """Low-passed effort and acceleration (n,), and the samples (n,) that are judged."""
    both = np.column_stack((record.effort, _acceleration(record)))
    smooth = low_pass.apply(both, record.sample_time)
    kept = np.abs(record.velocity) >= minimum_speed
    kept &= record.time - record.time[0] >= settling
    kept &= ~record.near_excluded(low_pass.settling)
    return smooth[:, 0], smooth[:, 1], kept


def friction_over_position(
    record: DriveRecord, inertia: float, low_pass: LowPass
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Position and friction of a record: low-passed effort less the force of acceleration.

    Inertia in kg or kg m^2. N over m or N m over rad: friction curves of sine moves, as the
    modelling of the test machine with drive control and friction draws them (section 2.3, Figure
    4).
    """
    effort, acceleration, _ = _prepare(record, low_pass, 0.0, 0.0)
    return record.position, effort - inertia * acceleration


def relative_error(record: DriveRecord, predicted: NDArray[np.float64]) -> float:
    """Root mean square of predicted less measured effort, over the measured standard deviation."""
    return float(np.sqrt(np.mean((predicted - record.effort) ** 2)) / np.std(record.effort))
