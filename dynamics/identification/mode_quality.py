"""What one mode of a model is worth: statistically, and against its neighbours."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dynamics.identification.condensed import SearchRecords
from dynamics.identification.refinement import TINY, ModalModel, fit_residues
from dynamics.identification.residues import Records

#: a mode that adds less than this, relative to the FRF where the mode is, only mends the shape
#: of another one
LEAST_LOCAL_SHARE = 0.04

#: a mode that adds less than this anywhere, relative to the peak of the FRF, is left out
LEAST_PEAK_SHARE = 0.002

#: half-power bandwidth that a mode has at least, in distances between lines
LEAST_BANDWIDTH = 0.02

#: distance of two modes, in mean half-power bandwidths, below which they are taken for one
LEAST_SEPARATION = 0.2

#: modal assurance criterion below which two modes differ in shape
MOST_LIKENESS = 0.8

#: share of the response from which one of two modes at one frequency is told by its shape
SHARE_OF_A_DOUBLE = 0.2

#: chi-square per degree of freedom taken at least: the noise may be estimated too high
LEAST_MISFIT = 0.25


@dataclass(frozen=True)
class ModeQuality:
    """What one mode is worth."""

    #: fall of the chi-square that the mode brings, over the chi-square per degree of freedom near
    #: it and over what a mode without substance would bring (Schwarz 1978): above 1 it is supported
    gain: float
    local_share: float  # largest contribution over the largest FRF value within its half-power band
    peak_share: float  # largest contribution over the peak of an FRF, see `largest_share`
    resolved: bool  # false where it cannot be told from a neighbour or a single line
    inside: bool  # false where it stands for modes beyond the lines: then only the gain counts

    @property
    def supported(self) -> bool:
        """True where the mode is both statistically and physically of weight."""
        if not self.inside:
            return self.gain > 1.0
        return (
            self.resolved
            and self.gain > 1.0
            and self.local_share > LEAST_LOCAL_SHARE
            and self.peak_share > LEAST_PEAK_SHARE
        )


def parameters_of_a_mode(records: Records) -> int:
    """Real unknowns that one more mode brings: pole and complex residues."""
    return 2 + 2 * records.count


def near_mode(records: Records, frequency: float, damping: float) -> NDArray[np.bool_]:
    """Lines within three half-power bandwidths of a mode, 25 at least."""
    f = records.frequency
    distance = np.abs(f - frequency)
    least = np.sort(distance)[min(24, f.size - 1)]
    return distance <= max(3.0 * damping * frequency, least)


def inside(records: Records, model: ModalModel) -> NDArray[np.bool_]:
    """True for the modes on the lines; the others stand for what is beyond their ends."""
    hertz = model.natural_frequency / (2.0 * np.pi)
    return (hertz >= records.frequency[0]) & (hertz <= records.frequency[-1])


def local_misfit(records: Records, model: ModalModel, mode: int) -> float:
    """Chi-square per real degree of freedom near a mode, for independent errors.

    Where the model falls short of the data the errors of neighbouring lines are alike, and many
    lines tell no more than a few: the chi-square is scaled up by the correlation time of the
    errors, (1 + r) / (1 - r) for a first-order process with correlation r between neighbours.
    """
    hertz = model.natural_frequency[mode] / (2.0 * np.pi)
    sub = records.lines(near_mode(records, hertz, model.damping[mode]))
    error = (sub.values - model.synthesis(sub)) / sub.noise
    power = np.sum(np.abs(error) ** 2)
    neighbours = np.sum(error[1:] * error[:-1].conj()).real
    correlation = np.clip(neighbours / max(power, 1e-300), 0.0, 0.9)
    return float(power / (2.0 * error.size) * (1.0 + correlation) / (1.0 - correlation))


def resolved(records: Records, model: ModalModel, mode: int, local_share: float) -> bool:
    """True where a mode is told from its neighbours by frequency or by shape.

    By frequency: at least a line and a part of its half-power band apart; by shape: residues over
    the FRFs that are not alike, where the mode carries a good part of the response.

    A pole whose half-power band is a small part of the distance between lines is a single line
    that stands out, no resonance.
    """
    hertz = model.natural_frequency / (2.0 * np.pi)
    spacing = float(np.median(np.diff(records.frequency)))
    if 2.0 * model.damping[mode] * hertz[mode] < LEAST_BANDWIDTH * spacing:
        return False
    others = np.arange(model.count) != mode
    if not np.any(others):
        return True
    bandwidth = (model.damping * hertz)[others] + model.damping[mode] * hertz[mode]
    apart = np.abs(hertz[others] - hertz[mode])
    told = apart > np.maximum(spacing, LEAST_SEPARATION * bandwidth)
    if local_share > SHARE_OF_A_DOUBLE:
        told |= _likeness(model, mode)[others] < MOST_LIKENESS
    return bool(np.all(told))


def _likeness(model: ModalModel, mode: int) -> NDArray[np.float64]:
    """Modal assurance criterion of the residues of one mode with those of all."""
    shapes = (
        model.coefficients[: model.count] + 1j * model.coefficients[model.count :][: model.count]
    )
    norm = np.maximum(np.linalg.norm(shapes, axis=1), TINY)
    shapes = shapes / norm[:, None]
    return np.abs(shapes.conj() @ shapes[mode]) ** 2


def mode_quality(
    records: SearchRecords, model: ModalModel, mode: int, chi_square_without: float
) -> ModeQuality:
    """Weigh one mode of a model against the best fit without that mode, given its chi-square."""
    lines, fewer = records.lines, records.fewer
    misfit = max(local_misfit(lines, model, mode), LEAST_MISFIT)
    price = parameters_of_a_mode(lines) * np.log(2.0 * lines.values.size)
    gain = (chi_square_without - model.chi_square) / misfit / price
    contribution = model.mode_contribution(fewer, mode)
    hertz = model.natural_frequency[mode] / (2.0 * np.pi)
    distance = np.abs(fewer.frequency - hertz)
    near = distance <= max(model.damping[mode] * hertz, np.min(distance))
    values = np.max(np.abs(fewer.values[near]), axis=0)
    local = np.max(np.abs(contribution[near]), axis=0) / np.maximum(values, TINY)
    local_share = float(np.max(local))
    return ModeQuality(
        float(gain),
        local_share,
        largest_share(fewer, contribution),
        resolved(lines, model, mode, local_share),
        bool(inside(lines, model)[mode]),
    )


def peak_share(records: Records, model: ModalModel, mode: int) -> float:
    """Largest contribution of a mode over the peak of an FRF."""
    return largest_share(records, model.mode_contribution(records, mode))


def largest_share(records: Records, contribution: NDArray[np.complex128]) -> float:
    """Largest contribution over the peak of the FRF, in the quantity where it is largest.

    Contribution (n, k) in the quantity of the records; the largest of all FRFs as receptance,
    mobility or accelerance.
    """
    size = np.abs(records.laplace[:, None])
    shares = []
    for derivative in range(3):
        scale = size ** (derivative - records.derivative)
        peak = np.max(np.abs(records.values) * scale, axis=0)
        shares.append(np.max(np.abs(contribution) * scale, axis=0) / np.maximum(peak, TINY))
    return float(np.max(shares))


def without_mode(records: Records, model: ModalModel, mode: int) -> ModalModel:
    """Fit with one mode fewer, poles of the others kept."""
    keep = np.arange(model.count) != mode
    return fit_residues(records, model.natural_frequency[keep], model.damping[keep], model.terms)
