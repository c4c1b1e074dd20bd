"""Measured FRFs sorted into sets with common poles, and brought to common lines."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from dynamics.frf.container import DERIVATIVE_ORDER, Frf, MeasurementError, Point, on_common_lines
from dynamics.identification.band import Band, usable_bands
from dynamics.identification.real_modes import ToolPointRecords
from dynamics.identification.residues import Records

#: fewest lines above 0 Hz with which an identification makes sense
LEAST_LINES = 16


@dataclass(frozen=True)
class FrfSet:
    """FRFs that share degrees of freedom, and so their poles."""

    members: tuple[int, ...]  # positions of the FRFs in the sequence given
    #: per member the response and reference axis at the tool point, see ToolPointRecords
    pairs: tuple[tuple[int, int] | None, ...]
    #: directions measured at the tool point; empty where there is no drive point
    axes: tuple[str, ...]
    reason: str  # why there is no drive point; empty where there is one


@dataclass(frozen=True)
class Measurement:
    """All FRFs on common lines, in one quantity, with sensor senses applied."""

    frfs: tuple[Frf, ...]  # as given, in one quantity, without lines at 0 Hz
    records: Records  # all lines of all FRFs, each multiplied by the senses of its two points
    senses: NDArray[np.float64]  # (k,), those senses, +1 or -1
    searched: Band  # lines in which modes are looked for
    clean: Band  # the part of them with little noise

    def of(self, members: Sequence[int], band: Band) -> Records:
        """Lines of a band of some FRFs."""
        f = self.records.frequency
        inside = (f >= band.lowest) & (f <= band.highest)
        chosen = list(members)
        return replace(
            self.records,
            frequency=f[inside],
            values=self.records.values[inside][:, chosen],
            noise=self.records.noise[inside][:, chosen],
        )


def prepare(frfs: Sequence[Frf], band: tuple[float, float] | None) -> Measurement:
    """Stack the FRFs, estimate their noise and find the usable band.

    The band is that chosen by the user, Hz. MeasurementError for no FRF at all, too few lines, an
    FRF of nothing but zeros, windows that differ or a band outside the data.
    """
    if not frfs:
        raise MeasurementError("no FRF given; at least one is needed")
    same = all(frf.quantity == frfs[0].quantity for frf in frfs)
    quantity = frfs[0].quantity if same else "accelerance"
    ready = []
    for frf in frfs:
        positive = frf.as_quantity(quantity).band(np.finfo(float).tiny, np.inf)
        name = frf.source or "FRF"
        if positive.frequency.size < LEAST_LINES:
            raise MeasurementError(
                f"{name}: {positive.frequency.size} lines above 0 Hz; a modal identification "
                f"needs at least {LEAST_LINES}"
            )
        if not np.any(positive.values):
            raise MeasurementError(f"{name}: the FRF is zero on every line")
        ready.append(positive)
    decays = {float(getattr(frf, "added_decay", 0.0)) for frf in frfs}
    if len(decays) > 1:
        raise MeasurementError(
            f"FRFs with different exponential windows cannot be fitted together: added decays "
            f"{sorted(decays)} rad/s"
        )
    senses = np.array([float(f.response.sign * f.reference.sign) for f in ready])
    frequency, values = on_common_lines(ready)
    if frequency.size < LEAST_LINES:
        raise MeasurementError(
            f"the FRFs share {frequency.size} lines; a modal identification needs at least "
            f"{LEAST_LINES}"
        )
    values = values * senses
    noise = np.stack([noise_level(frequency, column) for column in values.T], axis=1)
    records = Records(frequency, values, noise, DERIVATIVE_ORDER[quantity], decays.pop())
    if band is None:
        searched, clean = _chosen_bands(records, ready)
    else:
        searched = clean = _given_band(records, band)
    return Measurement(tuple(ready), records, senses, searched, clean)


def _given_band(records: Records, band: tuple[float, float]) -> Band:
    lowest, highest = float(band[0]), float(band[1])
    f = records.frequency
    inside = f[(f >= lowest) & (f <= highest)]
    if not (np.isfinite(lowest) and np.isfinite(highest)) or inside.size < LEAST_LINES:
        raise MeasurementError(
            f"band {lowest:g} to {highest:g} Hz holds {inside.size} lines of the data "
            f"({f[0]:g} to {f[-1]:g} Hz); at least {LEAST_LINES} are needed"
        )
    return Band(float(inside[0]), float(inside[-1]), "given")


def _chosen_bands(records: Records, frfs: Sequence[Frf]) -> tuple[Band, Band]:
    factor = (2.0 * np.pi * records.frequency[:, None]) ** -float(records.derivative)
    phase = (1j) ** -records.derivative
    columns = [
        np.interp(records.frequency, frf.frequency, frf.coherence)
        for frf in frfs
        if frf.coherence is not None
    ]
    coherence = np.stack(columns, axis=1) if len(columns) == len(frfs) else None
    return usable_bands(
        records.frequency,
        records.values * factor * phase,
        records.noise * factor,
        records.derivative,
        coherence,
    )


def sets_with_common_poles(frfs: Sequence[Frf], tool_point: str | None) -> list[FrfSet]:
    """Sort FRFs into sets linked by a common degree of freedom.

    Drive points in x and y without a cross term between them say nothing of each other: the two
    directions then have modes of their own.

    The tool point is the node of the first drive point where it is not given.
    """
    unknown = [i for i, frf in enumerate(frfs) if frf.response == frf.reference == Point()]
    if len(frfs) > 1 and unknown:
        reason = "several FRFs without point information: which is the drive point is not known"
        return [FrfSet(tuple(range(len(frfs))), (None,) * len(frfs), (), reason)]
    node = tool_point
    if node is None:
        drives = [frf.response.node for frf in frfs if frf.is_drive_point]
        node = drives[0] if drives else None
    found = []
    for members in _linked(frfs):
        at_tool = [frfs[i].response.node == frfs[i].reference.node == node for i in members]
        drive = any(
            frfs[i].is_drive_point and here for i, here in zip(members, at_tool, strict=True)
        )
        if not drive:
            where = f" at {node}" if node else ""
            reason = f"no drive point{where}: force and motion were not measured at one point"
            found.append(FrfSet(tuple(members), (None,) * len(members), (), reason))
            continue
        ends = {frfs[i].response.direction for i, h in zip(members, at_tool, strict=True) if h}
        ends |= {frfs[i].reference.direction for i, h in zip(members, at_tool, strict=True) if h}
        axes = tuple(sorted(ends))
        pairs = tuple(
            (axes.index(frfs[i].response.direction), axes.index(frfs[i].reference.direction))
            if here
            else None
            for i, here in zip(members, at_tool, strict=True)
        )
        found.append(FrfSet(tuple(members), pairs, axes, ""))
    return found


def _linked(frfs: Sequence[Frf]) -> list[list[int]]:
    """Connected components of the graph whose edges are the FRFs."""
    groups: list[tuple[set[tuple[str, str]], list[int]]] = []
    for i, frf in enumerate(frfs):
        ends = {(p.node, p.direction) for p in (frf.response, frf.reference)}
        members = [i]
        apart = []
        for group in groups:
            if group[0] & ends:
                ends |= group[0]
                members = group[1] + members
            else:
                apart.append(group)
        groups = [*apart, (ends, members)]
    return [sorted(members) for _, members in sorted(groups, key=lambda g: min(g[1]))]


def tool_point_records(records: Records, frf_set: FrfSet) -> ToolPointRecords:
    """Attach the axes of the tool point to the records of a set."""
    return ToolPointRecords(records, frf_set.axes, frf_set.pairs)


def response_reference_matrix(records: Records, frfs: Sequence[Frf]) -> NDArray[np.complex128]:
    """FRFs over their noise as a matrix of responses and references where they form one.

    (n, responses, references): no more references than responses (a structure is reciprocal); one
    reference where the FRFs, in the order of the columns, do not fill a matrix. Every column is
    divided by its median noise level.
    """
    scaled = records.values / np.median(records.noise, axis=0)
    responses = list(dict.fromkeys((f.response.node, f.response.direction) for f in frfs))
    references = list(dict.fromkeys((f.reference.node, f.reference.direction) for f in frfs))
    if len(responses) * len(references) != len(frfs) or min(len(responses), len(references)) == 1:
        return scaled[:, :, None]
    matrix = np.zeros((scaled.shape[0], len(responses), len(references)), dtype=np.complex128)
    filled = set()
    for k, frf in enumerate(frfs):
        o = responses.index((frf.response.node, frf.response.direction))
        i = references.index((frf.reference.node, frf.reference.direction))
        matrix[:, o, i] = scaled[:, k]
        filled.add((o, i))
    if len(filled) != len(frfs):
        return scaled[:, :, None]
    return matrix if len(references) <= len(responses) else matrix.transpose(0, 2, 1)


#: lines on either side of the one whose noise is estimated
HALF_WINDOW = 5

#: lines on either side over which the estimates are averaged by their median
HALF_SMOOTHING = 20

#: smallest noise taken for real, relative to the largest value (rounding in a printed file)
RELATIVE_FLOOR = 1e-7


def noise_level(frequency: NDArray[np.float64], values: NDArray[np.complex128]) -> NDArray:
    """Standard deviation of the noise on each line of one FRF.

    Around every line a rational function of low order, a quadratic over a first-order
    polynomial in frequency, is fitted to the few lines beside it (the local rational method of
    McKelvey and Guerin 2012, in the linearised form); a resonance narrower than the window is
    followed by it, so that what is left over is noise. A running median removes the scatter of
    an estimate with few degrees of freedom.

    Lines (n,), Hz, ascending; values (n,) of any quantity. The standard deviation of the complex
    noise (root mean square of its magnitude), (n,), in their unit, is never zero.
    """
    peak = float(np.max(np.abs(values)))
    floor = peak * RELATIVE_FLOOR if peak > 0.0 else 1.0
    half = min(HALF_WINDOW, (values.size - 1) // 2)
    freedom = 2 * half + 1 - 4
    if freedom < 1:
        return np.full(values.size, max(floor, 0.01 * peak))
    variance = _local_rational_variance(frequency, values, half)
    # the median of a chi-square variable lies below its mean (Wilson-Hilferty)
    median_to_mean = (1.0 - 2.0 / (9.0 * 2.0 * freedom)) ** 3
    reach = min(HALF_SMOOTHING, variance.size // 2)
    smooth = (
        scipy.ndimage.median_filter(variance, size=2 * reach + 1, mode="nearest") / median_to_mean
    )
    smooth = np.concatenate([np.full(half, smooth[0]), smooth, np.full(half, smooth[-1])])
    return np.maximum(np.sqrt(smooth), floor)


def _local_rational_variance(
    frequency: NDArray[np.float64], values: NDArray[np.complex128], half: int
) -> NDArray[np.float64]:
    """Mean square residual of the local rational fits, for lines half .. n - 1 - half."""
    width = 2 * half + 1
    f = sliding_window_view(frequency, width)
    h = sliding_window_view(values, width)
    x = (f - f[:, half : half + 1]) / (0.5 * (f[:, -1:] - f[:, :1]))
    scale = np.max(np.abs(h), axis=1, keepdims=True)
    h = h / np.where(scale > 0.0, scale, 1.0)
    columns = np.stack([np.ones_like(h), x.astype(complex), (x**2).astype(complex), -h * x], axis=2)
    basis, triangle = np.linalg.qr(columns)
    projected = np.einsum("wki,wk->wi", basis.conj(), h)
    residual = h - np.einsum("wki,wi->wk", basis, projected)
    # equation error -> output error: divide by the denominator that was fitted
    pivot = triangle[:, 3, 3]
    safe = np.abs(pivot) > 1e-10
    slope = np.where(safe, projected[:, 3] / np.where(safe, pivot, 1.0), 0.0)
    denominator = np.abs(1.0 + slope[:, None] * x)
    residual = residual / np.maximum(denominator, 0.05)
    mean_square = np.sum(np.abs(residual) ** 2, axis=1) / (width - 4)
    return mean_square * scale[:, 0] ** 2
