"""What-if studies: a case or machine with some of its values changed, and what that changes.

=========== ========================================================================
module      responsibility
=========== ========================================================================
model     a case with its machine, or a machine alone: values, patches, fingerprint
variation   ``PATH=v1,v2``, ``PATH=from..to``, ``PATH=+-10%``: the values of a path
design      which points a study has: overlay, heat map, tornado
measures    what is computed at a point: lobes, critical depth, forces, surface, FRF
finished    points on disk, so that a study stopped goes on where it was
points      computing points one by one
study       `whatif`: a study and its result
telling     what changed, by how much, in words
ready       ready studies
=========== ========================================================================
"""
