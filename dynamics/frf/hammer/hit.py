"""Where the hit lies in a record, and what the two channels read when nothing happens."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dynamics.frf.container import MeasurementError
from dynamics.frf.hammer.record import HammerRecord
from dynamics.frf.hammer.written_number import written

#: median absolute deviation of a normal distribution, in standard deviations
NORMAL_MAD = 0.6745
#: samples a block for noise levels and baselines
_BLOCK = 256


@dataclass(frozen=True)
class Baseline:
    """Rest level and noise of one channel."""

    level: float  # median before the hit (over the whole record where the hit comes at once)
    noise: float  # standard deviation of what changes from sample to sample
    resolution: float  # smallest step between different values; a noise below it cannot be seen


@dataclass(frozen=True)
class Hit:
    """The main blow of a record, in samples."""

    onset: int  # first sample of the blow
    peak: int  # the largest
    end: int  # one past the last
    polarity: int  # +1 where the force peak is positive, -1 otherwise
    amplitude: float  # height of the peak above the rest level, N, positive
    force: Baseline  # rest level and noise of the channel
    response: Baseline  # likewise

    @property
    def width(self) -> int:
        """Duration of the blow in samples."""
        return self.end - self.onset


def locate_hit(record: HammerRecord) -> Hit:
    """Find the main blow of a record: the largest excursion of the force from its rest level.

    MeasurementError if the force channel never leaves its noise.
    """
    force = record.force - np.median(record.force)
    peak = int(np.argmax(np.abs(force)))
    amplitude = float(np.abs(force[peak]))
    noise = noise_of(record.force)
    if amplitude == 0.0 or amplitude < 12.0 * noise:
        raise MeasurementError(
            f"{record.name}: no hit; the force stays within {written(amplitude)} N and its "
            f"noise is {written(noise, 2)} N"
        )
    polarity = 1 if force[peak] > 0 else -1
    threshold = max(4.0 * noise, 0.01 * amplitude)
    quiet = polarity * force < threshold
    before = np.flatnonzero(quiet[:peak])
    after = np.flatnonzero(quiet[peak:])
    onset = int(before[-1]) + 1 if before.size else 0
    end = peak + int(after[0]) if after.size else force.size
    return Hit(
        onset=onset,
        peak=peak,
        end=end,
        polarity=polarity,
        amplitude=amplitude,
        force=_baseline(record.force, onset),
        response=_baseline(record.response, onset),
    )


def with_later_blows(record: HammerRecord, hit: Hit) -> Hit:
    """Stretch a hit over every blow of the record, so that a window takes none of them away.

    A second blow is no error of the FRF as long as all of its force is measured.
    """
    force = np.abs(record.force - hit.force.level)
    acting = np.flatnonzero(force > max(6.0 * hit.force.noise, 0.01 * hit.amplitude))
    onset, end = min(int(acting[0]), hit.onset), max(int(acting[-1]) + 1, hit.end)
    return replace(hit, onset=onset, end=end)


def _baseline(signal: NDArray[np.float64], onset: int) -> Baseline:
    rest = signal[: max(onset - 2, 0)]
    level = float(np.median(rest)) if rest.size >= 16 else float(np.median(signal))
    return Baseline(level, noise_of(signal), resolution_of(signal))


def noise_of(signal: NDArray[np.float64]) -> float:
    """Standard deviation of the sample-to-sample noise of a signal that also moves.

    The fourth difference removes what is smooth; its median absolute value, over the quietest
    quarter of blocks, is that of the noise however much of the record rings.

    Of a signal (n,), in its unit; not below a third of its resolution.
    """
    fourth = np.diff(signal, n=4) / np.sqrt(70.0)  # norm of 1, -4, 6, -4, 1
    count = fourth.size // _BLOCK
    if count == 0:
        level = float(np.median(np.abs(fourth)))
    else:
        blocks = np.median(np.abs(fourth[: count * _BLOCK].reshape(count, _BLOCK)), axis=1)
        blocks = np.sort(blocks[blocks > 0.0])  # a stuck segment has no noise to show
        quiet = blocks[: max(1, blocks.size // 2)]
        level = float(np.median(quiet)) if quiet.size else 0.0
    return max(level / NORMAL_MAD, resolution_of(signal) / 3.0)


def resolution_of(signal: NDArray[np.float64]) -> float:
    """Smallest step between different values of a signal (0 for a constant one)."""
    steps = np.diff(np.unique(signal))
    scale = float(np.max(np.abs(signal))) if signal.size else 0.0
    steps = steps[steps > 1e-12 * scale]
    return float(steps.min()) if steps.size else 0.0
