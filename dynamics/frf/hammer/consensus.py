"""What the records of a set have in common: which agree, and the function they share."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from dynamics.frf.hammer.force_checks import block_medians
from dynamics.frf.hammer.hit import NORMAL_MAD, Hit
from dynamics.frf.hammer.record import HammerRecord
from dynamics.frf.hammer.response_checks import decay_end

#: samples over which a slow movement is told from noise
WANDER_BLOCK = 128
#: share of the largest conceivable response to the unknown part of a blow that is expected
_UNKNOWN_SHARE = 0.45
#: samples about the blow over which that response is expected
_REACH = 33
#: samples kept ahead of the blow
_LEAD = 64
#: lines where the force has fallen below this share of its largest are not compared
_FORCE_FLOOR = 0.1
#: lines over which signal and noise are averaged to weigh the common function
_WIENER_LINES = 65
#: tried in turn: largest relative difference of records that count as agreeing
_AGREEMENT = (0.05, 0.1, 0.2)


@dataclass(frozen=True)
class AlignedSet:
    """Records cut to begin alike before the blow, with their spectra."""

    names: tuple[str, ...]
    sampling_rate: float  # Hz
    force: NDArray[np.float64]  # (n, m), blows alone (zero elsewhere), one row a record
    response: NDArray[np.float64]  # (n, m), rest levels removed
    force_spectra: NDArray[np.complex128]  # (n, k)
    response_spectra: NDArray[np.complex128]  # (n, k), of the response up to the end of the ringing
    lead: int  # samples ahead of the blow
    ringing: int  # samples until the ringing of most records is over
    noise: NDArray[np.float64]  # (n,), standard deviation of the noise of each response
    #: (n,), slow movement of each rest level after the ringing (mains hum, thermal drift), as a
    #: standard deviation
    wander: NDArray[np.float64]
    #: (n,), expected energy of the noise under the blow, per line
    force_noise_energy: NDArray[np.float64]

    @property
    def transform_length(self) -> int:
        """Length of the zero-padded transforms."""
        return 2 * (self.force_spectra.shape[1] - 1)


def align(records: Sequence[HammerRecord], hits: Sequence[Hit]) -> AlignedSet:
    """Cut records to begin alike before the blow and transform them.

    They are of one sampling rate, with a hit each.
    """
    lead = min(_LEAD, *(hit.onset for hit in hits))
    length = min(
        record.force.size - hit.onset + lead for record, hit in zip(records, hits, strict=True)
    )
    force = np.zeros((len(records), length))
    response = np.zeros((len(records), length))
    for row, (record, hit) in enumerate(zip(records, hits, strict=True)):
        first = hit.onset - lead
        blow = slice(max(lead - 2, 0), min(lead + hit.width + 2, length))
        force[row, blow] = record.force[first : first + length][blow] - hit.force.level
        response[row] = record.response[first : first + length] - hit.response.level
    ends = [decay_end(record, hit) - hit.onset for record, hit in zip(records, hits, strict=True)]
    ringing = min(lead + int(1.2 * np.median(ends)) + _LEAD, length)
    transform_length = 2 ** int(np.ceil(np.log2(2 * length)))
    gated = response * _gate(length, ringing)
    return AlignedSet(
        names=tuple(record.name for record in records),
        sampling_rate=records[0].sampling_rate,
        force=force,
        response=response,
        force_spectra=np.fft.rfft(force, transform_length),
        response_spectra=np.fft.rfft(gated, transform_length),
        lead=lead,
        ringing=ringing,
        noise=np.array([hit.response.noise for hit in hits]),
        wander=np.array([_wander(row[ringing:]) for row in response]),
        force_noise_energy=np.array([hit.force.noise**2 * (hit.width + 4) for hit in hits]),
    )


def _wander(quiet: NDArray[np.float64]) -> float:
    """Standard deviation of block medians about the rest level, unmoved by a passing bump."""
    if quiet.size < 4 * WANDER_BLOCK:
        return 0.0
    return float(np.median(np.abs(block_medians(quiet, WANDER_BLOCK)))) / NORMAL_MAD


def _gate(length: int, ringing: int) -> NDArray[np.float64]:
    """One over the ringing, then a cosine down to zero over an eighth of it."""
    gate = np.zeros(length)
    gate[:ringing] = 1.0
    fall = min(max(ringing // 8, 8), length - ringing)
    gate[ringing : ringing + fall] = 0.5 * (1.0 + np.cos(np.pi * np.arange(1, fall + 1) / fall))
    return gate


def disagreement(aligned: AlignedSet) -> NDArray[np.float64]:
    """Relative difference of the functions of every two records, noise taken off.

    A_i F_j is compared with A_j F_i, which agree where A / F does, over the lines where both blows
    have force; what the noise of the responses contributes on average is subtracted.

    (n, n): 0 for equal functions, about 1 and more for unrelated ones.
    """
    count = len(aligned.names)
    power = np.abs(aligned.force_spectra) ** 2
    strong = power > _FORCE_FLOOR**2 * power.max(axis=1, keepdims=True)
    noise_line = aligned.noise**2 * aligned.ringing  # expected noise power of a line
    result = np.zeros((count, count))
    for i in range(count):
        for j in range(i):
            lines = strong[i] & strong[j]
            a = aligned.response_spectra[i, lines] * aligned.force_spectra[j, lines]
            b = aligned.response_spectra[j, lines] * aligned.force_spectra[i, lines]
            expected = noise_line[i] * power[j, lines].sum() + noise_line[j] * power[i, lines].sum()
            difference = max(float(np.sum(np.abs(a - b) ** 2)) - expected, 0.0)
            scale = float(np.linalg.norm(a) * np.linalg.norm(b))
            result[i, j] = result[j, i] = np.sqrt(difference / scale) if scale > 0.0 else 2.0
    return result


def agreeing_group(difference: NDArray[np.float64]) -> tuple[NDArray[np.bool_], float]:
    """Largest group of records that agree with one of them.

    By the `disagreement` (n, n): the group (n,), all False where no two records agree or two groups
    are equally large, and the difference at which they agree; wider where less than half agree at
    the narrowest.
    """
    count = difference.shape[0]
    for tolerance in _AGREEMENT:
        agree = difference <= tolerance
        size = agree.sum(axis=1)
        # of equally large groups, the tightest
        tightness = np.where(agree, difference, 0.0).sum(axis=1)
        center = int(np.lexsort((tightness, -size))[0])
        group = agree[center]
        if 2 * group.sum() >= count and group.sum() >= 2 and not _has_rival(agree, group):
            return group, tolerance
    return np.zeros(count, dtype=bool), _AGREEMENT[-1]


def _has_rival(agree: NDArray[np.bool_], group: NDArray[np.bool_]) -> bool:
    """True where another group, sharing no record with this one, is as large."""
    others = agree[~group][:, ~group]
    return others.size > 0 and int(others.sum(axis=1).max()) >= int(group.sum())


@dataclass(frozen=True)
class CommonFunction:
    """Response per force that some records share."""

    values: NDArray[np.complex128]  # (k,), on the lines of the spectra of the set
    #: (k,), standard deviation of `values` from the noise of the responses
    noise: NDArray[np.float64]
    #: (k,), 1 where the function is known, 0 where the blows have no force to know it by
    weight: NDArray[np.float64]


def common_function(aligned: AlignedSet, members: NDArray[np.bool_]) -> CommonFunction:
    """Least-squares response per force of the members.

    Where the blows have too little force for the noise, the values fall to zero by Wiener's
    weight, signal over signal and noise, averaged over neighbouring lines.

    Members are (n,).
    """
    force = aligned.force_spectra[members]
    power = np.sum(np.abs(force) ** 2, axis=0)
    power = power + float(np.sum(aligned.force_noise_energy[members]))
    cross = np.sum(aligned.response_spectra[members] * np.conj(force), axis=0)
    noise_line = (aligned.noise[members] ** 2 * aligned.ringing)[:, None]
    noise = np.sum(noise_line * np.abs(force) ** 2, axis=0) + 1e-300
    measured = scipy.ndimage.uniform_filter1d(np.abs(cross) ** 2, _WIENER_LINES, mode="nearest")
    weight = np.clip(
        1.0 - scipy.ndimage.uniform_filter1d(noise, _WIENER_LINES, mode="nearest") / measured, 0, 1
    )
    return CommonFunction(weight * cross / power, weight * np.sqrt(noise) / power, weight)


def predicted(
    aligned: AlignedSet, function: CommonFunction, row: int
) -> tuple[NDArray[np.float64], float]:
    """Response (m,) of one record to its own blow by the common function, and its noise.

    That is the standard deviation of the response while it rings, from the noise of the common
    function.
    """
    force = aligned.force_spectra[row]
    response = np.fft.irfft(function.values * force, aligned.transform_length)
    energy = 2.0 * float(np.sum(np.abs(function.noise * force) ** 2)) / aligned.transform_length
    return response[: aligned.force.shape[1]], float(np.sqrt(energy / aligned.ringing))


def unpredictable(
    aligned: AlignedSet, function: CommonFunction, row: int, others: int
) -> NDArray[np.float64]:
    """Response to expect from that part of a blow for which the function is not known.

    A blow sharper than the others drives frequencies the others tell nothing of; above the known
    band the function is taken to be no larger than at its end, and more is left open the fewer
    they are.

    (m,), one a sample, in the unit of the response.
    """
    known = np.flatnonzero(function.weight > 0.5)
    if known.size == 0:
        return np.full(aligned.force.shape[1], np.inf)
    end = known[known > 0.75 * known[-1]]
    level = float(np.sqrt(np.mean(np.abs(function.values[end]) ** 2)))
    spectrum = (1.0 - function.weight) * aligned.force_spectra[row]
    force = np.fft.irfft(spectrum, aligned.transform_length)[: aligned.force.shape[1]]
    # an unknown mode rings on for a while: a few times the duration of the blow
    sharp = scipy.ndimage.maximum_filter1d(np.abs(force), _REACH, mode="nearest")
    acting = np.zeros(force.size)
    blow = np.flatnonzero(aligned.force[row])
    acting[max(blow[0] - _REACH // 2, 0) : blow[-1] + 2 * blow.size] = 1.0
    return _UNKNOWN_SHARE * (1.0 + 2.0 / others) * level * sharp * acting
