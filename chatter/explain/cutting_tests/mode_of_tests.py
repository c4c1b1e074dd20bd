"""A mode more, as cutting tests show it: by where it moves the limits."""

from __future__ import annotations

import math

import numpy as np

from chatter.explain.effects.effect import Values
from chatter.explain.effects.missing_mode import MissingMode
from chatter.explain.measurement import Measurement

#: natural frequencies tried, from and to which share of the known ones, and the least of them
_TRIED, _LOWEST, _HIGHEST, _LEAST_TRIED = 20, 0.5, 2.0, 7
#: compliances tried, over the largest of the known modes: what is weaker moves no limit
_COMPLIANCES = (0.15, 0.5, 1.2)


class MissingModeOfTests(MissingMode):
    """A mode more, looked for where it is as compliant as those that are known.

    Verdicts are no linear function of its compliance: a mode of next to none tells nothing of
    where another should be.
    """

    def __init__(self, share: float) -> None:
        self.share = share  # of the frequencies that are worth trying

    def starts(self, measurement: Measurement) -> list[Values]:
        """Frequencies around and between the known modes, along x and y, of some compliances."""
        modes = measurement.case.structure.mode
        known = [mode.frequency for mode in modes]
        most = max(
            1.0 / (mode.modal_mass * (2.0 * math.pi * mode.frequency) ** 2) for mode in modes
        )
        count = max(_LEAST_TRIED, round(self.share * _TRIED))
        return [
            {"frequency": frequency, "angle": angle, "compliance": share * most}
            for frequency in np.geomspace(
                _LOWEST * min(known), _HIGHEST * max(known), count
            ).tolist()
            for angle in (0.0, 0.5 * math.pi)
            for share in _COMPLIANCES
        ]
