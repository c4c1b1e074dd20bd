"""Commanded motions of axes, their sampled set points, and the errors against them.

============ =====================================================================
module       responsibility
============ =====================================================================
motion       what every trajectory answers: duration, and motion at any time
jerk_limited point to point under limits of velocity, acceleration and jerk
periodic     sine, circle and constant speed
path         plane paths of lines and arcs, contour error and tracking error against them
path_motion  a path at a feed, slowed down for its corners under limits of jerk
spatial_path paths in space of lines, arcs and helices, and the distance from them
block_motion blocks of a path, each with its feed, looked ahead under limits of jerk
recorded     set points as they were recorded
set_points   set points at the interpolation cycle, and their leaf for the time loop
============ =====================================================================
"""
