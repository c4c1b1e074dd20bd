"""Column and saddle of the Mandelli M5 from drawings to super-elements, by solid elements.

The paper meshes crossbeam (column) and head by finite elements with multi point constraints at
sliders and nuts, and prints no dimension: every one here is assumed. The results are shipped.

    python mandelli_parts.py        (needs scikit-fem, `pip install "chatter[solid]"`)
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
from dynamics.structure.solid_elements import Material, boxes, solid_matrices

HERE = Path(__file__).parent
CAST_IRON = Material(130e9, 0.26, 7200.0)
#: side of an element, m, at the most, and fixed-interface modes kept, up to, Hz
LONGEST = {"column": 0.16, "saddle": 0.12}
HIGHEST = {"column": 1500.0, "saddle": 2500.0}

# --- column, m: x across, y up, z along the spindle; y = 0 are the Z guides -----------------------
FOOT = (0.45, 0.24, 0.50)  # half width, height, half length
UPRIGHT = (0.25, 0.45, 0.15)  # inner and outer face along x, half depth along z
BRIDGE, TOP = 1.37, 1.53  # underside and top of the bridge
FOOT_WALL, WALL = 0.012, 0.012
HALF_WEB = 0.006  # behind the rails, and across the foot under its nut
RAIL_AT, RAIL_HALF, RAIL_HEIGHT = 0.35, 0.02, 0.02  # on the front of an upright
RAIL_ENDS = (0.31, 1.39)
STATIONS = (0.35, 0.55, 0.75, 0.95, 1.15, 1.35)
PATCH = 0.04  # half length along a rail that a point follows
BLOCK_X, BLOCK_Z = (0.35, 0.45), (0.40, 0.50)  # of a Z slider under the foot
NUT = 0.10  # half side of the seat of the nut of Z

# --- saddle, m: a hollow box before the rails -----------------------------------------------------
SADDLE = ((-0.38, 0.38), (0.57, 1.13), (-0.43, -0.17))
SADDLE_WALL = 0.035
SEAT, NUT_OF_Y = 0.125, 0.06  # half sides around the spindle's housing and of the nut's seat
SLIDER_AT, SLIDERS, SLIDER = 0.35, (0.65, 1.05), (0.03, 0.05)  # x, y, half sides
CENTRE = 0.85  # height of the spindle


def column(longest: float = LONGEST["column"]) -> TiedPart:
    """Mesh hollow foot and uprights, and the bridge, solid between them; tie what is joined."""
    half_width, height, half_length = FOOT
    inner, outer, half_depth = UPRIGHT
    half = [inner, inner + WALL, outer - WALL, outer, half_width - FOOT_WALL, half_width, NUT]
    half += [BLOCK_X[0], RAIL_AT - RAIL_HALF, RAIL_AT + RAIL_HALF, HALF_WEB]
    half += [RAIL_AT - HALF_WEB, RAIL_AT + HALF_WEB]
    x = [sign * one for one in half for sign in (-1.0, 1.0)]
    y = [0.0, FOOT_WALL, height - FOOT_WALL, height, BRIDGE, BRIDGE + WALL, TOP - WALL, TOP]
    y += [*RAIL_ENDS, *(one + sign * PATCH for one in STATIONS for sign in (-1.0, 1.0))]
    half = [half_length, half_length - FOOT_WALL, half_depth, half_depth - WALL, BLOCK_Z[0], NUT]
    half.append(HALF_WEB)
    z = [sign * one for one in half for sign in (-1.0, 1.0)] + [-half_depth - RAIL_HEIGHT]

    def filled(x: NDArray, y: NDArray, z: NDArray) -> NDArray[np.bool_]:
        across, along = abs(x), abs(z)
        foot = y < height
        foot_skin = (y < FOOT_WALL) | (y > height - FOOT_WALL) | (across > half_width - FOOT_WALL)
        foot_skin |= along > half_length - FOOT_WALL
        foot_skin |= (across < HALF_WEB) | (along < HALF_WEB)
        upright = (across > inner) & (across < outer) & (along < half_depth)
        upright_wall = (across < inner + WALL) | (across > outer - WALL)
        upright_wall |= (along > half_depth - WALL) | (abs(across - RAIL_AT) < HALF_WEB)
        # walls of the uprights go on through foot and bridge
        foot &= foot_skin | (upright & upright_wall)
        bridge = (y > BRIDGE) & (across < outer) & (along < half_depth)
        bridge &= (
            (y < BRIDGE + WALL) | (y > TOP - WALL) | upright_wall | (along > half_depth - WALL)
        )
        upright &= (y > height) & (y < BRIDGE) & upright_wall
        rail = (
            (abs(across - RAIL_AT) < RAIL_HALF)
            & (z < -half_depth)
            & (z > -half_depth - RAIL_HEIGHT)
        )
        rail &= (y > RAIL_ENDS[0]) & (y < RAIL_ENDS[1])
        return (foot & (along < half_length) & (across < half_width)) | bridge | upright | rail

    coordinates, mass, stiffness = solid_matrices(boxes((x, y, z), filled, longest), CAST_IRON)
    x, y, z = coordinates.T
    rigid, interpolated = [], []
    for side, sign in (("left", -1.0), ("right", 1.0)):
        for end, way in (("front", -1.0), ("rear", 1.0)):
            block = near(y, 0.0) & within(sign * x, *BLOCK_X) & within(way * z, *BLOCK_Z)
            at = (sign * np.mean(BLOCK_X), 0.0, way * np.mean(BLOCK_Z))
            rigid.append((f"foot_{side}_{end}", at, block))
        on_rail = near(z, -half_depth - RAIL_HEIGHT) & (sign * x > 0.0)
        for number, station in enumerate(STATIONS, start=1):
            patch = on_rail & within(y, station - PATCH, station + PATCH)
            at = (sign * RAIL_AT, station, -half_depth - RAIL_HEIGHT)
            interpolated.append((f"{side}_{number}", at, patch))
    seat = near(y, 0.0) & within(x, -NUT, NUT) & within(z, -NUT, NUT)
    interpolated.append(("nut", (0.0, 0.06, 0.0), seat))
    interpolated.append(("top", (0.0, TOP, 0.0), near(y, TOP) & within(x, -inner, inner)))
    front = near(y, height) & within(z, -half_length, -BLOCK_Z[0]) & within(x, -NUT, NUT)
    interpolated.append(("front", (0.0, height, -half_length), front))
    return tied_part(coordinates, mass, stiffness, rigid, interpolated)


def saddle(longest: float = LONGEST["saddle"]) -> TiedPart:
    """Mesh the hollow saddle, and tie sliders, nut and the seats of the spindle's housing."""
    sides, wall = SADDLE, SADDLE_WALL
    x = [*sides[0], sides[0][0] + wall, sides[0][1] - wall, -SEAT, -NUT_OF_Y, 0.0, NUT_OF_Y, SEAT]
    x += [sign * SLIDER_AT + way * SLIDER[0] for sign in (-1, 1) for way in (-1, 1)]
    y = [*sides[1], sides[1][0] + wall, sides[1][1] - wall]
    y += [CENTRE + sign * one for one in (SEAT, NUT_OF_Y) for sign in (-1, 1)]
    y += [one + way * SLIDER[1] for one in SLIDERS for way in (-1, 1)]
    z = [*sides[2], sides[2][0] + wall, sides[2][1] - wall, -0.26, -0.34]

    def filled(x: NDArray, y: NDArray, z: NDArray) -> NDArray[np.bool_]:
        hollow = within(x, sides[0][0] + wall, sides[0][1] - wall)
        hollow &= within(y, sides[1][0] + wall, sides[1][1] - wall)
        return ~(hollow & within(z, sides[2][0] + wall, sides[2][1] - wall))

    coordinates, mass, stiffness = solid_matrices(boxes((x, y, z), filled, longest), CAST_IRON)
    x, y, z = coordinates.T
    rear, front = near(z, sides[2][1]), near(z, sides[2][0])
    rigid, interpolated = [], []
    for side, sign in (("left", -1.0), ("right", 1.0)):
        for end, height in zip(("low", "high"), SLIDERS, strict=True):
            block = rear & within(sign * x, SLIDER_AT - SLIDER[0], SLIDER_AT + SLIDER[0])
            block &= within(y, height - SLIDER[1], height + SLIDER[1])
            rigid.append((f"{side}_{end}", (sign * SLIDER_AT, height, sides[2][1]), block))
    on_seat = within(x, -SEAT, SEAT) & within(y, CENTRE - SEAT, CENTRE + SEAT)
    on_nut = within(x, -NUT_OF_Y, NUT_OF_Y) & within(y, CENTRE - NUT_OF_Y, CENTRE + NUT_OF_Y)
    interpolated.append(("nut", (0.0, CENTRE, -0.14), rear & on_nut))
    interpolated.append(("seat_rear", (0.0, CENTRE, -0.20), rear & on_seat & ~on_nut))
    interpolated.append(("seat_front", (0.0, CENTRE, -0.42), front & on_seat))
    top = near(abs(y - CENTRE), sides[1][1] - CENTRE) & within(x, -SEAT, SEAT)
    interpolated.append(("middle", (0.0, CENTRE, -0.30), top & within(z, -0.34, -0.26)))
    return tied_part(coordinates, mass, stiffness, rigid, interpolated)


def near(values: NDArray[np.float64], value: float) -> NDArray[np.bool_]:
    """Tell which are the same but for rounding."""
    return abs(values - value) < 1e-6


def within(values: NDArray[np.float64], low: float, high: float) -> NDArray[np.bool_]:
    """Tell which lie between two, these among them."""
    return (values > low - 1e-6) & (values < high + 1e-6)


def total_mass(element: LinearStructure, places: dict) -> float:
    """kg, of a super-element."""
    lifted = np.zeros(element.size)
    for name, place in places.items():
        lifted += element.points[name].T @ rigid_motion(np.asarray(place))[:, 1]
    return float(lifted @ element.mass @ lifted)


def main() -> list[Path]:
    """Mesh, reduce and write both parts; print the free frequencies, full and reduced."""
    written = []
    for name, part in (("column", column()), ("saddle", saddle())):
        begun = time.perf_counter()
        element = super_element(part.structure, list(part.positions), HIGHEST[name])
        print(
            f"{name}: {part.structure.size} freedoms to {element.size}, "
            f"{total_mass(element, part.positions):.6g} kg, {time.perf_counter() - begun:.0f} s"
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
