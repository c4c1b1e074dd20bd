"""The cut in the time domain.

============ ======================================================================
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
"""
