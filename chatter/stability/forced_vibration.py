"""Where the steady cut is another than linear methods take it for: loss of contact, edge forces.

The linear methods assume that every tooth cuts what the tooth before it has left. In the steady cut
the tool vibrates at the harmonics of its rotation. With a uniform pitch every tooth meets the wave
of the last in phase and cuts the chip of a rigid tool; else the chip changes by the vibration now
less that when the earlier tooth passed, and where this exceeds the chip the tooth loses contact.
"""

import math
from typing import NamedTuple

import numpy as np

from chatter.description.arrays import Array
from chatter.description.formatting import to_digits
from chatter.description.unit_system import units_of
from chatter.description.units import rpm
from chatter.stability.edge_force_onset import (
    REPORTED_ONSET,
    edge_force_onset,
    lowest_limit_with_onset,
    share_is_that_of_all_depths,
)
from chatter.stability.model import MillingModel
from chatter.stability.neglected_effects import EDGE_FORCES, NeglectedEffect, notes_of
from chatter.stability.stability_method import StabilityMethod
from chatter.stability.steady_flank import flank_in_motion
from chatter.stability.steady_motion import SteadyMotion, directions, in_cut, steady_motion
from cutting.edge_segments.segments import period_angle

#: delays and the period that differ by less are the same, rad
_SAME_DELAY = 1e-9
#: share of the arc lost, or of the chip changed, from which on it is reported: the multipliers of
#: random cuts in simulations are off by 25 % in the median beyond these, below them by 0.7 %
_REPORTED_LOSS, _LARGE_CHANGE = 0.08, 0.6
#: where no linear limit is known
_NO_LIMITS = np.empty(0)
#: slope of forced vibration, of that of the clearance face, from which on a flank that ploughs is
#: reported, and length of its contact, in waves of chatter
_STEEP, _LONG_LAND = 0.3, 0.04


class ForcedVibration(NamedTuple):
    """Steady vibration of a linear cut at one speed and depth."""

    amplitude: float  # largest distance from the mean position, m
    chip_change: float  # largest, m
    chip: float  # largest of a rigid tool, m
    loss_of_contact: float  # share of the cut of a rigid tool that has no chip left


def forced_vibration(model: MillingModel, speed: float, depth: float) -> ForcedVibration | None:
    """Steady vibration of a cut and what it does to the chip; None with a uniform pitch.

    At a constant spindle speed, rad/s, and a depth, m.
    """
    if model.case.cut.speed_variation is not None:
        return None
    delay, period = model.cut(depth).segments.delay, period_angle(model.cutter)
    if not delay.size or np.all(np.abs(delay - period) < _SAME_DELAY):
        return None
    motion = steady_motion(model, speed, depth)
    return None if motion is None else _vibration_of(motion, model)


def neglected_in_steady_cut(
    model: MillingModel, method: StabilityMethod, limits: Array = _NO_LIMITS
) -> tuple[NeglectedEffect, ...]:
    """Effects by which the steady cut of a case is another than linear methods take it for.

    Bounds of linear limits, m, are those of these limits where they differ with the depth.
    """
    if not method.is_linear:
        return ()
    speed, depth = model.operating_point
    return (
        *_loss_of_contact(model, speed, depth),
        *neglected_edge_forces(model, depth, limits),
        *_flank_beyond_the_land(model, speed, depth),
        *_left_to_time_domain(model, method),
    )


def notes_on_steady_cut(model: MillingModel, method: StabilityMethod) -> tuple[str, ...]:
    """Say what the linear methods leave out of the steady cut of a case, and how a flank acts."""
    effects = neglected_in_steady_cut(model, method)
    return (*notes_of(effects), *notes_on_dashpot(model, method))


def _left_to_time_domain(
    model: MillingModel, method: StabilityMethod
) -> tuple[NeglectedEffect, ...]:
    """Contact and friction of modes, which have no slope that a linear method could take."""
    found = []
    if any(mode.friction for mode in model.case.structure.mode):
        found.append(("friction of modes", "friction of modes is left out of the linear analysis"))
    if model.case.contact is not None and not method.takes_contact:
        found.append(("contact", f"{method.name} leaves out the contact of tool and work"))
    return tuple(
        NeglectedEffect(name, math.nan, 0.0, math.inf, because, "") for name, because in found
    )


