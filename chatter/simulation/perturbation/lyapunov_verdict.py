"""Whether small perturbations of the forced motion of a cut die out: a verdict without a period.

For a varying spindle speed, under which revolutions cannot be compared; docs/time-domain.md tells
how the cut is run and why full chatter must not be asked. Largest characteristic exponent of a run
perturbed a little, its difference brought back to its first size after every revolution (Benettin,
Galgani, Giorgilli and Strelcyn 1980, Meccanica 15). As long as the tool has not left the forced
motion, growth over whole periods of the variation is growth of chatter, whatever follows.
"""

import math
from dataclasses import dataclass

from chatter.description.case import Case
from chatter.simulation.perturbation.lyapunov_record import LyapunovRecord
from chatter.simulation.perturbation.perturbed_runs import follow
from chatter.simulation.setup import set_up_on_modes
from dynamics.modal.modes import Mode

#: half the range of a motion, as a share of the feed per tooth, from which on teeth may leave the
#: cut; chatter that is full moves by more
LARGE_SWING = 0.25
#: growth of a perturbation, as a logarithm, that no beating and no change of shape explains
_GROWN = 3.0
#: a perturbation that shrinks by less than this share a turn stays
_SUSTAINED = 0.004
#: a cycle that chatter has settled in is nearly neutral: growth before it and this rate are chatter
_NEUTRAL = 0.02
#: revolutions of the force ramp, and those watched after it, at the least; time constants
#: of the slowest mode and periods of the variation in them
_LEAST_TURNS = (40, 40)
_TIME_CONSTANTS = (12.0, 6.0)
_PERIODS = (4.0, 5.0)
#: steps of a run, at the most, and periods that must be watched all the same
_MOST_STEPS = 6_000_000
_LEAST_PERIODS = 1.0
#: standard errors by which a rate must be below another one
_ERRORS = 4.0
#: perturbation, as a share of the feed per tooth, below which growth is none
_MATTERS = 1e-3
#: a run that tells nothing is repeated, so often: faster taken hold of by this, or longer watched
_TRIES, _FASTER, _LONGER = 3, 3, 4
#: forced vibration that is large, as a share of the feed per tooth; and by which it may be larger
#: than small vibration would have it
_LARGE, _TOO_LARGE = 0.5, 4.0
#: the run from rest is where the other one is, and a motion repeats: within this share of it
_SAME = 0.05


@dataclass(frozen=True)
class LyapunovVerdict:
    """How a small perturbation on the forced motion develops."""

    verdict: str  # "stable", "chatter", or empty where it cannot be told
    reason: str
    #: growth, logarithm per revolution; -inf where it is gone at once, nan if not known
    rate: float = math.nan
    frequency: float = math.nan  # strongest line of what grows, Hz; nan where nothing does
    #: small perturbations die out, and only the cut from rest chatters
    from_rest_alone: bool = False

    @property
    def stable(self) -> bool:
        """True where the perturbation is forgotten."""
        return self.verdict == "stable"


#: what a run says that must be watched for longer, and one that must take hold faster
_UNCERTAIN = LyapunovVerdict("", "whether a small perturbation dies out or stays cannot be told")
_COME_BACK = LyapunovVerdict(
    "",
    "vibration grew while the cut took hold and died out when it had: whether the motion that it "
    "has come to is that of a stable cut cannot be told",
)
_FAR_MORE = LyapunovVerdict(
    "",
    "the cut has settled in a motion that repeats, but far larger than the forced vibration while "
    "it took hold: whether it is chatter cannot be told",
)


