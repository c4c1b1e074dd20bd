"""Workpiece of cells of material (voxels) that the edges carve.

======= ============================================================================
module  responsibility
======= ============================================================================
stock   layout in memory, shaping before the cut, measurement after it
window  the part of the workpiece near the tool, moving along with it
carving kernels: material that an edge takes away, chip thickness that it meets
======= ============================================================================
"""
