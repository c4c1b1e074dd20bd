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
result       signals, verdict, surface; pictures and files
============ ======================================================================
"""
