"""Uncertain values, "1650 +- 80 MPa", and what they make of the limits of stability.

=========== ========================================================================
module      responsibility
=========== ========================================================================
parameters  values given with a standard deviation, and their distributions
sampling    Latin hypercubes
confidence  interval of a probability from a count
propagation limits of one sample
study       `uncertainty`: all samples, and the result
=========== ========================================================================
"""
