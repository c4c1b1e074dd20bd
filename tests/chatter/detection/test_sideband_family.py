"""Chatter whose own sidebands show the speed; lines that are as far from harmonics by chance."""

import numpy as np
import pytest

from chatter.detection.spectral.recording import Recording
from chatter.monitoring.detect import detect
from tests.chatter.detection.made_recordings import RATE, clock, noise

#: revolution, Hz, teeth, and lines: multiples of the revolution with their amplitudes
FEW_LINES = (
    36.22, 3, ((17.23, 1.0), (20.23, 0.25), (14.23, 0.1), (9.027, 0.15), (8.282, 0.1), (1.0, 0.1)),
)  # fmt: skip
BESIDE_A_STRONG_CUT = (
    188.5, 3, ((5, 1.0), (4.81, 0.55), (6, 0.45), (8, 0.3), (3, 0.2), (1.81, 0.1), (7.81, 0.15)),
)  # fmt: skip
WITH_ITS_MULTIPLES = (
    27.49, 7, ((26.84, 0.75), (33.84, 0.2), (19.84, 0.2), (53.68, 0.5), (60.68, 0.25),
               (46.68, 0.2), (80.52, 0.2), (87.52, 0.15)),
)  # fmt: skip


def recording(revolution, lines, level):
    """Lines in noise of a root mean square."""
    random, time = np.random.default_rng(1), clock(2.5)
    wave = sum(
        size * np.cos(2.0 * np.pi * order * revolution * time + order) for order, size in lines
    )
    values = wave + noise(random, time, level)
    return Recording("made", 1.0 / RATE, ("a",), ("acceleration",), values[:, None])


@pytest.mark.parametrize(
    ("made", "level", "stated"),
    [
        (FEW_LINES, 0.15, 1.0),
        (FEW_LINES, 0.15, 1.01),
        *((BESIDE_A_STRONG_CUT, 0.1, stated) for stated in (0.99, 1.0, 1.01)),
        *((WITH_ITS_MULTIPLES, 0.02, stated) for stated in (0.99, 1.0, 1.01)),
    ],
)
def test_a_line_is_judged_by_the_speed_of_its_own_sidebands(made, level, stated):
    """They were stable, idle or not judged by a speed that all lines, or a note, had given."""
    revolution, teeth, lines = made
    found = detect(recording(revolution, lines, level), f"{60.0 * stated * revolution} rpm", teeth)
    assert found.verdict == "chatter"
    # any line of the family: a multiple of the line of the list that is no harmonic, and its
    # sidebands so many teeth apart
    line = next(order for order, _ in lines if order % 1.0)
    found_at = found.chatter_frequency / revolution
    apart = [(found_at - multiple * line) / teeth for multiple in (1, 2, 3)]
    assert min(abs(one - round(one)) for one in apart) < 0.02
    shown = [one.spindle_frequency for one in found.segments if "they show" in one.reason]
    assert shown == pytest.approx([revolution] * len(shown), rel=1e-3)


@pytest.mark.parametrize("order", np.linspace(10.1, 30.9, 8))
def test_a_line_of_the_machine_among_close_harmonics_is_none(order):
    """Some harmonics are as far from it as the teeth of a speed a per cent off would be."""
    revolution, teeth = 25.0, 6
    size = np.where(np.arange(1, 80) % teeth, 0.2, 1.0)
    lines = [(k + 1, one / (1.0 + 0.05 * k)) for k, one in enumerate(size)]
    found = detect(recording(revolution, [*lines, (order, 1.5)], 0.05), "1500 rpm", teeth)
    assert found.verdict != "chatter"


def test_speed_and_line_that_change_with_each_other_are_no_chatter():
    """Harmonics of a spindle at 94 % of the stated speed are off those of the stated one."""
    lines = [(0.94 * k, 1.0 / k) for k in range(3, 40, 3)]
    found = detect(recording(36.0, lines, 0.1), "2160 rpm", 3)
    assert found.verdict != "chatter"
