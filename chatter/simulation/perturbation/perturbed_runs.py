"""A cut with a perturbed run and one from rest beside it, followed turn by turn."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.simulation.perturbation.followed_run import FollowedRun
from chatter.simulation.perturbation.lyapunov_record import LyapunovRecord
from dynamics.modal.modes import Mode, inside_band

Array = NDArray[np.float64]

#: size of the difference after every turn, as a share of the feed, and the share of it that is
#: rounding
SMALL, _ROUNDING = 1e-6, 1e-12
#: the same where there is friction, for which small is what does not move it at all; and the share
#: at which a perturbation is gone: when it lets go differs from run to run by rounding
_RUBBING_PERTURBATION, _GONE = 1e-2, 1e-3
#: perturbation after every revolution of the force ramp, as a share of it: no shape is lost
_RENEWED = 1e-3
#: a difference that moves by less than this share of its size, a turn of the lowest mode, is still
_STILL = 1e-7
#: samples of a cycle of the highest mode that are kept
_SAMPLES = 12


class _Turn(NamedTuple):
    """What is kept of a turn; see `LyapunovRecord`."""

    size: float
    distance: float
    scale: float
    still: bool
    from_rest: float
    swing: float
    motion: Array
    rest: Array


def follow(
    case: Case, modes: tuple[Mode, ...], hold: int, watch: int, period: float, share: float = SMALL
) -> LyapunovRecord:
    """Follow a cut through its force ramp and on, a perturbed run and one from rest beside it.

    The force ramp takes `hold` revolutions, `watch` more are watched; the period is that
    of the variation, turns. The perturbation is a share of the feed per tooth; with friction it
    has a size of its own.
    """
    leader, perturbed, rest = (FollowedRun(case, modes, turns) for turns in (hold, hold, 0))
    rubs = leader.setup.structure.rubs
    perturbation = (_RUBBING_PERTURBATION if rubs else share) * case.cut.feed_per_tooth
    gone = (_GONE if rubs else _ROUNDING) * perturbation
    frequencies = [mode.frequency for mode in inside_band(leader.setup.modes)]
    a_second = leader.setup.spindle.speed / (2.0 * math.pi)
    stride = _stride(leader.bins, a_second / max(frequencies))
    least = 2.0 * math.pi * min(frequencies) * leader.setup.step * _STILL
    perturbed.displace(perturbation)
    turns: list[_Turn] = []
    scale, left = 0.0, False
    for number in range(hold + watch):
        motion, beside, other = leader.revolve(), perturbed.revolve(), rest.revolve()
        if motion is None or beside is None:
            left = True
            break
        difference = beside - motion
        other = np.full_like(motion, math.inf) if other is None else other - motion
        apart, moving = max(_rms(difference), gone), _moving(difference)
        with np.errstate(invalid="ignore", divide="ignore"):
            away = float(np.nan_to_num(_moving(other) / _moving(motion), nan=math.inf))
        turns.append(
            _Turn(
                size=math.log(max(moving, least * apart)) + scale,
                distance=math.log(apart / perturbation) + scale,
                scale=scale,
                still=moving < least * apart or (rubs and apart <= gone),
                from_rest=away,
                swing=0.5 * float(np.ptp(motion, axis=0).max()),
                motion=difference[::stride],
                rest=other[::stride],
            )
        )
        # what friction remembers of its way cannot be drawn apart
        by = max(apart / perturbation, 1.0) if rubs else apart / perturbation
        perturbed.come_closer(leader, 1.0 / by)
        scale += math.log(by)
        if number < hold:
            perturbed.displace((-1.0) ** number * _RENEWED * perturbation)
    columns = zip(*turns, strict=True) if turns else ((),) * len(_Turn._fields)
    of = dict(zip(_Turn._fields, columns, strict=True))
    numbers = ("size", "distance", "scale", "from_rest", "swing")
    return LyapunovRecord(
        hold=hold,
        period=period,
        cycle=a_second / min(frequencies),
        **{name: np.array(of[name], dtype=np.float64) for name in numbers},
        still=np.array(of["still"], dtype=bool),
        motion=list(of["motion"]),
        rest=list(of["rest"]),
        step=stride * leader.setup.step,
        left=left,
        rubs=rubs,
    )


def _rms(motion: Array) -> float:
    return math.sqrt(float(np.mean(np.sum(motion**2, axis=1))))


def _moving(motion: Array) -> float:
    """Root mean square of the change from sample to sample."""
    return _rms(np.diff(motion, axis=0))


def _stride(bins: int, cycle: float) -> int:
    """Divisor of the steps of a turn that keeps enough samples of a cycle, given in turns."""
    most = max(1, int(bins * cycle / _SAMPLES))
    return next(stride for stride in range(min(most, bins // 2), 0, -1) if bins % stride == 0)
