"""Gantry and tool bracket from drawings to super-elements, by solid elements and Craig-Bampton.

The paper meshes both from their CAD models, which it does not print: every dimension here is
assumed, and the plate of the bracket fitted to a published frequency by `calibrate.py`. The results
are shipped, so that the machine needs no finite elements any more.

    python gantry_parts.py        (needs scikit-fem, `pip install "chatter[solid]"`)
"""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from chatter.io.super_element import write_super_element
from dynamics.reduction.craig_bampton import super_element
from dynamics.reduction.modal_truncation import undamped_modes
from dynamics.reduction.tied_part import TiedPart, tied_part
from dynamics.structure.bodies import rigid_motion
from dynamics.structure.linear_structure import LinearStructure
from dynamics.structure.solid_elements import ALUMINIUM, STEEL, boxes, solid_matrices

HERE = Path(__file__).parent
#: side of an element, m, at the most
LONGEST = {"gantry": 0.10, "bracket": 0.03}
#: fixed-interface modes kept, up to, Hz
HIGHEST = {"gantry": 3000.0, "bracket": 5000.0}

# --- gantry, m: x is its travel, y along the crossbeam, z up from the X guides --------------------
# Five parts, three of aluminium and two of steel (published): crossbeam, two legs, two foot plates.
FOOT, FOOT_HEIGHT = 0.50, 0.04  # half length along x; steel
LEG = 0.40  # half length along x of a leg, a box with walls under those of the crossbeam
UNDERSIDE = 0.11  # of the crossbeam
HALF_DEPTH = 0.20  # of the crossbeam, along x
TOP = 0.24  # of the crossbeam
END, INNER = 0.97, 0.83  # of the crossbeam and outer face of a leg, inner face of a leg
MIDDLE_OF_FOOT = 0.90
LEG_WALL, WEB, RIB = 0.015, 0.020, 0.012
FLANGE = 0.0102  # of the crossbeam, above and below
RIBS = (-0.55, -0.275, 0.0, 0.275, 0.55)
# two rails and between them the magnets of the linear motor on a strip, of steel
RAIL = (0.140, 0.165)
RAIL_HEIGHT, STRIP_HEIGHT, HALF_STRIP = 0.025, 0.015, 0.05
LONGEST_TRAVEL = 0.72  # ends of the rails
# --- what is tied to it ---------------------------------------------------------------------------
BLOCK = (0.40, 0.50)  # along x, of a guide block under a foot
PINION = 0.06  # half length of the motor's seat
STATIONS = tuple(np.round(np.linspace(-0.66, 0.66, 7), 6).tolist())
PATCH = 0.03  # half length of rails that a point follows

# --- bracket, m: a flange under the head and a plate down to the tool ----------------------------
WIDTH, PLATE_LENGTH, FLANGE_DEPTH, FLANGE_HEIGHT = 0.16, 0.20, 0.09, 0.02
PLATE = 0.0156  # calibrated: bends first at 182 Hz, clamped
BRACKET_FRONT, BRACKET_TOP = 0.24, 0.05  # back face of the plate, along x; top of the flange
GRIP = 0.05  # of the plate's lower end, where the tool is held


def gantry_mesh(longest: float = LONGEST["gantry"]):
    """Foot plates, hollow legs, ribbed crossbeam, rails and the magnets' strip."""
    half = [0.0, HALF_STRIP, PINION, *RAIL, HALF_DEPTH - WEB, HALF_DEPTH, LEG - LEG_WALL, LEG, FOOT]
    x = [sign * one for one in half for sign in (-1.0, 1.0)]
    half = [MIDDLE_OF_FOOT, INNER, INNER + LEG_WALL, END - LEG_WALL, END, LONGEST_TRAVEL]
    y = [sign * one for one in half for sign in (-1.0, 1.0)]
    y += [rib + sign * 0.5 * RIB for rib in RIBS for sign in (-1.0, 1.0)]
    y += [one + sign * PATCH for one in STATIONS for sign in (-1.0, 1.0)]
    z = [0.0, FOOT_HEIGHT, UNDERSIDE - LEG_WALL, UNDERSIDE, UNDERSIDE + FLANGE, TOP - FLANGE, TOP]
    z += [TOP + STRIP_HEIGHT, TOP + RAIL_HEIGHT]

    def filled(x: NDArray, y: NDArray, z: NDArray) -> NDArray[np.bool_]:
        across, along = abs(x), abs(y)
        at_leg = along > INNER
        foot = (z < FOOT_HEIGHT) & at_leg
        section = across < HALF_DEPTH
        end_wall = (along < INNER + LEG_WALL) | (along > END - LEG_WALL)
        side = (across > HALF_DEPTH - WEB) & (across < HALF_DEPTH)
        closed = (across > LEG - LEG_WALL) | (z > UNDERSIDE - LEG_WALL)
        leg = at_leg & (across < LEG) & (z > FOOT_HEIGHT) & (z < UNDERSIDE)
        leg &= end_wall | side | closed
        skin = side | (z < UNDERSIDE + FLANGE) | (z > TOP - FLANGE)
        rib = np.min(abs(y[:, None] - np.array(RIBS)), axis=1) < 0.5 * RIB
        rib |= at_leg & end_wall
        crossbeam = section & (z > UNDERSIDE) & (z < TOP) & (skin | rib)
        return foot | leg | crossbeam | on_top(x, y, z)

    return boxes((x, y, z), filled, longest)


