"""Cutting force on the edge.

======================== ==========================================================
module                   responsibility
======================== ==========================================================
law                      what a force law is; laws: the list of them, one line each
linear                   F = (K_c h + K_e) b
exponential              F = (K h0 (h/h0)^p + K_e) b
oblique                  the linear law of orthogonal cutting data, by the oblique transformation
directional_coefficients directional matrix and its exact averages
force_spectrum           Fourier series of the force over a revolution
======================== ==========================================================

A law is added by its module, which ends in a `ForceLawEntry`, and by its line in `laws`.
"""
