"""One hit: the container of a hammer record."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from dynamics.frf.container import MeasurementError, Point, Quantity

#: SI unit of the response by quantity of the FRF
RESPONSE_UNIT: dict[Quantity, str] = {"receptance": "m", "mobility": "m/s", "accelerance": "m/s^2"}

FEWEST_SAMPLES = 32


@dataclass(frozen=True)
class HammerRecord:
    """One hit: force and response sampled together, SI units."""

    name: str  # of the file, as findings quote it
    sampling_rate: float  # Hz
    force: NDArray[np.float64]  # (n,), N
    response: NDArray[np.float64]  # (n,), m, m/s or m/s^2
    quantity: Quantity = "accelerance"  # of the FRF the pair gives: accelerance for an acceleration
    start_time: float = 0.0  # of the first sample, s
    # directions of both points, where the column names give them
    response_point: Point = field(default_factory=Point)
    reference_point: Point = field(default_factory=Point)
    source: str = ""  # path of the file

    def __post_init__(self) -> None:
        """Check shapes and finiteness; raise MeasurementError naming the record."""
        force = np.asarray(self.force, dtype=np.float64)
        response = np.asarray(self.response, dtype=np.float64)
        if force.ndim != 1 or force.shape != response.shape:
            raise MeasurementError(
                f"{self.name}: force has shape {force.shape} and response {response.shape}; "
                "both must be one column of the same length"
            )
        if force.size < FEWEST_SAMPLES:
            raise MeasurementError(
                f"{self.name}: {force.size} samples; a hammer record needs {FEWEST_SAMPLES}"
            )
        if not (np.all(np.isfinite(force)) and np.all(np.isfinite(response))):
            raise MeasurementError(f"{self.name}: holds a value that is not a finite number")
        if not (0.0 < self.sampling_rate < np.inf):
            raise MeasurementError(f"{self.name}: sampling rate {self.sampling_rate:g} Hz")
        object.__setattr__(self, "force", force)
        object.__setattr__(self, "response", response)

    @property
    def time(self) -> NDArray[np.float64]:
        """Time of each sample, s, shape (n,)."""
        return self.start_time + np.arange(self.force.size) / self.sampling_rate

    @property
    def response_unit(self) -> str:
        """SI unit of the response."""
        return RESPONSE_UNIT[self.quantity]


Fault = Literal[
    "unreadable",
    "no_hit",
    "cut_hit",
    "late_hit",
    "double_hit",
    "clipped",
    "dropout",
    "drift",
    "stuck_samples",
    "wrong_gain",
    "wrong_polarity",
    "trigger_skew",
    "late_bump",
    "no_coherence",
    "unlike_the_others",
    "not_comparable",
]


@dataclass(frozen=True)
class Finding:
    """One fault of one record."""

    record: str  # its name
    fault: Fault
    reason: str  # a sentence with the evidence: where, how large, against what
    # The record must not be averaged; else a remark: the evidence does not say which record is at
    # fault.
    is_decisive: bool = True
