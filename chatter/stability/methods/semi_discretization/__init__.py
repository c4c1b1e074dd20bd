"""Semi-discretization and full discretization of uniform-pitch cylindrical end mills.

================  ==============================================================================
module            responsibility
================  ==============================================================================
arrays            what the kernels see of a cut
first_order_step  exact step with linear delayed motion (Insperger and Stepan 2004)
step_schemes      the other orders, and full discretization (Ding et al. 2010)
monodromy         the operator over one tooth period
drivers           compiled loops that Python calls
multipliers       multipliers, limits and chatter frequencies
================  ==============================================================================
"""
