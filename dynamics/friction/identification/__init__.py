"""Inertia and friction of an axis from records of its drive.

============== ======================================================================
module         responsibility
============== ======================================================================
record         motion and effort of one axis, its checks; effort from the motor current
filtering      one low-pass for every signal
intervals      confidence intervals with residuals that are not white
linear_fit     inertia, viscous and Coulomb friction by linear least squares
first_guess    starting values of a friction law from the linear fit and a reversal
law_fit        nonlinear least squares over named parameters
dynamic_fit    a whole law fitted along the measured motion
steady_state   friction curve of moves at constant speed
============== ======================================================================
"""
