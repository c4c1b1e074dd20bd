"""Friction makes the limit depth depend on the vibration: lobes at an amplitude against time.

A table on one slide, held by its brake, with the friction of its guide. At vanishing vibration the
friction is a spring; as the vibration grows it gives way and damps; when it slides it is small.
Lobes take its describing function at a stated amplitude (`structure.friction_amplitude`). In the
time domain a cut just beyond its limit settles at the amplitude at which the friction damps
enough: the depth is then the limit at that amplitude.
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

import chatter
from chatter.description.case import Case
from chatter.plots import style
from chatter.stability.methods.zeroth_order.limits import zero_order_of
from chatter.stability.model import milling_model

HERE = Path(__file__).parent
DEPTHS = (9.0, 9.5, 10.0, 10.5, 11.0, 11.5, 12.0, 13.0)  # mm
#: beyond the largest limit at any amplitude nothing holds the vibration but the chip
HELD = 11.5
AMPLITUDES = np.geomspace(0.2, 60.0, 25)  # um


def limit_at(case: Case, amplitude: float) -> float:
    """Limit depth with the friction linearised at an amplitude, mm; um."""
    changed = case.patch({"structure.friction_amplitude": amplitude * 1e-6})
    found = zero_order_of(milling_model(changed), np.array([case.cut.spindle_speed]))
    return float(found.critical_depth[0] * 1e3)


def amplitude_reached(case: Case, depth: float) -> float:
    """Amplitude at which the vibration of a cut settles, um; mm."""
    result = chatter.simulate(case.patch({"cut.axial_depth": depth * 1e-3}))
    last = result.displacement[int(0.95 * len(result.time)) :, 1]
    return float(np.ptp(last) / 2.0 * 1e6)


def plot_limits(
    limits: NDArray, reached: dict[float, float], stuck: float, without: float
) -> Figure:
    """Limit depth over amplitude, and where cuts settle."""
    figure = style.new_figure(8.0, 5.0)
    axes = figure.subplots()
    axes.semilogx(AMPLITUDES, limits, color=style.BLUE, label="lobes, describing function")
    axes.axhline(stuck, color=style.GREY, lw=0.8, ls="--", label="lobes, friction stuck")
    axes.axhline(without, color=style.GREY, lw=0.8, ls=":", label="lobes, no friction")
    held = {depth: one for depth, one in reached.items() if depth <= HELD}
    lost = {depth: one for depth, one in reached.items() if depth > HELD}
    axes.plot(list(held.values()), list(held), "o", color=style.RED, label="time domain: settles")
    axes.plot(
        list(lost.values()),
        list(lost),
        "o",
        mfc="none",
        color=style.RED,
        label="time domain: held by the chip alone",
    )
    axes.set_xlabel("amplitude of the vibration [µm]")
    axes.set_ylabel("limit depth, depth of the cut [mm]")
    axes.legend(fontsize=8.0, frameon=False)
    style.finish(axes)
    return figure


def main(out: Path) -> list[Path]:
    """Compare limits at amplitudes with the amplitudes at which cuts settle."""
    case = chatter.load(HERE / "case.toml")
    speed = np.array([case.cut.spindle_speed])
    stuck = limit_at(case, 0.0)
    slides = milling_model(case.patch({"structure.friction": False}))
    without = float(zero_order_of(slides, speed).critical_depth[0] * 1e3)
    limits = np.array([limit_at(case, one) for one in AMPLITUDES])
    reached = {depth: amplitude_reached(case, depth) for depth in DEPTHS}
    out = Path(out)
    out.mkdir(parents=True, exist_ok=True)
    picture = out / "friction-amplitude.png"
    plot_limits(limits, reached, stuck, without).savefig(picture)
    return [picture, write_limits(case, reached, out)]


def write_limits(case: Case, reached: dict[float, float], out: Path) -> Path:
    """Print and write depths of cuts, their amplitudes and the limits there."""
    path = out / "limits.csv"
    lines = ["depth of the cut [mm],amplitude reached [um],limit of the lobes there [mm]"]
    for depth, amplitude in reached.items():
        lines.append(f"{depth:g},{amplitude:.3g},{limit_at(case, amplitude):.4g}")
    path.write_text("\n".join(lines) + "\n")
    print(path.read_text())
    return path


if __name__ == "__main__":
    main(Path("out"))
