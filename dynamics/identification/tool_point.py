"""From complex modes of a set of FRFs to real modes that the tool point has."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dynamics.identification.condensed import condensed
from dynamics.identification.delay import without_delay
from dynamics.identification.discrepancy import effective_samples, with_discrepancy
from dynamics.identification.mode_quality import LEAST_PEAK_SHARE, TINY, largest_share, peak_share
from dynamics.identification.real_modes import (
    RealModel,
    ToolPointRecords,
    evaluate_real_modes,
    refine_real_modes,
    starting_vectors,
)
from dynamics.identification.refinement import ModalModel
from dynamics.identification.residues import ALL_TERMS, Records
from dynamics.identification.resonances import (
    by_their_crests,
    peak_receptances,
    shoulder,
    within_lines,
)
from dynamics.least_squares import PRECISE, ROUGH

#: a mode of the wrong sign with more than this share of the peak tells that the FRF is none of a
#: drive point
MOST_WRONG_SHARE = 0.2

#: peak receptance of a mode, over that of the largest, below which it is a small resonance where
#: the model misses more than the noise: alone it would limit a cut at five times the depth; and
#: how much more, in power
MATERIAL_SHARE, MORE_THAN_NOISE = 0.2, 2.0

#: misfit of a model over the peak of the FRF below which it is rounding and not mechanics
LEAST_MISFIT_SHARE = 2e-4

#: lines in the half-power band of the narrowest mode, and lines in all, by which modes are judged
LINES_IN_A_MODE, LEAST_JUDGED = 6, 400

#: deviation beside a mode of negative mass that was left out from which it is told
LARGEST_DEVIATION = 0.05

#: lines beside a mode, relative to its frequency
NEAR = 0.02

#: share of a second mode in the residue matrix of a pole from which it is tried as a mode
LEAST_SECOND_SHARE = 0.01


@dataclass(frozen=True)
class ToolPointFit:
    """Real modes of the tool point, or why there are none."""

    model: RealModel | None
    tool: ToolPointRecords  # with the sense of reversed sensors corrected
    senses: NDArray[np.float64]  # (k,), -1 for the FRFs whose sign was turned
    reason: str  # why `model` is None; empty otherwise
    notes: tuple[str, ...]
    delay: float = 0.0  # of the response channels, taken off the records of `tool`, s


def fit_tool_point(tool: ToolPointRecords, model: ModalModel, fewest: int = 0) -> ToolPointFit:
    """Fit real modes with positive mass to the FRFs of the tool point.

    The model has complex modes of the same FRFs; `fewest` modes are kept although the data may
    not bear them.
    """
    tool, model, senses, notes = _with_senses(tool, model)
    vectors, eigenvalues = starting_vectors(tool, model)
    right = eigenvalues[:, 0] > np.maximum(-eigenvalues[:, -1], 0.0)
    wrong = [
        (peak_share(tool.records, model, r), model.natural_frequency[r] / (2.0 * np.pi))
        for r in np.flatnonzero(~right)
    ]
    lowest, highest = tool.records.frequency[0], tool.records.frequency[-1]
    wrong = [(share, hertz) for share, hertz in wrong if lowest <= hertz <= highest]
    if not np.any(right):
        reason = "no mode with a positive mass was found"
        return ToolPointFit(None, tool, senses, reason, tuple(notes))
    fewer = _condensed(tool)
    real = refine_real_modes(
        fewer,
        model.natural_frequency[right],
        model.damping[right],
        vectors[right],
        tuple(dict.fromkeys((*ALL_TERMS, *model.terms))),
        0.0,
    )
    large = [
        hertz
        for share, hertz in wrong
        if share > MOST_WRONG_SHARE and _deviation_near(tool, real, hertz) > MOST_WRONG_SHARE
    ]
    if large:
        listed = ", ".join(f"{hertz:.1f} Hz" for hertz in large)
        reason = f"not a drive point: the modes at {listed} have the opposite sign of the others"
        return ToolPointFit(None, tool, senses, reason, tuple(notes))
    real = _with_second_vectors(fewer, real, model, right)
    delay = 0.0
    if _misses_more_than_noise(tool, real):
        # with the small resonances gone the delay would stand for what they do to the phase
        delay = _supported_delay(tool, real)
        tool = replace(tool, records=without_delay(tool.records, delay))
        real = _again(_condensed(tool), real, real.terms, None)
    tool, real = _drop_weak(tool, real, fewest)
    if real.count == 0:
        return ToolPointFit(None, tool, senses, "no mode with a positive mass was found", ())
    for share, hertz in wrong:
        if share > LEAST_PEAK_SHARE and _deviation_near(tool, real, hertz) > LARGEST_DEVIATION:
            notes.append(
                f"a mode at {hertz:.1f} Hz ({100 * share:.1f} % of the peak) would have a "
                "negative mass and was left out"
            )
    return ToolPointFit(real, tool, senses, "", tuple(notes), delay)


def _deviation_near(tool: ToolPointRecords, real: RealModel, hertz: float) -> float:
    """Largest deviation of a fit near a frequency over the largest value there."""
    near = np.abs(tool.records.frequency - hertz) <= NEAR * hertz
    near[np.argmin(np.abs(tool.records.frequency - hertz))] = True
    values = tool.records.values[near]
    error = np.abs(values - real.synthesis(tool)[near])
    return float(np.max(np.max(error, axis=0) / np.maximum(np.max(np.abs(values), axis=0), TINY)))


def _with_senses(
    tool: ToolPointRecords, model: ModalModel
) -> tuple[ToolPointRecords, ModalModel, NDArray[np.float64], list[str]]:
    """Turn the sign of responses along axes whose drive point has mostly negative residues."""
    senses = np.ones(len(tool.pairs))
    notes = []
    hertz = model.natural_frequency / (2.0 * np.pi)
    inside = (hertz >= tool.records.frequency[0]) & (hertz <= tool.records.frequency[-1])
    residues = model.coefficients[: model.count][inside] / model.damping[inside, None]
    weight = np.sum(np.abs(residues), axis=0)
    balance = np.sum(residues, axis=0) / np.where(weight > 0.0, weight, 1.0)
    for axis, name in enumerate(tool.axes):
        drives = [k for k, pair in enumerate(tool.pairs) if pair == (axis, axis)]
        if drives and np.mean(balance[drives]) < -0.5:
            for k, pair in enumerate(tool.pairs):
                if pair is not None and pair[0] == axis:
                    senses[k] = -1.0
            where = f" in {name}" if name else ""
            notes.append(f"the drive point{where} was measured with a sensor turned round")
    records = replace(tool.records, values=tool.records.values * senses)
    model = replace(model, coefficients=model.coefficients * senses)
    return replace(tool, records=records), model, senses, notes


def _price(tool: ToolPointRecords) -> float:
    """Fall of the chi-square that a mode without substance may bring (Schwarz 1978)."""
    free = sum(pair is None for pair in tool.pairs)
    unknowns = 2 + len(tool.axes) + free
    return unknowns * float(np.log(2.0 * tool.records.values.size))


def _misfit(tool: ToolPointRecords, model: RealModel) -> float:
    return max(model.chi_square / (2.0 * tool.records.values.size), 0.25)


def _with_second_vectors(
    tool: ToolPointRecords, real: RealModel, model: ModalModel, right: NDArray[np.bool_]
) -> RealModel:
    """Try a second mode where the residue matrix of one pole has rank two."""
    if len(tool.axes) < 2:
        return real
    axes = len(tool.axes)
    total = np.zeros((model.count, axes, axes))
    for k, pair in enumerate(tool.pairs):
        if pair is not None:
            total[:, pair[0], pair[1]] = model.coefficients[: model.count, k]
            total[:, pair[1], pair[0]] = model.coefficients[: model.count, k]
    for r in np.flatnonzero(right):
        values, vectors = np.linalg.eigh(total[r])
        if values[-2] < LEAST_SECOND_SHARE * values[-1]:
            continue
        grown = refine_real_modes(
            tool,
            np.append(real.natural_frequency, model.natural_frequency[r]),
            np.append(real.damping, model.damping[r]),
            np.vstack([real.vectors, vectors[:, -2] * np.sqrt(values[-2])]),
            real.terms,
            real.delay,
        )
        if (real.chi_square - grown.chi_square) / _misfit(tool, grown) > _price(tool):
            real = grown
    return real


def share_of_real_mode(tool: ToolPointRecords, real: RealModel, mode: int) -> float:
    """Largest contribution of a mode relative to the peak of an FRF, all FRFs of the set."""
    return largest_share(tool.records, _contribution(tool, real, mode))


def _contribution(tool: ToolPointRecords, real: RealModel, mode: int) -> NDArray[np.complex128]:
    """What one mode adds to each FRF, (n, k)."""
    one = replace(
        real,
        natural_frequency=real.natural_frequency[mode : mode + 1],
        damping=real.damping[mode : mode + 1],
        vectors=real.vectors[mode : mode + 1],
        terms=(),
        free=tuple(
            f[mode : mode + 1] if pair is None else np.zeros(0)
            for f, pair in zip(real.free, tool.pairs, strict=True)
        ),
    )
    return one.synthesis(tool)


def _drop_weak(
    tool: ToolPointRecords, real: RealModel, fewest: int
) -> tuple[ToolPointRecords, RealModel]:
    """Leave out modes that the data do not bear beyond noise and discrepancy, weakest first.

    A small resonance of a joint or of the machine is then part of the residual; the noise of the
    records that are returned includes what the model misses.
    """
    lines = replace(tool, records=_judged_lines(tool.records, real))
    kept = real
    judged = _with_discrepancy(lines, kept)
    fitted = _condensed(judged)
    kept = _again(fitted, kept, kept.terms, kept.delay, ROUGH)
    while kept.count > fewest:
        lesser = _without(fitted, kept, _weakest(fitted, kept))
        if _worth_a_mode(judged, kept, lesser):
            break
        kept = lesser
        judged = _with_discrepancy(lines, kept)
        fitted = _condensed(judged)
    while kept.count > max(fewest, 1):
        immaterial = _immaterial(judged, lines, kept)
        if immaterial is None:
            break
        kept = _without(fitted, kept, immaterial)
    if kept.count == 0:
        return tool, kept
    if kept.count == real.count:
        kept = real
    judged = _with_discrepancy(tool, kept)
    if _much_above(judged, tool):
        judged = replace(judged, records=by_their_crests(judged, kept))
    return judged, _with_chosen_terms(judged, kept)


def _misses_more_than_noise(tool: ToolPointRecords, real: RealModel) -> bool:
    return _much_above(_with_discrepancy(tool, real), tool)


def _with_discrepancy(tool: ToolPointRecords, real: RealModel) -> ToolPointRecords:
    """Lines whose noise includes what a model misses."""
    return replace(tool, records=with_discrepancy(tool.records, real.synthesis(tool)))


def _much_above(judged: ToolPointRecords, tool: ToolPointRecords) -> bool:
    """True where the noise of the first, with what its model misses, is well above the second's."""
    noise = judged.records.noise
    power, least = np.median(noise**2), np.median(tool.records.noise**2)
    share = float(np.median(noise / np.max(np.abs(tool.records.values), axis=0)))
    return bool(power > MORE_THAN_NOISE * least and share > LEAST_MISFIT_SHARE)


