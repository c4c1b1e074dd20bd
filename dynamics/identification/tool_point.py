"""From complex modes of a set of FRFs to real modes that the tool point has."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dynamics.identification.mode_quality import LEAST_PEAK_SHARE, largest_share, peak_share
from dynamics.identification.real_modes import (
    RealModel,
    ToolPointRecords,
    refine_real_modes,
    starting_vectors,
)
from dynamics.identification.refinement import ModalModel
from dynamics.identification.residues import ALL_TERMS

#: a mode of the wrong sign with more than this share of the peak tells that the FRF is none of a
#: drive point
MOST_WRONG_SHARE = 0.2

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


def fit_tool_point(tool: ToolPointRecords, model: ModalModel) -> ToolPointFit:
    """Fit real modes with positive mass to the FRFs of the tool point.

    The model has complex modes of the same FRFs.
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
    large = [hertz for share, hertz in wrong if share > MOST_WRONG_SHARE]
    if large or not np.any(right):
        listed = ", ".join(f"{hertz:.1f} Hz" for hertz in large)
        reason = f"not a drive point: the modes at {listed} have the opposite sign of the others"
        if not np.any(right):
            reason = "no mode with a positive mass was found"
        return ToolPointFit(None, tool, senses, reason, tuple(notes))
    for share, hertz in wrong:
        notes.append(
            f"a mode at {hertz:.1f} Hz ({100 * share:.1f} % of the peak) would have a negative "
            "mass and was left out"
        )
    real = refine_real_modes(
        tool,
        model.natural_frequency[right],
        model.damping[right],
        vectors[right],
        tuple(dict.fromkeys((*ALL_TERMS, *model.terms))),
        0.0,
    )
    real = _with_second_vectors(tool, real, model, right)
    real = _drop_weak(tool, real)
    real = _choose_terms(tool, real)
    if real.count == 0:
        return ToolPointFit(None, tool, senses, "no mode with a positive mass was found", ())
    return ToolPointFit(real, tool, senses, "", tuple(notes))


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
    return largest_share(tool.records, one.synthesis(tool))


def _drop_weak(tool: ToolPointRecords, real: RealModel) -> RealModel:
    """Leave out modes whose real part does not matter, weakest first."""
    while real.count:
        shares = [share_of_real_mode(tool, real, r) for r in range(real.count)]
        weakest = int(np.argmin(shares))
        keep = np.arange(real.count) != weakest
        lesser = refine_real_modes(
            tool,
            real.natural_frequency[keep],
            real.damping[keep],
            real.vectors[keep],
            real.terms,
            real.delay,
        )
        gain = (lesser.chi_square - real.chi_square) / _misfit(tool, real)
        if gain > _price(tool) and shares[weakest] > LEAST_PEAK_SHARE:
            return real
        real = lesser
    return real


def _choose_terms(tool: ToolPointRecords, real: RealModel) -> RealModel:
    """Leave out delay and residual terms that the data do not support (Schwarz 1978)."""
    unknown = float(np.log(2.0 * tool.records.values.size))
    lesser = _again(tool, real, real.terms, None)
    if (lesser.chi_square - real.chi_square) / _misfit(tool, real) < unknown:
        real = lesser
    for power in real.terms:
        terms = tuple(p for p in real.terms if p != power)
        lesser = _again(tool, real, terms, real.delay)
        price = tool.records.count * unknown
        if (lesser.chi_square - real.chi_square) / _misfit(tool, real) < price:
            real = lesser
    return real


def _again(
    tool: ToolPointRecords, real: RealModel, terms: tuple[int, ...], delay: float | None
) -> RealModel:
    return refine_real_modes(tool, real.natural_frequency, real.damping, real.vectors, terms, delay)
