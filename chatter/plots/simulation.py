"""Picture of a simulated cut."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from chatter.description.arrays import Array
from chatter.description.unit_system import UnitSystem
from chatter.description.units import rpm
from chatter.description.usual_units import UsualUnit
from chatter.plots import style
from chatter.plots.workpiece import draw_workpiece
from chatter.simulation.tool_course import ToolCourse
from cutting.chip.discrete_chip import DiscreteCut

if TYPE_CHECKING:
    from chatter.simulation.finish import WallFinish
    from chatter.simulation.result import SimulationResult

_TURN = 2.0 * math.pi
#: of a row of panels of the height 1, inches: of all rows twelve
_HEIGHT = 12.0 / 4.3
_COLOURS = (style.BLUE, style.ORANGE, style.GREEN)
#: revolutions, or groups of them, that show a whole run as a band
_LEAST_BANDS, _MOST_BANDS = 16, 400
_SHOWN_TURNS = 3.0
#: feed shown of a profile, in revolutions
_PROFILE_TURNS = 12.0
_TITLE_WIDTH = 140
#: range of a surface that is drawn at least, m
_LEAST_SHOWN = 1e-9
#: parts of a programmed path that are coloured
_PARTS_OF_PATH = 1500
#: a component smaller than this share of the largest is left out
_NOTHING = 1e-6
#: the spectrum goes this far above the highest mode, or to this harmonic of the tooth passing
_ABOVE_MODES = 3.0
_LEAST_HARMONICS = 6
#: amplitude in a spectrum, of the largest, below which nothing is drawn
_FAINTEST = 1e-4


class _Row(NamedTuple):
    """Panels beside each other; none where there is nothing to be drawn."""

    height: float
    panels: Sequence[Callable[[Axes], None]]
    widths: tuple[float, ...] = (1.0, 1.0)


def plot_simulation(result: SimulationResult) -> Figure:
    """Draw forces, motion, spectrum, once-a-turn points and the surface of a run."""
    every = (*_signals(result), _frequency_and_section(result), _workpiece_or_surface(result))
    rows = [row for row in every if row.panels]
    heights = [row.height for row in rows]
    figure = style.new_figure(11.0, _HEIGHT * sum(heights))
    figure.suptitle(_title(result), fontsize=11.0, x=0.01, ha="left")
    for row, place in zip(rows, figure.add_gridspec(len(rows), height_ratios=heights), strict=True):
        widths = row.widths[: len(row.panels)]
        beside = place.subgridspec(1, len(widths), width_ratios=widths)
        for index, draw in enumerate(row.panels):
            draw(figure.add_subplot(beside[index]))
    notes = result.finish.notes
    if not every[-1].panels and notes:
        figure.supxlabel(notes[0], x=0.01, ha="left", fontsize=9.0, color=style.GREY)
    return figure


def _signals(result: SimulationResult) -> Iterator[_Row]:
    """Force, and displacement where there is any, over the run and over its last revolutions."""
    force, micrometres = result.units.force, result.units.instead_of("µm")
    signals = [(f"force [{force.name}]", ("Fx", "Fy", "Fz"), result.force * force.factor)]
    if result.displacement.any():
        motion = result.displacement * result.units.displacement.factor
        signals.append((f"displacement [{micrometres.name}]", ("x", "y", "z"), motion))
    for label, names, values in signals:
        shown = {"result": result, "values": values, "names": names, "label": label}
        yield _Row(1.0, [partial(draw_run, **shown), partial(draw_last_revolutions, **shown)])


def _frequency_and_section(result: SimulationResult) -> _Row:
    panels = [partial(draw_spectrum, result=result)]
    if result.displacement.any() and len(once_a_revolution(result)):
        panels.append(partial(draw_poincare_section, result=result))
    return _Row(1.15, panels, (1.7, 1.0))


def _workpiece_or_surface(result: SimulationResult) -> _Row:
    """Layers of a workpiece, the course of a program, or the wall and the profiles there are."""
    panels: list[Callable[[Axes], None]] = []
    if _shows_workpiece(result):
        layers = sorted({0, len(result.setup.slices.height) - 1})
        panels = [partial(_draw_layer, result=result, layer=layer) for layer in layers]
    elif isinstance(result.setup.path, ToolCourse):
        panels = [partial(draw_course, result=result), partial(draw_feed, result=result)]
    else:
        if result.finish.walls:
            panels.append(partial(draw_wall, result=result))
        if result.finish.walls or result.finish.floor is not None:
            panels.append(partial(draw_profiles, result=result))
    return _Row(1.15, panels)


def _draw_layer(axes: Axes, result: SimulationResult, layer: int) -> None:
    height = result.units.length.text(result.setup.slices.height[layer], ".2g")
    axes.set_title(f"workpiece {height} above the tip", **style.TITLE)
    draw_workpiece(axes, result, layer)


def draw_course(axes: Axes, result: SimulationResult) -> None:
    """Draw the path of the tool along a program, coloured by the force on it."""
    (unit, factor), force = result.units.length, result.units.force
    x, y = factor * result.setup.path.position_at(result.time)
    size = np.linalg.norm(result.force, axis=1) * force.factor
    a_part = max(1, len(size) // _PARTS_OF_PATH)
    count = len(size) // a_part
    largest = size[: count * a_part].reshape(count, a_part).max(axis=1)
    at = slice(0, count * a_part, a_part)
    axes.plot(x, y, color=style.GREY, linewidth=0.8)
    drawn = axes.scatter(x[at], y[at], c=largest, s=9.0, cmap="viridis", zorder=3)
    axes.figure.colorbar(drawn, ax=axes, label=f"largest force [{force.name}]")
    axes.set_aspect("equal", "datalim")
    axes.set_title("path of the tool", **style.TITLE)
    axes.set_xlabel(f"x [{unit}]")
    axes.set_ylabel(f"y [{unit}]")
    style.finish(axes)


def draw_feed(axes: Axes, result: SimulationResult) -> None:
    """Draw feed and spindle speed along a program over time."""
    x, y = result.setup.path.position_at(result.time)
    unit, factor = result.units.feed_rate
    feed = factor * np.hypot(np.gradient(x, result.time), np.gradient(y, result.time))
    axes.plot(result.time, feed, color=style.BLUE, linewidth=1.2)
    axes.set_title("feed, and spindle speed", **style.TITLE)
    axes.set_xlabel("time [s]")
    axes.set_ylabel(f"feed [{unit}]", color=style.BLUE)
    style.finish(axes)
    other = axes.twinx()
    other.plot(result.time, rpm(result.spindle_speed), color=style.ORANGE, linewidth=1.2)
    other.set_ylabel("spindle speed [rpm]", color=style.ORANGE)
    other.set_ylim(0.0, None)


def _shows_workpiece(result: SimulationResult) -> bool:
    """A workpiece of the user's own says more than a wall that it may not have."""
    carved = isinstance(result.setup.groups[0], DiscreteCut)
    return carved and not result.finish.walls


