"""Chatter detection: whether the signals of a cut are stable, and what its motion is.

================== ===================================================================
module             responsibility
================== ===================================================================
cut_record         `CutRecord`: signals with the angle of the spindle, checked
poincare_sections  signals over the spindle angle, whole periods, once-per-revolution samples
deviations         differences between periods, noise removed, their growth rate
chatter_frequency  argument of the multiplier and chatter frequency
bifurcation_type   Hopf, flip or period-n
chatter_detection  `detect_chatter`; period doubled while the runout is not known
================== ===================================================================
"""
