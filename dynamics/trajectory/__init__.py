"""Commanded motions of axes, their sampled set points, and the errors against them.

============ =====================================================================
module       responsibility
============ =====================================================================
motion       what every trajectory answers: duration, and motion at any time
jerk_limited point to point under limits of velocity, acceleration and jerk
periodic     sine, circle and constant speed
path         plane paths of lines and arcs: polyline and square with fillets
path_motion  a path at a feed, slowed down for its corners under limits of jerk
set_points   set points at the interpolation cycle, and their leaf for the time loop
contour      contour error and tracking error
============ =====================================================================
"""

from dynamics.trajectory.contour import ContourError, contour_error, tracking_error
from dynamics.trajectory.jerk_limited import JerkLimitedMove
from dynamics.trajectory.motion import Motion, Trajectory, TrajectoryError
from dynamics.trajectory.path import Arc, Line, Path, circle, polyline, square
from dynamics.trajectory.path_motion import PathMotion
from dynamics.trajectory.periodic import CircleMotion, ConstantSpeedMove, SineMotion
from dynamics.trajectory.set_points import SetPoints, set_point_at, set_points

__all__ = [
    "Arc",
    "CircleMotion",
    "ConstantSpeedMove",
    "ContourError",
    "JerkLimitedMove",
    "Line",
    "Motion",
    "Path",
    "PathMotion",
    "SetPoints",
    "SineMotion",
    "Trajectory",
    "TrajectoryError",
    "circle",
    "contour_error",
    "polyline",
    "set_point_at",
    "set_points",
    "square",
    "tracking_error",
]