def _supported_delay(tool: ToolPointRecords, real: RealModel) -> float:
    """Delay of a model of all modes, s; 0 where the data do not ask for one (Schwarz 1978).

    Both fits are under the same noise, that of the records with what the model misses.
    """
    judged = _with_discrepancy(tool, real)
    with_delay = _again(judged, real, real.terms, real.delay, ROUGH)
    without = _again(judged, real, real.terms, None, ROUGH)
    return float(with_delay.delay or 0.0) if _worth(judged, with_delay, without, 1) else 0.0


def _immaterial(judged: ToolPointRecords, tool: ToolPointRecords, real: RealModel) -> int | None:
    """The least of the modes that are too small to be written down, None where none is.

    On lines that a few real modes describe to the noise, every mode is one. Where more than the
    noise is missed, what moves the tool little beside its largest mode, or makes no resonance of
    its own, is a small resonance of everything else: no model of real modes is right at that level.
    """
    shares = np.array([share_of_real_mode(judged, real, r) for r in range(real.count)])
    if np.min(shares) <= LEAST_PEAK_SHARE:
        return int(np.argmin(shares))
    if not _much_above(judged, tool):
        return None
    # what lies outside the lines stands for more than one mode, and its peak is not seen
    inside = np.flatnonzero(within_lines(judged, real))
    peaks = peak_receptances(real)[inside]
    if peaks.size and np.min(peaks) < MATERIAL_SHARE * np.max(peaks):
        return int(inside[np.argmin(peaks)])
    return shoulder(judged, real)