def _title(result: SimulationResult) -> str:
    cut, length = result.case.cut, result.units.length
    case = (
        f"{result.case.title + ': ' if result.case.title else ''}"
        f"{rpm(cut.spindle_speed):.0f} rpm, axial depth {length.text(cut.axial_depth)}, "
        f"feed {length.text(cut.feed_per_tooth)} a tooth"
    )
    found = result.detection
    if found is None:
        why = "the tool is rigid" if not result.setup.modes else "the run is too short"
        return f"{case}\nnot judged: {why}"
    verdict = found.verdict
    if not found.stable and math.isfinite(found.chatter_frequency):
        verdict += f" at {found.chatter_frequency:.0f} Hz"
        verdict += f" ({found.bifurcation})" if found.bifurcation != "none" else ""
    return f"{case}\n" + textwrap.fill(f"{verdict}: {found.reason}", _TITLE_WIDTH)


def _shown(values: Array) -> list[int]:
    """Components that are not nothing; the first if all are."""
    size = np.abs(values).max(axis=0)
    kept = [axis for axis in range(3) if size[axis] > _NOTHING * size.max()]
    return kept or [0, 1]


def draw_run(
    axes: Axes, result: SimulationResult, values: Array, names: tuple[str, ...], label: str
) -> None:
    """Draw the whole run: the band between the least and the largest value of a revolution."""
    turns = result.spindle_angle / _TURN
    whole = result.whole_revolutions
    banded = whole >= _LEAST_BANDS
    bounds = np.linspace(0, whole, min(max(whole, 1), _MOST_BANDS) + 1)
    rows = np.searchsorted(turns, bounds[:-1] - 1e-9)
    for axis in _shown(values):
        colour, name = _COLOURS[axis], names[axis]
        if banded:
            low = np.minimum.reduceat(values[:, axis], rows)
            high = np.maximum.reduceat(values[:, axis], rows)
            low, high = np.append(low, low[-1]), np.append(high, high[-1])
            band = {"color": colour, "step": "post", "label": name}
            axes.fill_between(bounds, low, high, alpha=0.5, linewidth=0.8, **band)
        else:
            axes.plot(turns, values[:, axis], color=colour, linewidth=0.8, label=name)
    axes.set(xlim=(0.0, max(result.revolutions, 1e-9)), xlabel="spindle revolutions", ylabel=label)
    if not values.any():
        _say(axes, "no force")
    band = "whole run, by revolution" if banded else "whole run"
    axes.set_title(band, **style.TITLE)
    style.finish(axes)
    _legend(axes)


