"""Cutting coefficients from the forces of a series of cuts.

============ ==============================================================================
module       responsibility
============ ==============================================================================
mean_forces  mean forces of records over whole revolutions, and how well they are known
laws         the laws that are tried: coefficients, and mean forces by the rigid cut
fit          least squares of a law to the mean forces of all cuts, signs of channels
identify     `coefficients`: the laws compared, the one to keep
result       what is written and drawn
============ ==============================================================================
"""