def _loss_of_contact(
    model: MillingModel, speed: float, depth: float
) -> tuple[NeglectedEffect, ...]:
    found = forced_vibration(model, speed, depth)
    if found is None:
        return ()
    if found.loss_of_contact < _REPORTED_LOSS and found.chip_change < _LARGE_CHANGE * found.chip:
        return ()
    lengths = (found.amplitude, found.chip, found.chip_change)
    units = units_of(model.case)
    unit, factor = units.at_the_size_of(*lengths)
    amplitude, chip, change = (f"{to_digits(one * factor, 3)} {unit}" for one in lengths)
    note = (
        f"at {rpm(speed):.0f} rpm and {units.length.text(depth, '.3g')} the forced vibration of "
        f"{amplitude} changes the chip of {chip} by up to {change}: teeth lose contact over "
        f"{found.loss_of_contact:.0%} of their arc, which linear methods leave out; the limit in "
        "the time domain may differ "
        "(--method time-domain)"
    )
    because = (
        f"forced vibration changes the chip by {found.chip_change / found.chip:.0%} and takes "
        f"teeth out of the cut over {found.loss_of_contact:.0%} of their arc"
    )
    share = found.loss_of_contact
    return (NeglectedEffect("loss of contact", share, 0.0, math.inf, because, note),)


def neglected_edge_forces(
    model: MillingModel, depth: float, limits: Array
) -> tuple[NeglectedEffect, ...]:
    """Edge forces that set in at a chip of zero: what they may take of linear limits, m.

    On the edge of a cylinder, or without a limit, by their share at a depth, m.
    """
    share = edge_force_onset(model, depth)
    if share < REPORTED_ONSET:
        return ()
    lowest = max(0.0, 1.0 - share)
    at = ""
    if not share_is_that_of_all_depths(model):
        share, lowest, at = _share_at_limits(model, limits, share, depth)
    because = "edge forces that set in at a chip of zero "
    higher, highest = "", math.inf
    if lowest > 0.0:
        # a stiffness of that share may act against the chip's as well as with it
        both = f"they may lower the limit by {share:.0%}, or raise it by as much"
        higher, highest = f"{because}may raise the limit by {share:.0%}", 1.0 + share
        because += f"may lower the limit by {share:.0%}"
    else:
        both = f"they are {share:.3g} times as stiff as the chip{at}"
        because += both.removeprefix("they ")
    feed = model.case.cut.feed_per_tooth
    unit, factor = units_of(model.case).at_the_size_of(feed)
    note = (
        f"edge forces set in or end where the chip of {to_digits(feed * factor, 3)} {unit} a "
        "tooth is zero, and vibration shifts these moments, which linear methods leave out: "
        f"{both}; the time domain decides (--method time-domain)"
    )
    return (NeglectedEffect(EDGE_FORCES, share, lowest, highest, because, note, higher),)


def _share_at_limits(
    model: MillingModel, limits: Array, share: float, depth: float
) -> tuple[float, float, str]:
    """Part of the limits that edge forces may take, what they leave at least, and where that holds.

    Relative; the worst of the lowest and the highest limit, m. Where there is no limit, where none
    was looked for, and where they leave nothing, the share is that at the depth of the cut, m.
    """
    found = limits[np.isfinite(limits)]
    at = f" at {units_of(model.case).length.text(depth, '.3g')}, the depth of the cut"
    if not limits.size:
        # what it leaves of the limit is known at the limit alone
        return share, 0.0, f"{at} (at the limit by `chatter check`)"
    if not found.size:
        return share, max(0.0, 1.0 - share), at
    ends = sorted({float(found.min()), float(found.max())})
    lowest = min(lowest_limit_with_onset(model, limit) / limit for limit in ends)
    return (1.0 - lowest, lowest, "") if lowest > 0.0 else (max(share, 1.0), 0.0, at)


