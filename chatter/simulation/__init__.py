"""The cut and the machine in the time domain.

module       responsibility
============ ======================================================================
cutter       tool and force laws of a case, as `cutting` knows them
resolution   steps, slices and length of a run, chosen where the case is silent
spindle      turn of the spindle and path of the tool over the steps
setup        a case compiled to law groups, modes and record
laws         law groups, dispatched by the type of their table
engine       the compiled time loop
simulate     `simulate`: runs a case and returns its result
growth       multiplier of a cut from the growth of its vibration
limits       limits of stability from it, over speed
stock        workpiece of dexels or voxels
carved       walls of a carved workpiece
reconstruction wall and floor from the motion of the tool
finish       surface that the cut leaves behind
result       signals, verdict, surface; pictures and files
============ ======================================================================
=======
================= ===================================================================
module            responsibility
================= ===================================================================
simulate          `simulate`: sets a case up, runs it, asks whether it chatters
setup             a case compiled: laws at the tool point on a structure
structure_in_time modes or machine behind the ports, with its step
resolution        steps, slices and length of a run, chosen where the case is silent
spindle           rotation of the spindle and path of the tool over the steps
workpiece         workpiece of dexels or voxels
cut_run           steps of a run in chunks, between which the stock follows the tool
result            signals, verdict, surface; files. `machine_result`: of drives too
verdict           chatter detection of a simulated cut
perturbation/     growth of small perturbations in perturbed runs
virtual_tests/    a machine that moves alone: FRFs by tests, moves
carved_workpiece  walls of a carved workpiece
reconstruction    wall and floor from the motion of the tool
finish            surface that the cut leaves behind
dynamometer       forces as a dynamometer with a resonance shows them
================= ===================================================================
"""
