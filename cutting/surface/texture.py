"""Texture of a surface after ISO 4287, 4288 and 16610-21: roughness, waviness and place."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: constant of the Gaussian filter: half of a wave of the cut-off length passes
_ALPHA = math.sqrt(math.log(2.0) / math.pi)
#: longest spacing of marks and the cut-off that belongs to it, m
_CUT_OFFS = ((0.04e-3, 0.08e-3), (0.13e-3, 0.25e-3), (0.4e-3, 0.8e-3), (1.3e-3, 2.5e-3))
_LONGEST_CUT_OFF = 8e-3


@dataclass(frozen=True)
class HeightParameters:
    """Heights of a profile about its mean line after ISO 4287, m."""

    mean: float  # arithmetic mean deviation, Ra or Wa
    rms: float  # root mean square deviation, Rq or Wq
    depth: float  # highest peak to deepest valley, mean over the sampling lengths: Rz or Wz


def height_parameters(profile: Array, samples: int) -> HeightParameters:
    """Heights of a profile about its mean.

    Profile (n,), m; `samples` are the points of a sampling length, and a profile shorter than two
    of them counts as one.
    """
    off = profile - profile.mean()
    parts = np.array_split(off, max(1, off.size // max(samples, 1)))
    return HeightParameters(
        mean=float(np.abs(off).mean()),
        rms=float(np.sqrt(np.mean(off**2))),
        depth=float(np.mean([np.ptp(part) for part in parts])),
    )


def mean_line(profile: Array, spacing: float, cut_off: float) -> Array:
    """Waviness of a profile by the Gaussian filter of ISO 16610-21.

    Profile (..., n), spacing of its points, m, and cut_off, the wavelength of which half the
    amplitude passes, m. Within half a cut-off of the ends the weights are renormed to the points
    that there are.
    """
    half = min(int(cut_off / spacing), profile.shape[-1] - 1)
    position = np.arange(-half, half + 1) * spacing / (_ALPHA * cut_off)
    weight = np.exp(-math.pi * position**2)
    share = np.convolve(np.ones(profile.shape[-1]), weight)[half : -half or None]
    rows = profile.reshape(-1, profile.shape[-1])
    smooth = [np.convolve(row, weight)[half : -half or None] / share for row in rows]
    return np.array(smooth).reshape(profile.shape)


def cut_off_for(mark_spacing: float) -> float:
    """Cut-off of ISO 4288 for periodic profiles with this spacing of marks, m."""
    return next((cut for most, cut in _CUT_OFFS if mark_spacing <= most), _LONGEST_CUT_OFF)


@dataclass(frozen=True)
class Texture:
    """Roughness and waviness of profiles over the feed."""

    roughness: HeightParameters
    #: none where the profile is shorter than two cut-offs; roughness is then unfiltered
    waviness: HeightParameters | None
    cut_off: float  # m
    length: float  # evaluated, m


def texture(profiles: Array, weight: Array, spacing: float, cut_off: float) -> Texture:
    """Split profiles into roughness and waviness.

    Profiles (L, n), m, with their weights (L,) in the means that are returned; spacing of points
    and cut-off, m.
    """
    length = profiles.shape[1] * spacing
    if length < 2.0 * cut_off:
        rough = [height_parameters(row, row.size) for row in profiles]
        return Texture(_weighted(rough, weight), None, cut_off, length)
    samples, end = round(cut_off / spacing), round(0.5 * cut_off / spacing)
    kept = slice(end, profiles.shape[1] - end)
    waves = mean_line(profiles, spacing, cut_off)
    rough = [height_parameters(row[kept], samples) for row in profiles - waves]
    wavy = [height_parameters(row[kept], row.size) for row in waves]
    return Texture(
        _weighted(rough, weight), _weighted(wavy, weight), cut_off, length - 2.0 * end * spacing
    )


def _weighted(found: list[HeightParameters], weight: Array) -> HeightParameters:
    table = np.array([(one.mean, one.rms, one.depth) for one in found])
    return HeightParameters(*(float(value) for value in weight @ table / weight.sum()))


def location_error(deviation: Array, weight: Array) -> tuple[Array, float]:
    """Surface location error at each height and over the wall.

    Deviation (L, n) of the wall beyond its nominal place, m, positive where too much was removed,
    and weights (L,). Mean over the feed at each height (L,), and over the wall, m.
    """
    by_height = deviation.mean(axis=1)
    return by_height, float(weight @ by_height / weight.sum())
