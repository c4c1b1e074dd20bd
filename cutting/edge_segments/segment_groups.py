"""Segments of an edge that follow one another: groups along which all is smooth, and their ends."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cutting.edge_segments.engagement_arcs import Owner, Segment

#: with a size effect a group on a corner ends where its inclination has grown by this factor: at
#: the tip the slope of the force law is infinite
_GROUP_GROWTH = 3.0


def segment_groups(
    segments: list[Segment], owners: list[Owner], sized: bool, apart: bool
) -> tuple[list[int], NDArray[np.int64]]:
    """Order of the segments along groups, and the first of each group, then their number (C + 1,).

    The chip on a serrated edge is not smooth from segment to segment: with a size effect every
    segment is a group apart.
    """
    met: dict[tuple[int, int, int], int] = {}
    keys = []
    for owner in owners:
        segment, tooth, other = owner
        met[owner] = met.get(owner, -1) + 1
        keys.append((tooth, other, met[owner], segment))
    order = sorted(range(len(segments)), key=lambda i: keys[i])
    starts: list[int] = []
    lowest = 0.0  # inclination at the start of the group
    for position, i in enumerate(order):
        kappa, corner = segments[i].immersion, segments[i].corner
        before = order[position - 1]
        follows = position > 0 and keys[i] == (*keys[before][:3], keys[before][3] + 1)
        smooth = follows and not apart and segments[before].corner == corner
        if not smooth or (sized and corner > 0.0 and kappa[1] > _GROUP_GROWTH * lowest):
            starts.append(position)
            lowest = max(kappa[0], 1e-12)
    return order, np.array([*starts, len(order)], dtype=np.int64)


def turning_ends(segments: list[Segment], owners: list[Owner], serrated: bool) -> NDArray[np.int64]:
    """Mark the ends (P, 2) of segments at which an edge first meets the stock, or last leaves it.

    There the spindle angle of entry or exit turns round along the edge, or the edge ends, or it
    is no more cut all around, or the surface of one earlier pass gives way to that of another; not
    along a serrated edge, on which it does so from wave to wave for a small part each.
    """
    marks = np.zeros((len(segments), 2), dtype=np.int64)
    position = {owner: i for i, owner in enumerate(owners)}
    there = {owner[: 2 if serrated else 3] for owner in owners}
    for owner, i in position.items():
        segment, tooth, other = owner
        following = position.get((segment + 1, tooth, other))
        key = (tooth,) if serrated else (tooth, other)
        marks[i, 0] |= segment > 0 and (segment - 1, *key) not in there
        marks[i, 1] |= (segment + 1, *key) not in there
        if following is None:
            continue
        this, that = segments[i], segments[following]
        angle, next_angle = this.angle, that.angle
        for one, next_one, end in ((this.entry, that.entry, 0.0), (this.exit, that.exit, math.pi)):
            whole = one[0] == one[1] == end
            marks[i, 1] |= whole and not next_one[0] == next_one[1] == end
            rise = (one[1] - one[0]) - (angle[1] - angle[0])
            marks[i, 1] |= (
                rise * ((next_one[1] - next_one[0]) - (next_angle[1] - next_angle[0])) < 0.0
            )
    return marks
