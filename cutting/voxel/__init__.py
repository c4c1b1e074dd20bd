"""Workpiece of cells of material (voxels) that the edges carve.

======= ============================================================================
module  responsibility
======= ============================================================================
stock   layout in memory, shaping before the cut, moving along with the tool, measurement
carving kernels: material that an edge takes away, chip thickness that it meets
======= ============================================================================
"""
