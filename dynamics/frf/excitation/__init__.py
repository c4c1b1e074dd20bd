"""Excitation of machines, virtual or real, and FRFs estimated from tests in time.

=============== ============================================================ ==================
module          responsibility                                               source
=============== ============================================================ ==================
signal          periodic signals and trains of pulses at the step
hammer          blows of half a sine or constant force, one or several
chirp           sine chirps, linear and logarithmic
multisine       harmonics of one period, random or Schroeder phases          Schroeder 1970
angle_triggered pulses of torque released at an angle of the spindle
holds           what lies between samples, and its effect on an FRF          Astrom 1997
segments        spectra averaged over blows, periods, realisations
transient       FRF of transients that die away                              Bendat 2010
periodic        FRF and variances over periods and realisations              Pintelon 2012
closed_loop     FRF inside a control loop from an injected reference         Wellstead 1981
=============== ============================================================ ==================
"""

from dynamics.frf.excitation.angle_triggered import (
    angle_at_constant_speed,
    angle_triggered_pulses,
    passages,
)
from dynamics.frf.excitation.chirp import linear_chirp, logarithmic_chirp
from dynamics.frf.excitation.closed_loop import joint_input_output_frf
from dynamics.frf.excitation.hammer import (
    constant_blow,
    half_sine_blow,
    half_sine_blow_of_impulse,
    several_blows,
)
from dynamics.frf.excitation.holds import (
    BAND_LIMITED,
    FIRST_ORDER_HOLD,
    ZERO_ORDER_HOLD,
    Hold,
    without_hold,
    without_images,
)
from dynamics.frf.excitation.multisine import (
    full_lines,
    multisine,
    odd_lines,
    random_phases,
    schroeder_phases,
)
from dynamics.frf.excitation.periodic import (
    PeriodicFrf,
    PeriodicRecord,
    direct_frf,
    frf_of_periods,
    without_drift,
)
from dynamics.frf.excitation.signal import ExcitationError, PeriodicSignal, PulseTrain, pulses_at
from dynamics.frf.excitation.transient import cut_at_pulses, frf_of_transients

__all__ = [
    "BAND_LIMITED",
    "FIRST_ORDER_HOLD",
    "ZERO_ORDER_HOLD",
    "ExcitationError",
    "Hold",
    "PeriodicFrf",
    "PeriodicRecord",
    "PeriodicSignal",
    "PulseTrain",
    "angle_at_constant_speed",
    "angle_triggered_pulses",
    "constant_blow",
    "cut_at_pulses",
    "direct_frf",
    "frf_of_periods",
    "frf_of_transients",
    "full_lines",
    "half_sine_blow",
    "half_sine_blow_of_impulse",
    "joint_input_output_frf",
    "linear_chirp",
    "logarithmic_chirp",
    "multisine",
    "odd_lines",
    "passages",
    "pulses_at",
    "random_phases",
    "schroeder_phases",
    "several_blows",
    "without_drift",
    "without_hold",
    "without_images",
]
