"""Picture of signals that contradict their case: the first run as it was recorded."""

import numpy as np
import pytest

from chatter.explain.measurement_file import read_measurement
from chatter.plots.explanation import plot_signals
from tests.places import EXAMPLES

CASE = (EXAMPLES / "two-degrees-of-freedom" / "case.toml").read_text()


def test_every_channel_is_drawn_over_time(tmp_path):
    """The picture ended in TypeError, and with it every explanation of contradictory data."""
    (tmp_path / "case.toml").write_text(CASE)
    time = np.arange(2.0, 2.1, 1e-4)
    rows = [f"{t:.4f},{30 * np.sin(600 * t)},{1e-6 * np.cos(600 * t)}" for t in time]
    (tmp_path / "run.csv").write_text("\n".join(["time [s],Fx [N],x [m]", *rows]))
    (tmp_path / "measurement.toml").write_text(
        'kind = "milling"\ncase = "case.toml"\n[[run]]\nfile = "run.csv"\n'
    )
    drawn = plot_signals(read_measurement(tmp_path)).axes
    assert [(one.get_ylabel(), one.get_xlabel()) for one in drawn] == [
        ("Fx [N]", "time [s]"), ("x [um]", "time [s]")
    ]  # fmt: skip
    for axes, amplitude in zip(drawn, (30.0, 1.0), strict=True):
        (line,) = axes.lines
        assert line.get_xdata()[0] == pytest.approx(2.0)
        assert np.abs(line.get_ydata()).max() == pytest.approx(amplitude, rel=0.01)