def draw_last_revolutions(
    axes: Axes, result: SimulationResult, values: Array, names: tuple[str, ...], label: str
) -> None:
    """Draw the last revolutions."""
    turns = result.spindle_angle / _TURN
    first = int(np.searchsorted(turns, turns[-1] - _SHOWN_TURNS))
    for axis in _shown(values):
        axes.plot(
            turns[first:], values[first:, axis], color=_COLOURS[axis], linewidth=1.0,
            label=names[axis],
        )  # fmt: skip
    if turns[-1] > turns[first]:
        axes.set_xlim(turns[first], turns[-1])
    axes.set(xlabel="spindle revolutions", ylabel=label)
    if not values.any():
        _say(axes, "no force")
    axes.set_title("last revolutions", **style.TITLE)
    style.finish(axes)
    _legend(axes)


def _legend(axes: Axes) -> None:
    axes.legend(
        loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, fontsize=8.5, frameon=False,
        borderaxespad=0.2, handlelength=1.4,
    )  # fmt: skip


def spectrum(time: Array, signal: Array) -> tuple[Array, Array]:
    """Frequencies (m,), Hz, and amplitudes of sines in a signal (n,), with a Hann window.

    The times (n,) are evenly spaced, s.
    """
    window = np.hanning(len(signal) + 1)[:-1]
    amplitude = np.abs(np.fft.rfft((signal - signal.mean()) * window)) * 2.0 / window.sum()
    return np.fft.rfftfreq(len(signal), time[1] - time[0]), amplitude


def draw_spectrum(axes: Axes, result: SimulationResult) -> None:
    """Draw the amplitude spectrum of the displacement, or of the force on a rigid tool."""
    rigid = not result.setup.modes
    units = result.units
    values, unit = result.displacement * units.displacement.factor, units.instead_of("µm").name
    names = ("x", "y", "z")
    if rigid:
        values, unit = result.force * units.force.factor, units.force.name
        names = ("Fx", "Fy", "Fz")
    axes.set_title(
        f"spectrum of the {'force' if rigid else 'displacement'}, last half of the run",
        **style.TITLE,
    )
    axes.set(xlabel="frequency [Hz]", ylabel=f"amplitude [{unit}]")
    rows = result.settled
    tooth = result.case.tool.teeth * result.case.cut.spindle_speed / _TURN
    modes = [mode.frequency for mode in result.setup.modes]
    top = max(_LEAST_HARMONICS * tooth, _ABOVE_MODES * max(modes, default=0.0))
    largest = 0.0
    if rows.stop - rows.start >= 16:
        lines = {axis: spectrum(result.time[rows], values[rows, axis]) for axis in _shown(values)}
        top = max(_LEAST_HARMONICS * tooth, min(top, 1.1 * _highest_line(lines.values())))
        for axis, (frequency, amplitude) in lines.items():
            shown = frequency <= top
            axes.plot(
                frequency[shown], amplitude[shown], color=_COLOURS[axis], linewidth=1.0,
                label=names[axis], zorder=3,
            )  # fmt: skip
            largest = max(largest, float(amplitude[shown].max()))
    _mark_harmonics(axes, tooth, result.case.tool.teeth, top)
    _mark_chatter(axes, result)
    axes.set_xlim(0.0, top)
    if largest > 0.0:
        axes.set(yscale="log", ylim=(largest * _FAINTEST, largest * 2.0))
        style.write_powers(axes.yaxis)
    style.finish(axes)
    axes.grid(visible=False, axis="x")
    axes.legend(loc="upper right", fontsize=8.0, framealpha=0.9, ncols=2)