def notes_on_dashpot(model: MillingModel, method: StabilityMethod) -> tuple[str, ...]:
    """Say which share of the dashpot of a flank acts in the steady cut of a case."""
    flank = flank_in_motion(model)
    speed, depth = model.operating_point
    motion = None if flank is None else steady_motion(model, speed, depth)
    if not method.is_linear or flank is None or motion is None:
        return ()
    share = motion.pressed / (0.5 * flank.contact_length**2)
    still = "0.5 of it" if flank.edge_radius == 0.0 else "all of it"
    return (
        f"ploughing: at {rpm(speed):.0f} rpm and "
        f"{units_of(model.case).length.text(depth, '.3g')} small vibration beside the "
        f"forced vibration meets {share:.2g} of the dashpot K l^2/2 on average; beside a still "
        f"tool {still}",
    )


def _flank_beyond_the_land(
    model: MillingModel, speed: float, depth: float
) -> tuple[NeglectedEffect, ...]:
    flank = flank_in_motion(model)
    motion = None if flank is None else steady_motion(model, speed, depth)
    if flank is None or motion is None:
        return ()
    found = []
    steep = motion.steepest / math.tan(flank.clearance_angle)
    if steep > _STEEP:
        slopes = f"slopes up to {motion.steepest:.2g}, {steep:.0%} of that of the clearance face"
        note = (
            f"ploughing: at {rpm(speed):.0f} rpm and "
            f"{units_of(model.case).length.text(depth, '.3g')} forced vibration moves "
            f"the edges at {slopes}, which is pressed beyond the land; the limit in the time "
            "domain may differ (--method time-domain)"
        )
        because = f"forced vibration presses the flank at {slopes}"
        found.append(NeglectedEffect("steep ploughing", steep, 0.0, math.inf, because, note))
    fastest = model.cut(depth).fastest / (2.0 * math.pi)
    waves = flank.contact_length * fastest / (speed * model.cutter.radius)
    if waves > _LONG_LAND:
        length = units_of(model.case).at_the_size_of(flank.contact_length)
        land = f"{length.text(flank.contact_length, '.3g')}, {waves:.2g} of the wave"
        note = (
            f"ploughing: the flank touches over {land} that {fastest:.0f} Hz leaves at "
            f"{rpm(speed):.0f} rpm; it is then no mere dashpot, and the limit in the time domain "
            "may differ (--method time-domain)"
        )
        because = f"the flank touches over {land} of chatter, and is then no mere dashpot"
        found.append(NeglectedEffect("long land", waves, 0.0, math.inf, because, note))
    return tuple(found)


def _vibration_of(steady: SteadyMotion, model: MillingModel) -> ForcedVibration:
    points, order, spindle = steady.points, steady.order, steady.spindle
    driven = np.where(order[:, None] == 0.0, 0.0, steady.harmonics)
    wave = np.exp(1j * np.outer(spindle, order))
    motion = (wave @ driven).real
    cut, loss_of_contact, largest, change = 0.0, 0.0, 0.0, 0.0
    for p in range(points.angle.size):
        inside, phi, chip = in_cut(points, p, spindle)
        if not inside.size:
            continue
        earlier = (wave[inside] @ (np.exp(-1j * order * points.delay[p])[:, None] * driven)).real
        _, chip_of = directions(points, p, phi, model.basis_on_tool)
        vibrating = np.einsum("ni,ni->n", chip_of, motion[inside] - earlier)
        cut += points.length[p] * chip.size
        loss_of_contact += points.length[p] * np.count_nonzero(chip + vibrating <= 0.0)
        largest = max(largest, float(chip.max()))
        change = max(change, float(np.abs(vibrating).max()))
    amplitude = float(np.linalg.norm(motion - motion.mean(axis=0), axis=1).max())
    return ForcedVibration(amplitude, change, largest, float(loss_of_contact / max(cut, 1e-300)))
