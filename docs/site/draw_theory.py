"""Pictures of the theory pages: ``python docs/site/draw_theory.py``."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

DOCS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(DOCS / "site"), str(DOCS.parent)]
OUT = DOCS / "pictures" / "theory"

import picture_size  # noqa: E402

import chatter  # noqa: E402
from chatter.plots import style  # noqa: E402


def _keep(figure, name: str) -> None:
    OUT.mkdir(parents=True, exist_ok=True)
    path = OUT / f"{name}.png"
    figure.savefig(path, dpi=130)
    picture_size.keep(path, path)


def geometry() -> None:
    """Half-immersion down-milling seen along the axis: angles, chip, forces."""
    figure = style.new_figure(7.0, 4.6)
    axes = figure.subplots()
    turn = np.linspace(0.0, 2.0 * np.pi, 400)
    axes.plot(np.sin(turn), np.cos(turn), color=style.GREY, linewidth=1.0)
    arc = np.linspace(0.5 * np.pi, np.pi, 100)
    axes.fill(
        np.r_[np.sin(arc), np.sin(arc[::-1]) + 0.22],
        np.r_[np.cos(arc), np.cos(arc[::-1])],
        color=style.ORANGE,
        alpha=0.35,
        linewidth=0.0,
    )
    axes.text(0.87, -0.75, "chip", color=style.ORANGE)
    angle = np.radians(125.0)
    tooth = np.array([np.sin(angle), np.cos(angle)])
    normal, travel = tooth, np.array([np.cos(angle), -np.sin(angle)])
    axes.plot([0.0, tooth[0]], [0.0, tooth[1]], color=style.BLUE)
    axes.plot([0.0, 0.0], [0.0, 1.0], color=style.GREY, linestyle=":")
    sweep = np.linspace(0.0, angle, 80)
    axes.plot(0.3 * np.sin(sweep), 0.3 * np.cos(sweep), color=style.BLUE, linewidth=1.0)
    axes.text(0.31, 0.14, "$\\phi$", color=style.BLUE)
    for way, name in ((-travel, "$F_t$"), (-normal, "$F_r$")):
        axes.annotate(
            "",
            tooth + 0.55 * way,
            tooth,
            arrowprops={"arrowstyle": "->", "color": style.RED, "linewidth": 1.6},
        )
        axes.text(*(tooth + 0.63 * way), name, color=style.RED, ha="center", va="center")
    axes.annotate("", (1.9, 0.0), (1.35, 0.0), arrowprops={"arrowstyle": "->"})
    axes.text(1.95, 0.0, "x, feed", va="center")
    axes.annotate("", (0.0, 1.45), (0.0, 1.05), arrowprops={"arrowstyle": "->"})
    axes.text(0.05, 1.4, "y")
    axes.text(1.05, 0.07, "$\\phi_s$ = 90°", fontsize=9)
    axes.text(-0.05, -1.14, "$\\phi_e$ = 180°", fontsize=9, ha="center")
    axes.set_aspect("equal")
    axes.set_xlim(-1.2, 2.5)
    axes.set_ylim(-1.25, 1.55)
    axes.axis("off")
    _keep(figure, "geometry")


def limits() -> None:
    """Zeroth-order limits and those of collocation, where few teeth cut at a time."""
    case = chatter.load(chatter.examples()["steel-half-immersion"].folder / "case.toml")
    case = case.patch({"lobes.speeds.count": 200})
    figure = style.new_figure(8.0, 3.8)
    axes = figure.subplots()
    for method, colour in (("collocation", style.BLUE), ("zero-order", style.ORANGE)):
        found = chatter.lobes(case, method=method)
        limits = found.limits
        axes.plot(limits.spindle_speed_rpm, limits.critical_depth_mm, color=colour, label=method)
    axes.set_xlabel("spindle speed [rpm]")
    axes.set_ylabel("critical axial depth [mm]")
    axes.legend(frameon=False)
    style.finish(axes)
    _keep(figure, "limits")


def describing_functions() -> None:
    """Equivalent stiffness and damping of the guide of the example over the amplitude."""
    from dynamics.friction.tanh_hysteresis import TanhHysteresis

    law = TanhHysteresis(
        coulomb=10.0, viscous=0.0, low_speed_viscous=0.0, low_speed_decay=0.0, hysteresis_slope=2e5
    )
    amplitude = np.geomspace(1e-7, 1e-4, 60)
    found = np.array([law.describing_function(one, 80.0) for one in amplitude])
    figure = style.new_figure(8.0, 3.4)
    for axes, column, scale, name in zip(
        figure.subplots(1, 2),
        found.T,
        (1e-6, 1e-3),
        ("stiffness [N/um]", "damping [kN s/m]"),
        strict=True,
    ):
        axes.semilogx(1e6 * amplitude, scale * column, color=style.BLUE)
        axes.set_xlabel("amplitude [um]")
        axes.set_ylabel(name)
        style.finish(axes)
    _keep(figure, "describing-function")


if __name__ == "__main__":
    geometry()
    describing_functions()
    limits()