def _highest_line(lines: Iterable[tuple[Array, Array]]) -> float:
    """Highest frequency of some spectra, Hz, whose amplitude is seen beside the largest of all."""
    lines = list(lines)
    faintest = _FAINTEST * max((amplitude.max() for _, amplitude in lines), default=0.0)
    seen = [frequency[amplitude > faintest] for frequency, amplitude in lines]
    return max((float(one[-1]) for one in seen if one.size), default=0.0)


def _mark_harmonics(axes: Axes, tooth: float, teeth: int, top: float) -> None:
    turn = tooth / teeth
    if teeth > 1 and top / turn < 120:
        revolutions = turn * np.arange(1, int(top / turn) + 1)
        _mark_frequencies(axes, revolutions, color="#E4E4E4")
    marked = int(top / tooth + 1e-9)
    if 0 < marked <= 60:
        passing = {"color": style.GREY, "linestyle": (0, (4, 3)), "label": "tooth passing"}
        _mark_frequencies(axes, tooth * np.arange(1, marked + 1), **passing)


def _mark_frequencies(axes: Axes, frequencies: Array, **look: Any) -> None:
    """Draw lines over the whole height, as one: each of its own takes its time."""
    over_the_height = axes.get_xaxis_transform()
    axes.vlines(
        frequencies, 0.0, 1.0, transform=over_the_height, linewidth=0.7, zorder=1, **look
    )  # fmt: skip


def _mark_chatter(axes: Axes, result: SimulationResult) -> None:
    found = result.detection
    if found is None or not math.isfinite(found.chatter_frequency):
        return
    chatter = found.chatter_frequency
    axes.axvline(
        chatter,
        color=style.RED,
        linewidth=2.2,
        alpha=0.45,
        zorder=2,
        label=f"chatter {chatter:.0f} Hz",
    )


def draw_poincare_section(axes: Axes, result: SimulationResult) -> None:
    """Draw the displacement each time the first tooth is at +y."""
    axes.set_title("once a revolution", **style.TITLE)
    plane = moving_plane(result)
    unit, factor = result.units.instead_of("µm")
    axes.set(xlabel=f"{'xyz'[plane[0]]} [{unit}]", ylabel=f"{'xyz'[plane[1]]} [{unit}]")
    style.finish(axes)
    points = once_a_revolution(result, plane) * factor
    half = len(points) // 2
    orbit = result.displacement[result.settled][:, plane] * result.units.displacement.factor
    axes.plot(*orbit.T, color="#C9D6DF", linewidth=0.5, zorder=1)
    axes.plot(*points[:half].T, ".", color=style.GREY, markersize=3, label="first half", zorder=2)
    axes.plot(*points[half:].T, "o", color=style.RED, markersize=3, label="last half", zorder=3)
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(loc="best", fontsize=7.5, framealpha=0.85)


def moving_plane(result: SimulationResult) -> tuple[int, int]:
    """Axes of the displacement that a picture of two shows: x and y unless one of them rests."""
    swing = np.ptp(result.displacement, axis=0) if len(result.rows) else np.zeros(3)
    moving = [axis for axis in range(3) if swing[axis] > 0.0]
    if len(moving) == 2:
        return moving[0], moving[1]
    return (0, 2) if moving == [2] else (0, 1)


def once_a_revolution(result: SimulationResult, plane: tuple[int, int] = (0, 1)) -> Array:
    """Displacement (revolutions, 2) along two axes, µm, each time the first tooth is at +y."""
    turns = np.arange(1, result.whole_revolutions + 1)
    if len(turns) == 0 or len(result.rows) < 4:
        return np.zeros((0, 2))
    # steps divide a turn, so that a turn seldom ends between two rows, and then close to one
    columns = result.displacement[:, plane].T
    motion = [np.interp(turns * _TURN, result.spindle_angle, column) for column in columns]
    return np.stack(motion, axis=1) * 1e6


