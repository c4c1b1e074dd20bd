"""Checks of measured data before anything is blamed on physics.

=================== ================================================================
module              responsibility
=================== ================================================================
finding             what a check found, how bad it is, and what follows
clock               clocks: rising, even, in seconds, without holes
samples             gaps, flat tops, dropouts, dead channels, copies of runs
spindle             spindle speed and number of teeth against angle and forces
patterns            mean force of a tooth passing, measured and of a rigid cut
channel_assignment  force channels, teeth, mode of milling and depths against the cut
scale               units of the forces, dead sensors
displacement        displacements against the forces through the declared structure
motion              axis moves: force, velocity and position against each other
responses           FRFs against each other and the declared structure
verdicts            points judged stable or chatter
=================== ================================================================
"""
