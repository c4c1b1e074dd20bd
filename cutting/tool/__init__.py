"""Geometry of tools.

========== =========================================================================
module     responsibility
========== =========================================================================
cutter     teeth around the axis, pitch, helix, runout; edges cut into slices
edge_table the slices as the time-domain kernels see them
========== =========================================================================
"""
