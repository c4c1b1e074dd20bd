"""What a reader of cutting coefficients should know."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from chatter.cutting_coefficients.laws import DIRECTION_NAMES

if TYPE_CHECKING:
    from chatter.cutting_coefficients.result import Coefficients

#: tangential coefficients of foam and of hardened steel at thin chips, with room to spare, Pa
_SOFTEST, _HARDEST = 5e6, 3e10
#: paths of a run that state its feed
_FEEDS = {"cut.feed_per_tooth", "cut.feed_rate"}
#: share of variance of a channel over the cuts that a straight line leaves, worth telling
_LINEAR_SHARE = 0.95


def notes_on(found: Coefficients) -> list[str]:
    """Say where the coefficients are from and what about them is doubtful."""
    notes = []
    if found.zeroed:
        notes.append("offsets are those of the air before or after each cut, and taken off")
    elif not found.by_waveforms:
        notes.append(
            "mean forces hold an offset of the dynamometer: zero it in the air, or the edge "
            "coefficients take it up"
        )
    if found.kept.signs:
        notes.append(
            "unknown senses of channels are those that make the coefficients positive and the "
            "radial one smaller than the tangential one"
        )
    notes += [*_of_no_material(found), *_of_feeds_not_stated(found)]
    own = _of_waveforms(found) if found.by_waveforms else _of_mean_forces(found)
    return [*notes, *own]


def _of_no_material(found: Coefficients) -> list[str]:
    """That the tangential coefficient is one that nothing milled has, as by a wrong unit."""
    tangential = float(found.material.get("Ktc", 0.0))  # type: ignore[arg-type]
    if tangential <= 0.0 or _SOFTEST <= tangential <= _HARDEST:
        return []
    shown = found.units.pressure
    return [
        f"Ktc is {shown.factor * tangential:.3g} {shown.name}, where what is milled has "
        f"{shown.factor * _SOFTEST:.3g} to {shown.factor * _HARDEST:.3g} {shown.name}: "
        "check the unit of the forces in the heading, the feed and the axial depth"
    ]


def _of_feeds_not_stated(found: Coefficients) -> list[str]:
    """That some runs have the feed of the case, where others state their own."""
    runs, case = found.measurement.runs, found.measurement.case
    silent = [run.name for run in runs if _FEEDS.isdisjoint(run.overrides)]
    if not silent or len(silent) == len(runs):
        return []
    feed = f"{found.lengths(case.get('cut.feed_per_tooth'))} a tooth"
    return [
        f"{', '.join(silent)}: measurement.toml states no feed, as of the other runs; that of "
        f"the case is taken, {feed}"
    ]


def _of_mean_forces(found: Coefficients) -> list[str]:
    notes = []
    if found.linear_law_holds is False:
        worst = min(found.straightness().items(), key=lambda item: item[1], default=None)
        text = "the linear law leaves more than the readings scatter"
        if worst is not None and worst[1] < _LINEAR_SHARE:
            text += f"; least straight over the cuts is {worst[0]}, r2 {worst[1]:.2f}"
        notes += [text, *_bent_directions(found)]
    if np.any(found.kept.values[found.kept.law.cutting] < 0.0):
        notes.append(
            "a cutting coefficient is below zero: a direction or a sense may be wrong; "
            "measurement.toml tells both by [channels.NAME] with on, direction and "
            'sign = "unknown"'
        )
    if found.pulls_at_the_work:
        notes.append(
            "no [material] section is written: the radial force draws the tool into the work by "
            "more than half of the tangential force; are two channels exchanged?"
        )
    elif not found.has_material:
        notes.append("no [material] section is written: the tangential force does not cut")
    if found.holdout is None:
        notes.append("too few cuts to judge the law by one held out")
    if len({run.of(found.measurement.case).cut for run in found.measurement.runs}) == 1:
        notes.append(
            "mean forces of one cut alone do not tell the edge forces: the coefficients hold "
            "them, and the deviations are too small"
        )
    return notes


def _of_waveforms(found: Coefficients) -> list[str]:
    waveforms = found.waveforms
    assert waveforms is not None
    notes = waveforms.notes_of_offsets
    if found.linear_law_holds:
        return notes
    notes = [
        *notes,
        f"the linear law does not hold: the waveforms are better explained by "
        f"{waveforms.kept.model.law.name}, by strong evidence",
    ]
    if waveforms.kept is not waveforms.of_case:
        notes.append(
            f"[material] has the {waveforms.of_case.model.law.name} law: a cutting coefficient of "
            f"{waveforms.kept.model.law.name} is below zero"
        )
    return notes


def _bent_directions(found: Coefficients) -> list[str]:
    """Directions whose force is no line over the chip, in words."""
    law = found.by_direction
    if law is None:
        return []
    return [
        f"the {name} force goes with the power {law.exponents[number]:.2f} of the chip"
        for name, number in zip(DIRECTION_NAMES, law.law.exponents, strict=True)
        if number >= 0
    ]
