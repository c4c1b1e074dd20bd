"""A machine: structure, drives, friction and control, stepped together or linearised.

============ =======================================================================
module       responsibility
============ =======================================================================
description  parts, axes and frictions -> `Machine` in a condition (control, brake)
blocks       coordinates in which the free motion of the structure is cheap and exact
steps        the structure on its ports over a step: table and kernels (the bus)
groups       what acts on the bus: controlled drives, constant forces, frictions
loop         one step of the whole machine
tables       `Machine` -> tables for the time loop
harmonic     response of the linearised machine, loops closed
============ =======================================================================
"""
