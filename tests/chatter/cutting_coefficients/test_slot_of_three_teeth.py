"""Waveforms of a slot with an odd number of teeth: half a revolution further fits them alike."""

import math

import numpy as np
import pytest

from chatter.cutting_coefficients.identify import coefficients
from chatter.description.errors import InputError
from tests.chatter.cutting_coefficients import test_waveforms as waveforms

#: chip and edge forces of both turns differ in sense only where the tool is in the work for 180 deg
SLOT = (0.0, math.pi)
OFFSETS = ((25.0, -15.0, 5.0), (-10.0, 20.0, 8.0))
UNKNOWN = "".join(
    f'[channels.F{axis}]\nquantity = "force"\non = "tool"\nsign = "unknown"\ndirection = {one}\n'
    for axis, one in zip("xyz", ([1, 0, 0], [0, 1, 0], [0, 0, 1]), strict=True)
)


@pytest.fixture(autouse=True)
def slot(monkeypatch):
    monkeypatch.setattr(waveforms, "ARC", SLOT)
    monkeypatch.setattr(waveforms, "RUNOUT", 0.0)
    case = waveforms.CASE.replace('"up"', '"slot"').replace('"3 mm"', '"12 mm"')
    monkeypatch.setattr(waveforms, "CASE", case)


@pytest.mark.parametrize("turned", [0.0, math.pi])
@pytest.mark.parametrize(
    ("channels", "senses"), [("", (1.0, 1.0, 1.0)), (UNKNOWN, (-1.0, 1.0, -1.0))]
)
def test_chip_and_edge_coefficients_have_their_senses(
    tmp_path, monkeypatch, turned, channels, senses
):
    starts = tuple(one + turned for one in waveforms.STARTS)
    monkeypatch.setattr(waveforms, "STARTS", starts)
    folder = waveforms.records(tmp_path, channels=channels, senses=senses, offsets=OFFSETS)
    found = waveforms.fitted(folder)
    for name, (value, deviation) in waveforms.numbers(found["coefficients"]).items():
        assert value > 0.0, name
        assert abs(value - waveforms.TRUE[name]) < 3.0 * deviation, name
        if name[1] != "a":  # the axial force hardly varies in a slot
            assert value == pytest.approx(waveforms.TRUE[name], rel=0.04), name
    if channels:
        assert list(found["signs"].values()) == list(senses)


def test_a_direction_that_is_unknown_is_asked_for(tmp_path):
    """A real slot so declared was "6 mean forces determine no force law"."""
    channels = UNKNOWN.replace("direction = [1, 0, 0]", 'direction = "unknown"')
    folder = waveforms.records(tmp_path, channels=channels, offsets=OFFSETS)
    with pytest.raises(InputError, match=r"channels\.Fx\.direction: is unknown"):
        coefficients(folder)


@pytest.mark.parametrize(("kept", "sense"), [("c", -1.0), ("e", 1.0)])
def test_both_turns_fit_alike_but_for_the_senses_of_chip_and_edge(monkeypatch, kept, sense):
    """Chip forces half a revolution on are a constant less what they were, edge forces the same."""
    true = {key: value * (key[2] == kept) for key, value in waveforms.TRUE.items()}
    monkeypatch.setattr(waveforms, "TRUE", true)
    time = np.linspace(0.0, 2.0 * math.pi / waveforms.TURN, 360, endpoint=False)
    now, turned = (waveforms.forces(time, 1e-4, start) for start in (0.3, 0.3 + math.pi))
    changes = np.ptp(turned - sense * now, axis=0)[:2]
    assert np.all(changes < 0.02 * np.ptp(now, axis=0)[:2])
