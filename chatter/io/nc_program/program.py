"""The interpreter of NC programs: modal state from block to block, and what moves.

Blocks are those of ISO 6983: G0 to G3 with X, Y, Z, centres I, J, K (from the start of the arc;
G90.1: absolute) or the radius R (Siemens: CR=), F a minute or a revolution, S, planes, units,
absolute and incremental.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from chatter.description.arrays import Array
from chatter.description.errors import InputError
from chatter.io.files import read_lines
from chatter.io.nc_program.arcs import ArcEnds, arc_by_centre, arc_by_radius
from chatter.io.nc_program.codes import END_M, G_CODES, LETTERS, PASSED_M, PLANES, REFUSED_G
from chatter.io.nc_program.words import Line, lines_of
from dynamics.frf.container import MeasurementError
from dynamics.trajectory.block_motion import Block
from dynamics.trajectory.spatial_path import Element, SpatialLine

_AXES = "XYZ"
_CENTRE = "IJK"
_UNITS = {"inch": 0.0254, "millimetre": 1e-3}
#: motion smaller than this is none, m
_NOTHING = 1e-12
#: modal groups, and what holds before the program says otherwise
_DEFAULTS: Mapping[str, str] = {
    "plane": "XY",
    "units": "millimetre",
    "distances": "absolute",
    "centres": "incremental",
    "corners": "pass",
    "feed": "a minute",
}
_DWELL = "G4: the time of a dwell is in seconds, G4 F0.5 or G4 X0.5, in a block of its own"
_MODAL = (*_DEFAULTS, "motion")


@dataclass(frozen=True)
class ProgramBlock:
    """One motion of a program."""

    line: int  # of the file, from 1
    block: Block  # its feed is infinite in rapid traverse
    rapid: bool
    spindle_speed: float | None  # rad/s, as last set

    @property
    def element(self) -> Element:
        """Line or arc, m."""
        return self.block.element


@dataclass(frozen=True)
class NcProgram:
    """The motions of a program, in metres from where it begins."""

    path: Path
    blocks: tuple[ProgramBlock, ...]

    @property
    def moved(self) -> str:
        """Letters of the axes that move."""
        reach = np.zeros(3)
        for one in self.blocks:
            along = np.linspace(0.0, one.element.length, 5)
            reach += np.ptp(one.element.at(along).position, axis=0)
        return "".join(letter for letter, way in zip(_AXES, reach, strict=True) if way > _NOTHING)


@dataclass
class _State:
    """What holds from block to block."""

    position: Array
    modal: dict[str, str] = field(default_factory=lambda: dict(_DEFAULTS))
    feed: float | None = None  # as written, in m a minute or a revolution
    spindle_speed: float | None = None  # rad/s


def read_program(path: str | Path, start: tuple[float, ...] = (0.0, 0.0, 0.0)) -> NcProgram:
    """Read an NC program.

    Parameters
    ----------
    path : path
    start : (3,) of float
        Where the tool is before the first block, in the coordinates of the program, m.

    Returns
    -------
    NcProgram

    Raises
    ------
    InputError
        If the file cannot be read, a word or code is not known, or a block makes no sense; the
        message names file and line.
    """
    path = Path(path)
    try:
        texts = read_lines(path)
    except MeasurementError as error:
        raise InputError(str(error)) from error
    state = _State(np.array(start, dtype=np.float64))
    blocks: list[ProgramBlock] = []
    for line in lines_of(path, texts):
        _refuse_unknown(line)
        codes = _codes(line)
        _set_modes(state, line, codes)
        if "dwell" in codes:
            _dwell(line, blocks)
        else:
            moved = _moved(state, line, codes)
            if moved is not None:
                blocks.append(moved)
        if any(word.letter == "M" and word.number in END_M for word in line.words):
            break
    if not blocks:
        raise InputError(f"{path}: nothing moves in this program")
    return NcProgram(path, tuple(blocks))


def _refuse_unknown(line: Line) -> None:
    for word in line.words:
        if word.letter == "P" and any(one.text in ("G4", "G04") for one in line.words):
            raise line.refuse(_DWELL)
        if word.letter not in LETTERS:
            raise line.refuse(f"{word.text}: the letter {word.letter} is not known here")
        if word.letter == "G" and word.number not in G_CODES:
            reason = REFUSED_G.get(word.number, "is not known here")
            raise line.refuse(f"{word.text}: {reason}")
        if word.letter == "M" and word.number not in PASSED_M | END_M:
            raise line.refuse(f"{word.text}: is not known here")


def _codes(line: Line) -> dict[str, str]:
    """G codes of a block by their group."""
    found: dict[str, str] = {}
    for word in line.words:
        if word.letter != "G":
            continue
        group, value = G_CODES[word.number]
        if group in found:
            raise line.refuse(f"{word.text}: a second code of {group} in one block")
        found[group] = value
    return found


def _set_modes(state: _State, line: Line, codes: Mapping[str, str]) -> None:
    if "units" in codes and state.modal["units"] != codes["units"]:
        # a feed of the other unit would be off by 25.4
        state.feed = None
    state.modal |= {group: value for group, value in codes.items() if group in _MODAL}
    if "feed" in codes:
        state.feed = None
    speed = line.of("S")
    if speed is not None:
        if speed < 0.0:
            raise line.refuse(f"S{speed:g}: a spindle speed below 0")
        state.spindle_speed = speed * math.pi / 30.0
    feed = line.of("F")
    if feed is not None and "dwell" not in codes:
        if not feed > 0.0:
            raise line.refuse(f"F{feed:g}: a feed above 0 is required")
        state.feed = feed * _UNITS[state.modal["units"]]


def _dwell(line: Line, blocks: list[ProgramBlock]) -> None:
    given = [(letter, line.of(letter)) for letter in "FXYZIJKR"]
    given = [(letter, value) for letter, value in given if value is not None]
    if len(given) != 1 or given[0][0] not in "FX" or given[0][1] < 0.0:
        raise line.refuse(_DWELL)
    if blocks:
        last = blocks[-1]
        block = last.block
        longer = Block(block.element, block.feed, True, block.dwell + given[0][1])
        blocks[-1] = ProgramBlock(last.line, longer, last.rapid, last.spindle_speed)


def _moved(state: _State, line: Line, codes: Mapping[str, str]) -> ProgramBlock | None:
    """Motion of a block; None where it has none."""
    motion = state.modal.get("motion")
    end, given = _end(state, line)
    centre = [line.of(letter) for letter in _CENTRE]
    of_arc = any(value is not None for value in centre)
    radius = _radius(line)
    if not given and not (of_arc and motion in ("clockwise", "counter-clockwise")):
        if of_arc or radius is not None:
            raise line.refuse("a centre or a radius without G2 or G3 and an end")
        return None
    if motion is None:
        raise line.refuse("a position before any of G0, G1, G2, G3")
    start, state.position = state.position, end
    if motion in ("rapid", "line"):
        if of_arc or radius is not None:
            raise line.refuse("a centre or a radius in a straight block")
        if float(np.linalg.norm(end - start)) <= _NOTHING:
            return None
        element: Element = SpatialLine(tuple(start.tolist()), tuple(end.tolist()))
    else:
        element = _arc(state, line, start, end)
    rapid = motion == "rapid"
    feed = math.inf if rapid else _feed(state, line)
    stops = state.modal["corners"] == "stop" or "stop" in codes
    block = Block(element, feed, stops)
    return ProgramBlock(line.number, block, rapid, state.spindle_speed)


def _end(state: _State, line: Line) -> tuple[Array, bool]:
    """Where a block ends, m, and whether it names an axis."""
    unit = _UNITS[state.modal["units"]]
    end, given = state.position.copy(), False
    for axis, letter in enumerate(_AXES):
        value = line.of(letter)
        if value is None:
            continue
        given = True
        incremental = line.is_incremental(letter, state.modal["distances"] == "incremental")
        before = state.position[axis] if incremental else 0.0
        end[axis] = before + unit * value
    return end, given


def _radius(line: Line) -> float | None:
    both = [value for value in (line.of("R"), line.of("CR")) if value is not None]
    if len(both) > 1:
        raise line.refuse("R and CR are both there; one radius a block")
    return both[0] if both else None


def _arc(state: _State, line: Line, start: Array, end: Array) -> Element:
    unit = _UNITS[state.modal["units"]]
    plane = PLANES[state.modal["plane"]]
    ends = ArcEnds(start, end, plane, state.modal["motion"] == "clockwise")
    centre = {axis: line.of(letter) for axis, letter in enumerate(_CENTRE)}
    given = {axis: value for axis, value in centre.items() if value is not None}
    radius = _radius(line)
    outside = [_CENTRE[axis] for axis in given if axis not in plane]
    if outside:
        raise line.refuse(f"{outside[0]} is no centre in the plane {state.modal['plane']}")
    if bool(given) == (radius is not None):
        both = "are both there" if given else "are both missing"
        raise line.refuse(f"the centre and the radius of the arc {both}; give one of them")
    absolute = state.modal["centres"] == "absolute"
    if absolute and given and set(given) != set(plane):
        letters = " and ".join(_CENTRE[axis] for axis in plane)
        raise line.refuse(f"G90.1: {letters} are both needed for an absolute centre")
    try:
        if radius is not None:
            return arc_by_radius(ends, unit * radius)
        middle = np.array([unit * given.get(axis, 0.0) for axis in plane])
        absolutely = [
            axis in given and not line.is_incremental(_CENTRE[axis], not absolute) for axis in plane
        ]
        return arc_by_centre(ends, middle - np.where(absolutely, start[list(plane)], 0.0))
    except ValueError as error:
        raise line.refuse(f"arc: {error}") from None


def _feed(state: _State, line: Line) -> float:
    """Feed, m/s."""
    if state.feed is None:
        raise line.refuse("a feed F is missing for a block of G1, G2 or G3")
    if state.modal["feed"] == "a minute":
        return state.feed / 60.0
    if not state.spindle_speed:
        raise line.refuse("G95: a feed for a revolution needs a spindle speed S")
    return state.feed * state.spindle_speed / (2.0 * math.pi)
