"""Excitation of machines, virtual or real, and FRFs estimated from tests in time.

=============== ============================================================ ==================
module          responsibility                                               source
=============== ============================================================ ==================
signal          periodic signals and trains of pulses at the step
hammer          blows of half a sine, one or several
chirp           sine chirps
multisine       harmonics of one period, random or Schroeder phases          Schroeder 1970
angle_triggered pulses of torque released at an angle of the spindle
holds           what lies between samples, and its effect on an FRF          Astrom 1997
segments        spectra averaged over blows, periods, realisations
transient       FRF of transients that die away                              Bendat 2010
periodic        FRF and variances over periods and realisations; FRF inside  Pintelon 2012
                a control loop from an injected reference                    Wellstead 1981
=============== ============================================================ ==================
"""
