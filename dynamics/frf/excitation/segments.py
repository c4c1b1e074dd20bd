"""Spectra averaged over segments of records: blows, periods, realisations."""

import numpy as np
from numpy.typing import NDArray

from dynamics.frf.container import Frf, MeasurementError, Point, Quantity
from dynamics.frf.hammer.spectra import Estimator, Spectra, frf_of


def spectra_of_segments(
    frequency: NDArray[np.float64],
    force: NDArray[np.complex128],
    response: NDArray[np.complex128],
    quantity: Quantity,
    added_decay: float = 0.0,
    points: tuple[Point, Point] = (Point(), Point()),
) -> Spectra:
    """Average power and cross spectra over segments, for `h1`, `h2`, `coherence` of hammer tests.

    Frequencies (l,), Hz, transforms (segments, l) of force and response, added decay, 1/s, and the
    points of the response and of the force.
    """
    return Spectra(
        frequency=frequency,
        force_power=np.mean(np.abs(force) ** 2, axis=0),
        response_power=np.mean(np.abs(response) ** 2, axis=0),
        cross=np.mean(response * np.conj(force), axis=0),
        count=len(force),
        noise_power=0.0,
        force_noise_power=0.0,
        quantity=quantity,
        added_decay=added_decay,
        response=points[0],
        reference=points[1],
    )


def averaged_frf(spectra: Spectra, estimator: Estimator, source: str) -> Frf:
    """Return the FRF of spectra, with the coherence where there are several segments.

    MeasurementError if a line holds no force.
    """
    require_force(spectra.frequency, spectra.force_power, source)
    return frf_of(spectra, estimator, source)


def require_force(frequency: NDArray[np.float64], power: NDArray[np.float64], source: str) -> None:
    """Raise MeasurementError at a line without power of the input or reference."""
    # a line below the rounding of the strongest holds nothing
    empty = power <= (8.0 * np.finfo(np.float64).eps) ** 2 * power.max(initial=0.0)
    if empty.any():
        raise MeasurementError(
            f"{source}: nothing was excited at {frequency[np.argmax(empty)]:g} Hz; keep to the "
            "lines of the excitation"
        )
