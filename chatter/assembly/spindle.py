"""What holds the holder: dynamic stiffness at the end of the spindle, modelled or measured."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from chatter.assembly.assembly_file import SpindleSection
from chatter.assembly.library import HolderEntry, SpindleEntry
from chatter.assembly.line import holder_segments, round_segments
from chatter.description.errors import InputError
from chatter.io.formats.format_list import read_frfs
from dynamics.beam.element import Segment
from dynamics.frf.container import Frf, MeasurementError, on_common_lines
from dynamics.receptance.coupling import Component, coupled, without_tool
from dynamics.receptance.timoshenko import (
    at_two_points,
    near_end_on,
    rotations_from_translations,
    timoshenko_beam,
)
from dynamics.structure.linear_structure import StructureError


def modelled_spindle(
    spindle: SpindleEntry, frequency: NDArray[np.float64], loss_factor: float
) -> NDArray[np.complex128]:
    """Dynamic stiffness (m, 2, 2) at the nose of a shaft on bearings, N/m and kin."""
    omega = 2.0 * np.pi * frequency
    stiffness = np.zeros((frequency.size, 2, 2), dtype=np.complex128)
    for length, bearings in reversed(_between_bearings(spindle)):
        for bearing in bearings:  # at the rear end of the piece
            stiffness[:, 0, 0] += bearing.stiffness + 1j * omega * bearing.damping
            stiffness[:, 1, 1] += bearing.tilt_stiffness
        near = near_end_on(timoshenko_beam(frequency, length, loss_factor), stiffness)
        stiffness = np.linalg.inv(near)
    return stiffness


def _between_bearings(spindle: SpindleEntry) -> list[tuple[Segment, list]]:
    """Pieces of the shaft, nose first, each with the bearings at its rear end."""
    found, start = [], 0.0
    for segment in round_segments(spindle.sections):
        end = start + segment.length
        stations = sorted({b.station for b in spindle.bearings if start < b.station < end})
        for left, right in zip([start, *stations], [*stations, end], strict=True):
            piece = Segment(
                right - left, segment.outer_diameter, segment.material, segment.inner_diameter
            )
            at_end = [b for b in spindle.bearings if abs(b.station - right) < 1e-9]
            found.append((piece, at_end))
        start = end
    for bearing in spindle.bearings:
        if not 0.0 < bearing.station <= start:
            raise InputError(
                f"bearing at {bearing.station:g} m is off the shaft, which is {start:g} m long"
            )
    return found


def measured_spindle(
    section: SpindleSection, standard: HolderEntry | None, loss_factor: float
) -> tuple[NDArray[np.float64], NDArray[np.complex128]]:
    """Frequencies (m,) and dynamic stiffness (m, 2, 2) of a measured spindle.

    A standard holder is taken off by inverse coupling from the deflections at two of its points;
    without one the slope is a difference of them. InputError where the files cannot be used or
    say too little.
    """
    paths = (section.frf, section.cross_frf, section.behind_frf)
    frfs = [_one(path) for path in paths if path is not None]
    distance = float(section.cross_distance or 0.0)
    try:
        frequency, columns = on_common_lines([frf.receptance() for frf in frfs])
        keep = (frequency > 0.0) & (np.abs(columns[:, 0]) > 0.0)
        frequency, columns = frequency[keep], columns[keep]
        direct, cross = columns[:, 0], columns[:, 1]
        behind = columns[:, 2] if section.behind_frf is not None else None
        if standard is None:
            found = rotations_from_translations(direct, cross, distance, behind)
        else:
            # one ruling mode where the point behind was not measured
            last = cross**2 / direct if behind is None else behind
            both = np.stack([direct, cross, cross, last], axis=-1).reshape(-1, 2, 2)
            found = without_tool(both, _two_points(standard, frequency, distance, loss_factor))
        return frequency, np.linalg.inv(found)
    except (MeasurementError, StructureError, np.linalg.LinAlgError) as error:
        raise InputError(f"spindle.frf: {error}") from error


def _two_points(
    holder: HolderEntry, frequency: NDArray[np.float64], distance: float, loss_factor: float
) -> Component:
    """Free component of an empty holder, seen at its face and at a distance behind it."""
    parts: list[Component | None] = [None, None]
    start = 0.0
    for segment in holder_segments(holder, None, 0.0):
        end = start + segment.length
        middle = min(max(distance, start), end)
        for side, length in ((0, middle - start), (1, end - middle)):
            if length > 1e-9:
                piece = timoshenko_beam(frequency, replace(segment, length=length), loss_factor)
                part = parts[side]
                parts[side] = piece if part is None else coupled(part, piece)
        start = end
    first, second = parts
    if first is None or second is None:
        raise InputError(
            f"spindle.cross_distance = {1e3 * distance:.4g} mm; the standard holder is "
            f"{1e3 * start:.4g} mm long"
        )
    return at_two_points(first, second)


def _one(path: Path) -> Frf:
    try:
        frfs = read_frfs(path)
    except MeasurementError as error:
        raise InputError(str(error)) from error
    if len(frfs) != 1:
        raise InputError(f"{path}: holds {len(frfs)} FRFs; one with a single FRF is required")
    return frfs[0]
