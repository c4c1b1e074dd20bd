"""Where the cut meets the machine: the tool point, and the rotation of the tool in a step."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class ToolPoint(NamedTuple):
    """Motion of the tool against the workpiece and the force on the tool; x, y, z."""

    displacement: NDArray[np.float64]  # m, (3,)
    velocity: NDArray[np.float64]  # m/s, (3,)
    displacement_before: NDArray[np.float64]  # at the step before, m, (3,)
    velocity_before: NDArray[np.float64]  # m/s, (3,)
    force: NDArray[np.float64]  # that moves the structure, N, (3,)
    sample: NDArray[np.float64]  # force at the very instant, N, (3,)
    jumped: NDArray[np.int64]  # 1 where blur and jump of the step are not all zero, (1,)
    blur: NDArray[np.float64]  # mean force, N, and torque, N m, over the turn of a step, less the
    # sample, (4,)
    jump: NDArray[np.float64]  # force before and after the jumps of the step, less the sample, N,
    # (2, 3)
    torque: NDArray[np.float64]  # on the spindle, against its turning, N m, (1,)
    contact: NDArray[np.float64]  # engaged share of the depth of cut, (1,)


class Rotation(NamedTuple):
    """Rotation of the spindle and place on the tool path at a step and the one before.

    Angles are counted in bins, `bins` to a revolution: a whole number below `bins` and a part
    below 1.
    """

    whole: int
    part: float
    sine: float
    cosine: float
    sine_before: float
    cosine_before: float
    whole_before: int
    part_before: float
    advance: float  # bins from the step before
    speed: float  # rad/s
    step: float  # s
    x: float  # m
    y: float
    x_before: float
    y_before: float


class TurningRotation(NamedTuple):
    """Rotation on a path whose direction of feed turns; the fields of `Rotation`, and that."""

    whole: int
    part: float
    sine: float
    cosine: float
    sine_before: float
    cosine_before: float
    whole_before: int
    part_before: float
    advance: float  # bins from the step before
    speed: float  # rad/s
    step: float  # s
    x: float  # m
    y: float
    x_before: float
    y_before: float
    heading: float  # of the feed from +x towards +y, bins, 0 to a revolution


class InclinedRotation(NamedTuple):
    """Rotation in the axes of an inclined tool: the fields of `Rotation`, and the path along z."""

    whole: int
    part: float
    sine: float
    cosine: float
    sine_before: float
    cosine_before: float
    whole_before: int
    part_before: float
    advance: float  # bins from the step before
    speed: float  # rad/s
    step: float  # s
    x: float  # m
    y: float
    x_before: float
    y_before: float
    z: float  # along the tool axis, m
    z_before: float


def tool_point() -> ToolPoint:
    """Return a tool point at rest."""
    return ToolPoint(
        displacement=np.zeros(3), velocity=np.zeros(3), displacement_before=np.zeros(3),
        velocity_before=np.zeros(3), force=np.zeros(3), sample=np.zeros(3),
        jumped=np.zeros(1, dtype=np.int64), blur=np.zeros(4), jump=np.zeros((2, 3)),
        torque=np.zeros(1), contact=np.zeros(1),
    )  # fmt: skip
