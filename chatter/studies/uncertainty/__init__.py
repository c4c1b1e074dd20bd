"""Uncertain values, "1650 +- 80 MPa", and what they make of the limits of stability.

==================== ===============================================================
module               responsibility
==================== ===============================================================
uncertain_parameters values given with a standard deviation, and their distributions
latin_hypercube      samples of them (McKay, Beckman and Conover 1979)
sample_limits        limits of one sample
monte_carlo          `uncertainty`: all samples, and the result
==================== ===============================================================
"""