def draw_wall(axes: Axes, result: SimulationResult) -> None:
    """Draw the deviation of the wall over feed and height."""
    axes.set_title("wall, deviation (positive: too much removed)", **style.TITLE)
    length, small = result.units.length, result.units.displacement
    axes.set(xlabel=f"feed [{length.name}]", ylabel=f"height [{length.name}]")
    wall = result.finish.walls[0].profiles
    x, deviation = wall.x * length.factor, wall.deviation * small.factor
    low, high = np.percentile(deviation, [0.5, 99.5])
    least = _LEAST_SHOWN * small.factor
    if high - low < 1e-3 * least:
        low, high = low - 0.5 * least, high + 0.5 * least
    edges = (_edges(x), np.maximum(_edges(wall.height * length.factor), 0.0))
    image = axes.pcolormesh(*edges, deviation, cmap="cividis", vmin=low, vmax=high, rasterized=True)
    bar = axes.figure.colorbar(image, ax=axes, pad=0.02)
    bar.set_label(f"wall at {wall.side} [{result.units.instead_of('µm').name}]", fontsize=9)
    bar.ax.tick_params(labelsize=8)
    style.finish(axes)
    axes.grid(visible=False)


def _edges(middle: Array) -> Array:
    """Bounds (n+1,) of the cells around points (n,)."""
    half = 0.5 * np.diff(middle) if len(middle) > 1 else 0.5 * np.abs(middle[:1])
    return np.concatenate(
        [[middle[0] - half[0]], middle[1:] - half[: len(middle) - 1], [middle[-1] + half[-1]]]
    )


def draw_profiles(axes: Axes, result: SimulationResult) -> None:
    """Draw the profile of every wall at half its height, and of the floor."""
    axes.set_title("profiles along the feed, about their mean", **style.TITLE)
    finish, units = result.finish, result.units
    axes.set_xlabel(f"feed from the start of what is evaluated [{units.length.name}]")
    axes.set_ylabel(f"material left [{units.instead_of('µm').name}]")
    shown = _PROFILE_TURNS * result.case.tool.teeth * result.case.cut.feed_per_tooth
    for wall, colour in zip(finish.walls, (style.BLUE, style.ORANGE), strict=False):
        middle = wall.profiles.deviation[len(wall.profiles.height) // 2]
        look = {"color": colour, "label": _wall_label(wall, units)}
        _draw_profile(axes, wall.profiles.x, -middle, shown, units, **look)
    if finish.floor is not None:
        floor = finish.floor
        unit, factor = _roughness_unit(units)
        rough = f"Ra {round(floor.texture.roughness.mean * factor, 6):.3g} {unit}"
        label = f"floor: {'without feed marks' if floor.profile.sharp else rough}"
        look = {"color": style.GREEN, "label": label}
        _draw_profile(axes, floor.profile.x, floor.profile.height, shown, units, **look)
    style.finish(axes)
    axes.margins(x=0.0)
    low, high = axes.get_ylim()
    least = _LEAST_SHOWN * units.displacement.factor
    if high - low < least:
        low, high = -0.5 * least, 0.5 * least
    axes.set_ylim(low, high + 0.22 * (high - low) * (len(axes.lines) + 0.5) / 2.0)
    axes.legend(loc="upper left", fontsize=8.0, framealpha=0.85)


def _draw_profile(
    axes: Axes, x: Array, profile: Array, longest: float, units: UnitSystem, **look: Any
) -> None:
    """Draw a profile from the start of the stretch that was evaluated."""
    shown = x - x[0] <= longest
    x, profile = x[shown], profile[shown]
    height = (profile - profile.mean()) * units.displacement.factor
    axes.plot((x - x[0]) * units.length.factor, height, linewidth=1.0, **look)


def _roughness_unit(units: UnitSystem) -> UsualUnit:
    """Unit of Ra and Rz, with the sign of a millionth."""
    return UsualUnit(units.roughness.name.replace("u", "µ", 1), units.roughness.factor)


def _wall_label(wall: WallFinish, units: UnitSystem) -> str:
    rough, of_rough, small = wall.texture.roughness, _roughness_unit(units), units.displacement
    return (
        f"wall {wall.profiles.side}: Ra {of_rough.text(rough.mean, '.3g')}, "
        f"Rz {of_rough.text(rough.depth, '.3g')}, "
        f"location error {wall.location_error * small.factor:+.3g} {units.instead_of('µm').name}"
    )


def _say(axes: Axes, text: str) -> None:
    box = {"facecolor": "white", "edgecolor": "none"}
    axes.text(
        0.5, 0.5, text, transform=axes.transAxes, ha="center", va="center", color=style.GREY,
        fontsize=9, bbox=box,
    )  # fmt: skip
