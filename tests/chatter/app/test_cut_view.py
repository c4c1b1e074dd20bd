"""Cut in the workbench, driven in process."""

from __future__ import annotations

import json
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.io.wavfile

from chatter.app.workbench.cut_view import sound_of

PATIENCE = 600.0


def test_a_cut_is_simulated_and_heard(workbench):
    view = workbench.cut
    workbench.session.set_values([("cut.axial_depth", "0.5 mm")])
    assert not view._pictures.visible  # axes of nothing
    view.start()
    assert view.computations.wait(PATIENCE)
    assert (view._pictures.visible, view._carved.visible) == (True, False)
    assert view.message.object.startswith("stable")
    told = json.loads((workbench.session.results("simulate") / "summary.json").read_text())
    # the peak of the summary is that of the settled cut
    settled = view.signals.data["time"] >= view.result.time[view.result.judged.start]
    drawn = np.abs(view.signals.data["Fx"][settled]).max()
    assert drawn == pytest.approx(told["peak_force_N"]["Fx"], rel=0.02)
    rate, heard = scipy.io.wavfile.read(view._sound_file())
    assert rate == 44_100
    assert len(heard) >= 2 * rate
    # the wall in micrometres, the last revolutions of it
    deviation = view.result.finish.walls[0].profiles.deviation * 1e6
    drawn = np.array(view.surface.faces.data["deviation"])
    assert deviation.min() <= drawn.min() < drawn.max() <= deviation.max()
    assert np.ptp(drawn) > 0.2 * np.ptp(deviation[:, len(deviation[0]) // 2 :])
    view.player.value = 50
    assert view._figures["force"].x_range.end == pytest.approx(0.5 * view.result.time[-1])


def test_the_cut_on_the_page_is_that_of_the_open_case(workbench, tmp_path):
    """Another case was opened, and the cut of the one before stood under its name."""
    (tmp_path / "other.toml").write_text((tmp_path / "case.toml").read_text())
    view = workbench.cut
    view.start()
    assert view.computations.wait(PATIENCE)
    view.refresh()
    workbench.session.set_values([("cut.axial_depth", "0.4 mm")])
    view.refresh()
    assert "was changed after" in view.message.object
    assert view._pictures.visible
    workbench.open("other.toml")
    view.refresh()
    assert view.result is None
    assert not view._pictures.visible
    assert view._before.objects == []
    workbench.session.open("case.toml")
    view.refresh()
    assert view._before.objects  # as it was saved


def test_the_sound_has_the_frequency_of_the_tool():
    time = np.arange(0.0, 0.5, 2e-5)
    moved = np.zeros((len(time), 3))
    moved[:, 1] = 1e-5 * np.sin(2.0 * np.pi * 500.0 * time)
    heard = sound_of(SimpleNamespace(settled=slice(0, len(time)), time=time, displacement=moved))
    line = np.argmax(np.abs(np.fft.rfft(heard.astype(float)))) * 44_100 / len(heard)
    assert line == pytest.approx(500.0, abs=2.0)
