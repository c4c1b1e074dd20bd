"""Thickest chip where teeth do not share the feed evenly."""

import math

import numpy as np

from chatter.description.case import Case
from chatter.description.material_words import thickest_chip
from cutting.tool.cutter import Cutter, edge_slices, slice_counts

#: slices in the place of one: a crest lies within a thousandth of the wave's depth of a middle
_FINER = 4


def thickest_chip_of_teeth(case: Case, cutter: Cutter) -> float:
    """Thickest chip of the rigid cut, m, by pitch, helix, waves, runout and setting of the teeth.

    A tooth takes what the feed brings since an earlier one passed, and by what its edge lies
    further out than that one's: the thinnest of all earlier passes counts, its own included.
    """
    corner, straight = slice_counts(cutter, case.cut.axial_depth)
    counts = (corner, _FINER * straight)
    slices = edge_slices(cutter, case.cut.axial_depth, counts)
    # of a revolution's feed along the normal
    whole = cutter.teeth * thickest_chip(case)
    thickest = 0.0
    for tooth in range(cutter.teeth):
        # teeth ahead have larger angles
        ahead = np.mod(slices.angle - slices.angle[tooth], 2.0 * math.pi)
        ahead[tooth] = 2.0 * math.pi
        earlier = whole * ahead / (2.0 * math.pi)
        chip = earlier + slices.normal_offset[tooth] - slices.normal_offset
        thickest = max(thickest, float(chip.min(axis=0).max()))
    return thickest
