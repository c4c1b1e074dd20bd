"""The cut and the machine in the time domain.

================= ===================================================================
module            responsibility
================= ===================================================================
simulate          `simulate`: sets a case up, runs it, asks whether it chatters; forces as a
                  dynamometer shows them
setup             a case compiled: laws at the tool point on a structure
structure_in_time modes or machine behind the ports, with its step
machine_in_time   the machine among them, its axes at the feed as the cut begins
resolution        steps, slices and length of a run, chosen where the case is silent
inclined_slices   slices of a tool whose axis is inclined, each with one of its arcs
spindle           rotation of the spindle and path of the tool over the steps
workpiece         workpiece of dexels or voxels
start_in_stock    stock that the tool stands in at the start is cleared
cut_run           steps of a run in chunks, between which the stock follows the tool
result            signals, verdict, surface; files
verdict           chatter detection of a simulated cut
perturbation/     growth of small perturbations in perturbed runs
virtual_tests/    a machine that moves alone: FRFs by tests, moves
carved_workpiece  walls of a carved workpiece
reconstruction    wall and floor from the motion of the tool
finish            surface that the cut leaves behind
================= ===================================================================
"""
