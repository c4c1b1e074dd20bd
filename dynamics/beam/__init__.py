"""Shafts, spindles and tools as Timoshenko beams.

======= ======================================================== =================================
module  responsibility                                           source
======= ======================================================== =================================
element stiffness and consistent mass of a round element         Friedman and Kosmatka 1993
shaft   lines of elements with discs and bearings, as parts
======= ======================================================== =================================
"""
