"""What the stability kernels see of a case: flat arrays in SI."""

from typing import NamedTuple

import numpy as np

from chatter.description.arrays import Array
from chatter.stability.model import MillingModel
from cutting.force.directional_coefficients import DirectionalTable


class MillingArrays(NamedTuple):
    """A milling cut on a modal structure, with speed and depth left open.

    The motion of the tool point against the worksegment lies in the space of the mode directions;
    r is its dimension (1 to 3) and n the number of modes.
    """

    natural_frequency: Array  # rad/s (n,)
    damping: Array  # ratio (n,)
    shape: Array  # displacement per modal coordinate (n, r)
    force_gain: Array  # modal acceleration per force, 1/kg (n, r)
    table: DirectionalTable
    tooth_pitch: float  # rad
    lag_per_depth: float  # tan(helix)/R, rad/m
    radius: float  # m, for the cutting speed
    stiffening: float  # stiffness of a flank that ploughs over its dashpot, 1/s


def milling_arrays(model: MillingModel) -> MillingArrays:
    """What semi-discretization sees of a model with a uniform-pitch cylindrical end mill."""
    frequency, damping, shape, gain = model.modal_arrays
    return MillingArrays(
        natural_frequency=frequency,
        damping=damping,
        shape=shape,
        force_gain=gain,
        table=model.table,
        tooth_pitch=2.0 * np.pi / model.teeth,
        lag_per_depth=model.lag_per_depth,
        radius=model.cutter.radius,
        stiffening=model.flank_stiffening,
    )
