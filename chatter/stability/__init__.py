"""Stability of a cut: limits, multipliers and chatter frequencies by several methods.

=====================  =========================================================================
module                 responsibility
=====================  =========================================================================
model                  a case compiled for all methods: structure, cutter, laws, receptance
cut_arrays             the flat arrays of a cut of any tool
averaged_coefficients  directional coefficients averaged over a revolution
spindle_rotation       rotation at a constant or varying speed
stability_method       what a method is
registry               the list of methods and the choice among them
case_schema            JSON schema of the case file with these methods
methods/               a package per method
reference_speeds       speed-dependent dynamics: one structure per reference speed
limit_search           from multipliers at points to limits over spindle speed
limits_by_depth        limits of a cut whose arcs change with the depth: an inclined tool
shared_depths          growth rate between depths that all speeds share
crossings, brackets    changes of stability along depth; roots in brackets
boundary_continuation  multi-dimensional bisection (Bachrathy and Stepan 2012)
arnoldi, hessenberg    dominant eigenpair of an operator (Arnoldi 1951; Francis 1961)
simd_batch             numbers of eight points for compiled code
limit_curve            limits over speed: what every method returns
diagram, lobes         diagrams over an axis and maps over two; the lobe diagram
search_range, pockets  speeds and depths of a diagram; speeds at which a deep cut is stable
forced_vibration       loss of contact in the steady cut (Budak and Altintas 1998)
check                  stability of the cut of a case
=====================  =========================================================================
"""
