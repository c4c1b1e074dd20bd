"""What the examination of hammer records reports."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Fault = Literal[
    "unreadable",
    "no_hit",
    "cut_hit",
    "late_hit",
    "double_hit",
    "clipped",
    "dropout",
    "drift",
    "stuck_samples",
    "wrong_gain",
    "wrong_polarity",
    "trigger_skew",
    "late_bump",
    "no_coherence",
    "unlike_the_others",
    "not_comparable",
]


@dataclass(frozen=True)
class Finding:
    """One fault of one record.

    Parameters
    ----------
    record : str
        Name of the record.
    fault : str
        Kind of fault.
    reason : str
        A sentence with the evidence: where, how large, against what.
    is_decisive : bool
        True where the record must not be averaged; False for a remark, where the evidence does
        not say which record is at fault.
    """

    record: str
    fault: Fault
    reason: str
    is_decisive: bool = True
