"""What-if studies: a case or machine with some of its values changed, and what that changes.

============== =====================================================================
module         responsibility
============== =====================================================================
variation      ``PATH=v1,v2``, ``PATH=from..to``, ``PATH=+-10%``: the values of a path
design         points of a study: overlay, heat map, tornado
measures       what is computed at a point: lobes, critical depth, forces, surface, FRF
whatif_study   `whatif`: all points, and the result
summary        what changed, by how much, in sentences
preset_studies common questions with their paths and values
============== =====================================================================
"""