def on_top(x: NDArray, y: NDArray, z: NDArray) -> NDArray[np.bool_]:
    """Tell what belongs to the rails or the magnets' strip."""
    across = abs(x)
    rail = (across > RAIL[0]) & (across < RAIL[1])
    strip = (across < HALF_STRIP) & (z < TOP + STRIP_HEIGHT)
    return (z > TOP) & (abs(y) < LONGEST_TRAVEL) & (rail | strip)


def is_steel(x: NDArray, y: NDArray, z: NDArray) -> NDArray[np.bool_]:
    """Tell the foot plates, the rails and the magnets' strip."""
    return (z < FOOT_HEIGHT) | on_top(x, y, z)


def gantry(longest: float = LONGEST["gantry"]) -> TiedPart:
    """Mesh the gantry and tie guide blocks, motors and places of the head."""
    coordinates, mass, stiffness = solid_matrices(
        gantry_mesh(longest), ALUMINIUM, (STEEL, is_steel)
    )
    x, y, z = coordinates.T
    rigid, interpolated = [], []
    for side, sign in (("left", -1.0), ("right", 1.0)):
        below = near(z, 0.0) & (sign * y > INNER - 1e-6)
        for end, way in (("rear", -1.0), ("front", 1.0)):
            block = below & (way * x > BLOCK[0] - 1e-6) & (way * x < BLOCK[1] + 1e-6)
            at = (way * 0.5 * sum(BLOCK), sign * MIDDLE_OF_FOOT, 0.0)
            rigid.append((f"{side}_{end}", at, block))
        seat = below & (abs(x) < PINION + 1e-6)
        interpolated.append((f"{side}_motor", (0.0, sign * MIDDLE_OF_FOOT, 0.0), seat))
    on_rails = near(z, TOP + RAIL_HEIGHT)
    for number, station in enumerate(STATIONS, start=1):
        patch = on_rails & (abs(y - station) < PATCH + 1e-6)
        interpolated.append((f"rail_{number}", (0.0, station, TOP + RAIL_HEIGHT), patch))
    return tied_part(coordinates, mass, stiffness, rigid, interpolated)


def bracket(plate: float = PLATE, longest: float = LONGEST["bracket"]) -> TiedPart:
    """Mesh the bracket and tie its flange and the tool."""
    front = BRACKET_FRONT
    back = front + plate - FLANGE_DEPTH
    lines_x = [back, front, front + plate]
    lines_y = [-0.5 * WIDTH, 0.0, 0.5 * WIDTH]
    low = BRACKET_TOP - PLATE_LENGTH
    lines_z = [low, low + GRIP, BRACKET_TOP - FLANGE_HEIGHT, BRACKET_TOP]
    mesh = boxes(
        (lines_x, lines_y, lines_z),
        lambda x, _, z: (x > front) | (z > BRACKET_TOP - FLANGE_HEIGHT),
        longest,
    )
    coordinates, mass, stiffness = solid_matrices(mesh, ALUMINIUM)
    x, _, z = coordinates.T
    root = ("root", (front + plate - 0.5 * FLANGE_DEPTH, 0.0, BRACKET_TOP), near(z, BRACKET_TOP))
    gripped = (z < low + GRIP + 1e-6) & (x > front - 1e-6)
    tool = ("grip", (front + 0.5 * plate, 0.0, low + 0.5 * GRIP), gripped)
    return tied_part(coordinates, mass, stiffness, [root], [tool])


def near(values: NDArray[np.float64], value: float) -> NDArray[np.bool_]:
    """Tell which are the same but for rounding."""
    return abs(values - value) < 1e-6


def reduced(part: TiedPart, highest: float) -> LinearStructure:
    """Craig-Bampton super-element of a part, all its points kept."""
    return super_element(part.structure, list(part.positions), highest)


def rigid_motions(element: LinearStructure, places: dict) -> NDArray[np.float64]:
    """(n, 6) motions of a super-element along and about x, y, z of the origin."""
    motions = np.zeros((element.size, 6))
    for name, place in places.items():
        motions += element.points[name].T @ rigid_motion(np.asarray(place))
    return motions


def total_mass(element: LinearStructure, places: dict) -> float:
    """kg."""
    lifted = rigid_motions(element, places)[:, 2]
    return float(lifted @ element.mass @ lifted)


def main() -> list[Path]:
    """Mesh, reduce and write both parts; print the free frequencies, full and reduced."""
    clock = time.perf_counter()
    written = []
    for name, part in (("gantry", gantry()), ("bracket", bracket())):
        element = reduced(part, HIGHEST[name])
        print(
            f"{time.perf_counter() - clock:6.1f} s  {name}: {part.structure.size} freedoms, "
            f"reduced to {element.size}, {total_mass(element, part.positions):.6g} kg"
        )
        for whole, few in zip(
            *(undamped_modes(one, count=12).frequency[6:] for one in (part.structure, element)),
            strict=True,
        ):
            print(f"          {whole:8.2f} Hz  {few:8.2f} Hz  {few / whole - 1.0:+.1e}")
        written += write_super_element(HERE / "super-element" / name, element, part.positions)
    return written


if __name__ == "__main__":
    main()
