"""A case, and a compiled model, at another radial depth and feed per tooth."""

from __future__ import annotations

from dataclasses import replace

from chatter.description.case import Case
from chatter.stability.model import MillingModel


def at_width_and_feed(case: Case, width: float, feed: float) -> Case:
    """Case with another radial depth and feed per tooth, m."""
    values = {"cut.feed_per_tooth": feed}
    if case.cut.mode != "slot":
        values["cut.radial_depth"] = width
    return case.patch({path: value for path, value in values.items() if value != case.get(path)})


def model_at(model: MillingModel, width: float, feed: float) -> MillingModel:
    """Model at another radial depth and feed per tooth, m; its structure is not looked at again."""
    return replace(model, case=at_width_and_feed(model.case, width, feed))
