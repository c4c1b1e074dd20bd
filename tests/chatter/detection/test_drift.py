"""Slow drift is no chatter; chatter that begins beside it is."""

import math

import numpy as np
import pytest

from chatter.detection.chatter_detection import detect_chatter
from chatter.detection.cut_record import CutRecord

SPEED = 840.0 * math.pi / 30.0
TEETH = 5
FEED = 0.1e-3
TURNS = 40
#: a quarter of the lowest resonance, as `chatter.simulation.verdict` gives it
LOWEST = 10.0
CHATTER = 50.3


def record_of(drift, chatter, lowest=LOWEST):
    """Forced vibration of 5 um with runout, a drift and a motion at the chatter frequency, m."""
    time = np.arange(TURNS * 720) * (2.0 * math.pi / SPEED / 720)
    angle = SPEED * time
    forced = 5e-6 * np.sin(TEETH * angle) + 1e-6 * np.sin(angle)
    signals = np.column_stack([forced + drift(time), 0.5 * forced + chatter(time)])
    return CutRecord(
        time, angle, signals, 2.0 * math.pi * np.arange(TEETH) / TEETH, FEED,
        runout=np.array([3e-6, 0.0, 0.0, 1e-6, 0.0]), lowest_frequency=lowest,
    )  # fmt: skip


def none(time):
    return np.zeros_like(time)


def growing(first, e_folds):
    def motion(time):
        return first * np.exp(e_folds * time / time[-1]) * np.sin(2.0 * math.pi * CHATTER * time)

    return motion


#: what axes do that settle, creep or follow a slow wave: 0.06 um and more from turn to turn
DRIFTS = {
    "steady": lambda time: 0.06e-6 * SPEED / (2.0 * math.pi) * time,
    "slow wave": lambda time: 5e-6 * np.sin(2.0 * math.pi * 0.3 * time),
    "settling": lambda time: -4e-6 * np.exp(-time / 1.5),
    "creeping on": lambda time: 1e-6 * np.exp(time / 1.2),
}


@pytest.mark.parametrize("name", DRIFTS)
def test_drift_is_stable(name):
    found = detect_chatter(record_of(DRIFTS[name], none))
    assert found.verdict == "stable", found.reason


def test_without_a_band_the_drift_is_what_the_record_shows():
    assert detect_chatter(record_of(DRIFTS["slow wave"], none, lowest=0.0)).verdict == "chatter"


@pytest.mark.parametrize("name", DRIFTS)
@pytest.mark.parametrize(("first", "e_folds"), [(1e-9, 5.0), (5e-8, 3.0), (2e-6, 0.5), (2e-6, 0.0)])
def test_chatter_beside_a_drift(name, first, e_folds):
    found = detect_chatter(record_of(DRIFTS[name], growing(first, e_folds)))
    assert found.verdict == "chatter", found.reason
    # the drift changes the fit of the frequency by less than a tenth of a turn's frequency
    assert found.chatter_frequency == pytest.approx(CHATTER, abs=1.4)


def test_chatter_that_dies_out_beside_a_drift():
    found = detect_chatter(record_of(DRIFTS["settling"], growing(5e-6, -4.0)))
    assert found.verdict == "stable", found.reason


def test_what_changes_no_chip_is_stable_unless_it_grows():
    small = 0.5e-3 * FEED
    assert detect_chatter(record_of(none, growing(small, 0.0))).verdict == "stable"
    assert detect_chatter(record_of(none, growing(0.2 * small, 1.5))).verdict == "chatter"
