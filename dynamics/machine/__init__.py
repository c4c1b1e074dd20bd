"""A machine: structure, drives, friction and control, stepped together or linearised.

=============== =======================================================================
module          responsibility
=============== =======================================================================
description     parts, axes and frictions -> `Machine` in a condition (control, brake)
blocks          coordinates in which the free motion of the structure is cheap and exact
steps           a structure on its ports over a step: table and kernels (the bus)
modal_structure modes of tool and workpiece as a structure on ports
ports           what every structure on ports answers, modes too
groups          laws on the bus: controlled drives, constant forces, loads, frictions
travel_limit    where a run halts
tables          `Machine`, or modes -> tables for the time loop
harmonic        response of the linearised machine, loops closed
=============== =======================================================================
"""