def lyapunov_verdict(case: Case, modes: tuple[Mode, ...]) -> LyapunovVerdict:
    """Push a cut on its forced motion, and follow how the perturbation goes on.

    The case is run with the delayed chip, on the modes of its structure.
    """
    hold, watch, period = _lengths(case, modes)
    feed = case.cut.feed_per_tooth
    if watch < _LEAST_PERIODS * period:
        return LyapunovVerdict(
            "",
            f"a period of the variation takes {period:.4g} turns, more than the {watch} that can "
            "be watched",
        )
    found = _judged(follow(case, modes, hold, watch, period), feed)
    for _ in range(_TRIES):
        if found.verdict or found is _FAR_MORE:
            break
        if found is _UNCERTAIN:
            watch *= _LONGER
        else:
            hold = max(hold // _FASTER, 1)
        found = _judged(follow(case, modes, hold, watch, period), feed)
    if found.verdict == "chatter" and not found.from_rest_alone:
        larger = _judged(follow(case, modes, hold, watch, period, _MATTERS), feed)
        # what grows among the kinks of the chip, and stays smaller than this, matters to no part
        return larger if larger.stable else found
    return found


def _lengths(case: Case, modes: tuple[Mode, ...]) -> tuple[int, int, float]:
    """Revolutions of the force ramp, those that are watched, and those of a period."""
    setup = set_up_on_modes(case, modes)
    bins = setup.resolution.steps_per_revolution
    a_second = setup.spindle.speed / (2.0 * math.pi)
    slowest = max(1.0 / (mode.damping * mode.natural_frequency) for mode in setup.modes)
    period = a_second / setup.spindle.frequency if setup.spindle.amplitude else 1.0
    wanted = [
        max(least, constants * slowest * a_second, periods * period)
        for least, constants, periods in zip(_LEAST_TURNS, _TIME_CONSTANTS, _PERIODS, strict=True)
    ]
    most = _MOST_STEPS / bins
    share = min(1.0, most / sum(wanted))
    hold, watch = (math.ceil(share * turns) for turns in wanted)
    return hold, watch, period


def _judged(found: LyapunovRecord, feed: float) -> LyapunovVerdict:
    """Verdict of a run; one that is empty where it must be run in another way."""
    grown = found.rise(found.hold, _GROWN)
    if grown:
        return _chatter(found, *grown, "a small perturbation on the forced motion grows by")
    if found.left:
        return LyapunovVerdict("chatter", "the tool is thrown out of the cut", math.inf)
    settled, error = found.settled_rate()
    grown = found.rise(0, _GROWN)
    if grown:
        error = error if math.isfinite(error) else 0.0
        if settled + _ERRORS * error > -_NEUTRAL:
            return _chatter(found, *grown, "during the force ramp a small perturbation grows by")
        return _COME_BACK
    if settled >= -_SUSTAINED and found.creeps():
        return LyapunovVerdict(
            "stable", "a small perturbation creeps back as friction lets it", settled
        )
    if settled >= -_SUSTAINED:
        says = "a small perturbation on the forced motion changes by"
        return _chatter(found, *found.watched_last, says)
    unsure = error if math.isfinite(error) else max(_NEUTRAL + settled, 0.0)
    if settled + _ERRORS * unsure >= -_SUSTAINED:
        return _UNCERTAIN
    if not found.from_rest_converges(_SAME, _SUSTAINED):
        return LyapunovVerdict(
            "chatter",
            "the cut from rest stays away from its forced motion, "
            "whose small perturbations die out",
            settled,
            found.frequency_of_rest(*found.watched_last),
            from_rest_alone=True,
        )
    if not found.repeats(_SAME):
        says = "the motion does not repeat with the variation, though small perturbations die out"
        return LyapunovVerdict("chatter", says, settled)
    share = (
        f" by {-math.expm1(settled):.1%} per revolution" if math.isfinite(settled) else " at once"
    )
    reason = f"a small perturbation on the forced motion dies out{share}"
    swing = found.swing[slice(*found.watched_last)].max() / feed
    if swing > _LARGE:
        if swing * feed > _TOO_LARGE * found.swing_of_small_motion(_LARGE * feed):
            return _FAR_MORE
        reason += f"; forced vibration of {swing:.2g} feeds per tooth lets teeth leave the cut"
    return LyapunovVerdict("stable", reason, settled)


def _chatter(found: LyapunovRecord, begin: int, end: int, says: str) -> LyapunovVerdict:
    rate = found.rate(begin, end)
    reason = f"{says} {math.expm1(min(rate, 50.0)):+.1%} per revolution"
    return LyapunovVerdict("chatter", reason, rate, found.frequency(begin, end))
