"""Judge a record of a cut: stable or chatter, its kind and its frequency.

============== =======================================================================
module         responsibility
============== =======================================================================
record         `CutRecord`: what is judged, checked
sections       signals over the spindle angle, whole periods, once-a-turn samples
deviations     differences from period to period, noise taken off, their growth
lines          rotation a period and frequency of the chatter motion
orbits         kind of a sustained motion
doubling       period doubled within a turn while the runout is not known
verdict        `judge`
============== =======================================================================
"""
