"""A cut laid out for steps in time, with the contact of tool and work."""

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from chatter.stability.cut_arrays import CutArrays
from chatter.stability.model import MillingModel


class Contact(NamedTuple):
    """Contact of tool and work; see `cutting.process_damping.contact`."""

    stiffness: float = 0.0  # N/m
    damping: float = 0.0  # N s/m
    full_share: float = 1.0  # engaged share of the depth from which on it acts whole


class SteppedCut(NamedTuple):
    """A milling cut with speed and depth left open, and what the steps need besides."""

    arrays: CutArrays
    fastest: float  # vibration that steps resolve, with no cut, rad/s
    contact: Contact


#: a cut with edge segments of a relative length
CutAt = Callable[[float], SteppedCut]


def with_contact(cut: CutArrays, contact: Contact = Contact()) -> SteppedCut:  # noqa: B008
    """Lay out a cut with a contact of tool and work, none by default."""
    reach = np.linalg.norm(cut.shape, axis=1) * np.linalg.norm(cut.force_gain, axis=1)
    # the stiffest that the contact can make a mode
    fastest = math.hypot(cut.fastest, math.sqrt(contact.stiffness * float(reach.max())))
    return SteppedCut(cut, fastest, contact)


def stepped_cut(model: MillingModel, max_depth: float, relative_length: float = 1.0) -> SteppedCut:
    """Lay out the cut of a model down to a depth (m).

    `relative_length` is a factor on the length of the edge segments.
    """
    section, cut = model.case.contact, model.cut(max_depth, relative_length)
    if section is None:
        return with_contact(cut)
    share = max(section.full_engagement_share, 1e-12)
    return with_contact(cut, Contact(section.stiffness, section.damping, share))


def stepped_cuts(model: MillingModel, max_depth: float) -> CutAt:
    """The cut of a model with edge segments of any relative length, down to a depth (m)."""
    return partial(stepped_cut, model, max_depth)
