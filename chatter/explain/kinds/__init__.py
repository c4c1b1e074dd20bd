"""Kinds of measurement: what each predicts, refits, checks and reports.

=============== ====================================================================
module          responsibility
=============== ====================================================================
kind            `Kind`: everything that is asked of a kind, with defaults
milling         forces and displacements of cuts, by the time-domain engine
axial_force     axial coefficients that a case leaves out
axis            force of a feed axis along its measured motion
axis_record     smoothed motion, weights and noise of the record of a move
drive           torque and position of an axis of a machine, by the machine in time
stability       cutting tests judged stable or chatter
frf             receptances at the tool point, idle and in the cut
same_case       what follows from a case, kept while that very case is asked for
kind_list       the list: where a new kind joins
=============== ====================================================================
"""
