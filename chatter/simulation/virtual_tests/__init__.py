"""Virtual tests of a machine that moves alone.

============= =======================================================================
module        responsibility
============= =======================================================================
run           a machine run in time, its signals
courses       trajectories: computed, of an NC program, of recorded set points
move          a trajectory: tracking and contour error
virtual_tests FRFs by tests in time: blows, chirps, multisines, torques
loop_response response of the control loops
frf           FRFs of a machine: linearised and by tests. `frf_peaks`: their peaks
from_file     FRFs and moves as a machine file asks for them
============= =======================================================================
"""
