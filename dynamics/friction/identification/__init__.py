"""Inertia and friction of an axis from records of its drive.

============== ======================================================================
module         responsibility
============== ======================================================================
record         motion and effort of one axis, its checks; effort from the motor current
filtering      one low-pass for every signal; smoothed derivative and its noise
intervals      confidence intervals with residuals that are not white
least_squares  inertia, viscous and Coulomb friction by linear least squares
first_guess    starting values of a friction law from the linear fit and a reversal
law_fit        nonlinear least squares over named parameters
dynamic_fit    a whole law fitted along the measured motion
steady_state   friction curve of moves at constant speed
shares         rotational and translational shares of friction about the motor
============== ======================================================================
"""

from dynamics.friction.identification.dynamic_fit import (
    AxisFit,
    AxisModel,
    fit_axis,
    friction_along,
    friction_over_position,
    relative_error,
)
from dynamics.friction.identification.filtering import Derivative, LowPass, smoothed_derivative
from dynamics.friction.identification.first_guess import (
    guess_coulomb_stribeck,
    guess_lugre,
    guess_tanh,
    reversal_way,
)
from dynamics.friction.identification.intervals import Estimate
from dynamics.friction.identification.least_squares import TERMS, LinearFriction, fit_linear
from dynamics.friction.identification.record import DriveRecord, record_from_current
from dynamics.friction.identification.shares import referred_to_slide, share_of, split_about_shaft
from dynamics.friction.identification.steady_state import (
    SteadyFit,
    SteadyPoint,
    constant_speed_points,
    fit_steady_state,
)

__all__ = [
    "TERMS",
    "AxisFit",
    "AxisModel",
    "Derivative",
    "DriveRecord",
    "Estimate",
    "LinearFriction",
    "LowPass",
    "SteadyFit",
    "SteadyPoint",
    "constant_speed_points",
    "fit_axis",
    "fit_linear",
    "fit_steady_state",
    "friction_along",
    "friction_over_position",
    "guess_coulomb_stribeck",
    "guess_lugre",
    "guess_tanh",
    "record_from_current",
    "referred_to_slide",
    "relative_error",
    "reversal_way",
    "share_of",
    "smoothed_derivative",
    "split_about_shaft",
]
