"""Virtual tests of a machine: run in time, frequency responses, moves.

=============== ====================================================================
module          responsibility
=============== ====================================================================
engine          the compiled time loop
run             a machine run in chunks, its signals
loop_stability  control loops judged before anything runs
rigid_motion    what the axes' motion does to every port
move            a trajectory: tracking and contour error
=============== ====================================================================
"""
