"""Cuts whose forces do not vary over the revolution, so that an offset may be what they are.

Four teeth in a slot, and four that are in the work for a quarter of a revolution: the sum of
sin^2, of sin cos and of the teeth in the cut is the same at every angle.
"""

import math

import numpy as np
import pytest

import chatter
from tests.chatter.cutting_coefficients import test_waveforms as waveforms

OFFSETS = (30.0, -20.0, 12.0)
#: what the dynamometer drifts by when the cut begins, N: less than a tenth of the edge forces
_AFTER_AIR = 0.2
FEEDS = (4e-5, 7e-5, 1e-4)


def folder_of(folder, monkeypatch, arc, width, air):
    """Cuts of four teeth without runout; some seconds of air, which shows the offsets, first."""
    monkeypatch.setattr(waveforms, "TEETH", 4)
    monkeypatch.setattr(waveforms, "ARC", arc)
    monkeypatch.setattr(waveforms, "RUNOUT", 0.0)
    case = waveforms.CASE.replace("teeth = 3", "teeth = 4").replace('"3 mm"', width)
    (folder / "case.toml").write_text(case, encoding="utf-8")
    random = np.random.default_rng(4)
    text = 'kind = "milling"\ncase = "case.toml"\n'
    for number, feed in enumerate(FEEDS):
        time = np.arange(0.0, 0.6 + air, 2e-4)
        cut = waveforms.forces(time, feed, 0.9 + number)
        cut[time < air] = 0.0
        cut[time >= air] += _AFTER_AIR
        values = cut + OFFSETS + 0.5 * random.standard_normal(cut.shape)
        file = f"feed_{number}.csv"
        np.savetxt(
            folder / file, np.c_[time, values], delimiter=",", comments="",
            header="time [s],Fx [N],Fy [N],Fz [N]",
        )  # fmt: skip
        text += f'[[run]]\nfile = "{file}"\nfeed_per_tooth = "{1e3 * feed} mm"\n'
    (folder / "measurement.toml").write_text(text, encoding="utf-8")
    return folder


@pytest.mark.parametrize(
    ("arc", "width"), [((0.0, math.pi), '"12 mm"'), ((0.0, 0.5 * math.pi), '"6 mm"')]
)
def test_with_air_the_means_tell_all_coefficients(tmp_path, monkeypatch, arc, width):
    folder = folder_of(tmp_path, monkeypatch, arc, width, air=0.4)
    summary = chatter.coefficients(folder).with_waveforms().summary()
    assert summary["from"] == "waveforms"
    for name, (value, deviation) in waveforms.numbers(summary["coefficients"]).items():
        assert value == pytest.approx(waveforms.TRUE[name], rel=0.04), name
        assert abs(value - waveforms.TRUE[name]) < 3.0 * deviation, name
    assert summary["linear_law_holds"]


def test_without_air_what_an_offset_may_be_is_named(tmp_path, monkeypatch):
    folder = folder_of(tmp_path, monkeypatch, (0.0, 0.5 * math.pi), '"6 mm"', air=0.0)
    summary = chatter.coefficients(folder).with_waveforms().summary()
    assert summary["from"] == "waveforms"
    (note,) = (one for one in summary["notes"] if "offset" in one)
    assert "do not tell Kae from an offset" in note
    found = waveforms.numbers(summary["coefficients"])
    for name in ("Ktc", "Krc", "Kte", "Kre"):
        assert found[name][0] == pytest.approx(waveforms.TRUE[name], rel=0.04), name


def test_chip_forces_that_do_not_vary_are_those_of_the_means(tmp_path, monkeypatch):
    folder = folder_of(tmp_path, monkeypatch, (0.0, math.pi), '"12 mm"', air=0.0)
    found = chatter.coefficients(folder).with_waveforms()
    assert found.origin == "mean forces"
    assert found.material["Ktc"] == pytest.approx(waveforms.TRUE["Ktc"], rel=0.02)
