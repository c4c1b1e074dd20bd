"""FRFs of periodic excitation: averages over periods and realisations, and their variances."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from dynamics.frf.container import Frf, MeasurementError, Point, Quantity
from dynamics.frf.excitation.holds import Hold, laplace, without_hold
from dynamics.frf.excitation.segments import require_force, spectra_of_segments
from dynamics.frf.hammer.spectra import coherence, h1

#: of the period in samples of two records, from one another
_SAME_STEP = 1e-9


@dataclass(frozen=True)
class PeriodicRecord:
    """Input and response under a periodic excitation, one realisation, SI units."""

    #: (n,), held at the beginning of the step over which it acts, N (N m)
    force: NDArray[np.float64]
    response: NDArray[np.float64]  # (n,), sampled together with it, m, m/s or m/s^2 (rad, ...)
    step: float  # s
    period: int  # samples
    lines: NDArray[np.int64]  # (l,), excited harmonics of the period, rising
    leading: int = 1  # first periods, which hold transients and are passed over
    quantity: Quantity = "receptance"  # of the FRF the pair gives
    #: (n,), injected into a closed loop, of which force and response are both answers
    reference: NDArray[np.float64] | None = None
    name: str = "periodic record"
    response_point: Point = field(default_factory=Point)
    reference_point: Point = field(default_factory=Point)

    def __post_init__(self) -> None:
        """Check shapes, finiteness, periods and lines; raise MeasurementError."""
        for key in ("force", "response", "reference"):
            column = getattr(self, key)
            if column is None and key == "reference":
                continue
            column = np.asarray(column, dtype=np.float64)
            if column.ndim != 1 or column.shape != np.shape(self.force):
                raise MeasurementError(
                    f"{self.name}: {key} has shape {column.shape} and force "
                    f"{np.shape(self.force)}; all must be one column of the same length"
                )
            if not np.isfinite(column).all():
                raise MeasurementError(
                    f"{self.name}: {key} at sample {int(np.argmin(np.isfinite(column)))} is not a "
                    "finite number"
                )
            object.__setattr__(self, key, column)
        lines = np.asarray(self.lines, dtype=np.int64)
        object.__setattr__(self, "lines", lines)
        if not 0.0 < self.step < np.inf:
            raise MeasurementError(f"{self.name}: step is {self.step} s")
        if self.period < 3 or self.leading < 0 or self.periods < 1:
            raise MeasurementError(
                f"{self.name}: {self.force.size} samples hold no period of {self.period} behind "
                f"{self.leading} leading ones"
            )
        if lines.ndim != 1 or lines.size < 2 or np.any(np.diff(lines) < 1):
            raise MeasurementError(f"{self.name}: lines must be two at least, rising")
        if lines[0] < 1 or 2 * lines[-1] >= self.period:
            raise MeasurementError(
                f"{self.name}: lines {lines[0]} to {lines[-1]} of a period of {self.period} "
                f"samples; they must lie from 1 to {(self.period - 1) // 2}"
            )

    @property
    def periods(self) -> int:
        """Whole periods behind the leading ones."""
        return self.force.size // self.period - self.leading

    @property
    def frequency(self) -> NDArray[np.float64]:
        """Frequencies of the excited lines, Hz, shape (l,)."""
        return self.lines / (self.period * self.step)

    def transforms(self, column: NDArray[np.float64]) -> NDArray[np.complex128]:
        """Return the transforms of a column over each period at the lines, shape (periods, l)."""
        first = self.leading * self.period
        kept = column[first : first + self.periods * self.period]
        return np.fft.rfft(kept.reshape(self.periods, self.period))[:, self.lines]


@dataclass(frozen=True)
class PeriodicFrf:
    """FRF of a periodic excitation and how sure it is.

    With friction or another nonlinearity the FRF is the best linear approximation for excitations
    of its spectrum and power. Variances are of the FRF averaged over all periods and
    realisations, sum of those of real and imaginary part, squared unit of the FRF.
    """

    frf: Frf  # on the excited lines; its coherence is that over all periods and realisations
    realisations: int
    #: (l,), seen from period to period; None for one period
    noise_variance: NDArray[np.float64] | None
    #: (l,), seen from realisation to realisation, of noise and nonlinear distortion together; None
    #: for one realisation
    total_variance: NDArray[np.float64] | None

    @property
    def distortion_variance(self) -> NDArray[np.float64]:
        """Variance of nonlinear distortion that one realisation has, (l,); 0 where noise hides it.

        Raises MeasurementError with one period or one realisation, from which it cannot be told.
        """
        if self.noise_variance is None or self.total_variance is None:
            raise MeasurementError(
                f"{self.frf.source}: nonlinear distortion is told from noise by at least two "
                "periods in each of two realisations"
            )
        return self.realisations * np.maximum(self.total_variance - self.noise_variance, 0.0)


def frf_of_periods(records: Sequence[PeriodicRecord], hold: Hold) -> PeriodicFrf:
    """Estimate the FRF of periodic excitation, open or closed loop, by averages over periods.

    The transforms of force and response are averaged over the periods of a realisation, in step
    with the excitation, before their ratio is taken; noise then averages out even where a loop
    feeds it back into the force. The ratios are averaged over realisations, which have other phases
    but the same step, period, lines and quantity. The hold is what lay between the samples of the
    force. MeasurementError if the records are not of one kind or a line holds no force.

    Source: R. Pintelon and J. Schoukens, 2012, System Identification: A Frequency Domain Approach,
    2nd ed., chapter 4, the robust method for the best linear approximation.
    """
    require_one_excitation(records)
    first = records[0]
    pairs = [
        (record.transforms(record.force), record.transforms(record.response)) for record in records
    ]
    means = np.array([(force.mean(axis=0), response.mean(axis=0)) for force, response in pairs])
    for record, (force, _) in zip(records, means, strict=True):
        require_force(first.frequency, np.abs(force) ** 2, record.name)
    ratios = means[:, 1] / means[:, 0]
    force, response = (np.concatenate(column) for column in zip(*pairs, strict=True))
    spectra = spectra_of_segments(first.frequency, force, response, first.quantity)
    frf = Frf(
        first.frequency,
        ratios.mean(axis=0),
        first.quantity,
        first.response_point,
        first.reference_point,
        coherence(spectra) if spectra.count > 1 else None,
        _names(records),
    )
    gain = np.abs(hold.transfer(laplace(frf), first.step)) ** 2
    count = len(records)
    noise = total = None
    if min(record.periods for record in records) > 1:
        noise = sum(_ratio_variance(*pair) for pair in pairs) / count**2 / gain
    if count > 1:
        spread = np.sum(np.abs(ratios - ratios.mean(axis=0)) ** 2, axis=0)
        total = spread / (count * (count - 1)) / gain
    return PeriodicFrf(without_hold(frf, hold, first.step), count, noise, total)


def require_one_excitation(records: Sequence[PeriodicRecord]) -> None:
    """Raise MeasurementError unless records share step, period, lines and quantity."""
    if not records:
        raise MeasurementError("no periodic record to estimate an FRF from")
    first = records[0]
    for record in records[1:]:
        same = (
            abs(record.step - first.step) <= _SAME_STEP * first.step
            and record.period == first.period
            and np.array_equal(record.lines, first.lines)
            and record.quantity == first.quantity
        )
        if not same:
            raise MeasurementError(
                f"{record.name} and {first.name} differ in step, period, lines or quantity; "
                "realisations must share them"
            )


def _names(records: Sequence[PeriodicRecord]) -> str:
    return ", ".join(dict.fromkeys(record.name for record in records))


def _ratio_variance(
    force: NDArray[np.complex128], response: NDArray[np.complex128]
) -> NDArray[np.float64]:
    """Variance of the ratio of means over periods, to first order.

    Source: Pintelon and Schoukens (2012), chapter 2; here as the mean square of
    (Y_p - G U_p) / U, which holds the three (co)variances together.
    """
    periods = len(force)
    mean = force.mean(axis=0)
    off = (response - response.mean(axis=0) / mean * force) / mean
    return np.sum(np.abs(off) ** 2, axis=0) / (periods * (periods - 1))


def joint_input_output_frf(records: Sequence[PeriodicRecord], hold: Hold) -> Frf:
    """Estimate the FRF as the ratio of the answers of response and force to the reference.

    G = (S_yr / S_rr) / (S_ur / S_rr). Noise that goes round the loop knows nothing of the reference
    and averages out of both, whereas it stays in the product of response and force. Records are
    realisations of the same step, period, lines and quantity; the coherence, of response and
    reference, is there where there are several periods. The hold is what lay between the samples of
    the force. MeasurementError if a record has no reference, the records are not of one kind, or a
    line is not excited.

    Source: P. E. Wellstead, 1981, "Non-parametric methods of system identification", Automatica 17;
    R. Pintelon and J. Schoukens, 2012, System Identification, 2nd ed., chapter 2.
    """
    require_one_excitation(records)
    first = records[0]
    columns = {"force": [], "response": [], "reference": []}
    for record in records:
        if record.reference is None:
            raise MeasurementError(
                f"{record.name}: no reference; the signal injected into the loop is needed"
            )
        for key, transforms in columns.items():
            transforms.append(record.transforms(getattr(record, key)))
    force, response, reference = (np.concatenate(parts) for parts in columns.values())
    require_force(first.frequency, np.mean(np.abs(reference) ** 2, axis=0), first.name)
    of_response = spectra_of_segments(first.frequency, reference, response, first.quantity)
    of_force = spectra_of_segments(first.frequency, reference, force, first.quantity)
    require_force(first.frequency, np.abs(of_force.cross), first.name)
    frf = Frf(
        first.frequency,
        h1(of_response) / h1(of_force),
        first.quantity,
        first.response_point,
        first.reference_point,
        coherence(of_response) if of_response.count > 1 else None,
        ", ".join(dict.fromkeys(record.name for record in records)),
    )
    return without_hold(frf, hold, first.step)