def _judged_lines(records: Records, real: RealModel) -> Records:
    """Lines enough to follow the narrowest mode: errors between them are alike."""
    spacing = float(np.median(np.diff(records.frequency)))
    narrowest = float(np.min(real.damping * real.natural_frequency)) / np.pi
    stride = max(1, int(narrowest / (LINES_IN_A_MODE * spacing)))
    stride = min(stride, max(1, records.frequency.size // LEAST_JUDGED))
    return records.lines(np.arange(records.frequency.size) % stride == 0)


def _weakest(tool: ToolPointRecords, real: RealModel) -> int:
    """The mode whose absence, poles of the others kept, costs least."""
    loss = []
    for r in range(real.count):
        keep = np.arange(real.count) != r
        lesser = evaluate_real_modes(
            tool,
            real.natural_frequency[keep],
            real.damping[keep],
            real.vectors[keep],
            real.terms,
            real.delay,
        )
        # what the other modes could take over, to first order
        step = np.linalg.lstsq(lesser.normal, lesser.gradient, rcond=1e-12)[0]
        loss.append(lesser.chi_square - float(lesser.gradient @ step))
    return int(np.argmin(loss))


def _without(tool: ToolPointRecords, real: RealModel, mode: int) -> RealModel:
    keep = np.arange(real.count) != mode
    return refine_real_modes(
        tool,
        real.natural_frequency[keep],
        real.damping[keep],
        real.vectors[keep],
        real.terms,
        real.delay,
        ROUGH,
    )


def _worth_a_mode(tool: ToolPointRecords, larger: RealModel, lesser: RealModel) -> bool:
    unknowns = 2 + len(tool.axes) + sum(pair is None for pair in tool.pairs)
    return _worth(tool, larger, lesser, unknowns)


def _worth(tool: ToolPointRecords, larger: RealModel, lesser: RealModel, unknowns: int) -> bool:
    """True where unknowns pay for themselves (Schwarz 1978), errors taken as correlated."""
    error = (tool.records.values - larger.synthesis(tool)) / tool.records.noise
    samples = effective_samples(error)
    share = samples / (2.0 * error.size)
    gain = share * (lesser.chi_square - larger.chi_square) / _misfit(tool, larger)
    return bool(gain > unknowns * np.log(max(samples, np.e)))


def _with_chosen_terms(tool: ToolPointRecords, real: RealModel) -> RealModel:
    """Refine without the delay and residual terms that the data do not support (Schwarz 1978)."""
    fewer = _condensed(tool)
    real = _again(fewer, real, real.terms, real.delay)
    unknown = float(np.log(2.0 * tool.records.values.size))
    lesser = _again(fewer, real, real.terms, None)
    if (lesser.chi_square - real.chi_square) / _misfit(tool, real) < unknown:
        real = lesser
    for power in real.terms:
        terms = tuple(p for p in real.terms if p != power)
        lesser = _again(fewer, real, terms, real.delay)
        price = tool.records.count * unknown
        if (lesser.chi_square - real.chi_square) / _misfit(tool, real) < price:
            real = lesser
    return real if fewer is tool else _again(tool, real, real.terms, real.delay)


def _condensed(tool: ToolPointRecords) -> ToolPointRecords:
    records = condensed(tool.records)
    return tool if records is tool.records else replace(tool, records=records)


def _again(
    tool: ToolPointRecords,
    real: RealModel,
    terms: tuple[int, ...],
    delay: float | None,
    least_gain: float = PRECISE,
) -> RealModel:
    poles = real.natural_frequency, real.damping
    return refine_real_modes(tool, *poles, real.vectors, terms, delay, least_gain)
