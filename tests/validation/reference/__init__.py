"""Independent reference solutions for the tests; shares no code with the packages under test.

========== ===========================================================================
module     what
========== ===========================================================================
milling    milling multipliers by multi-interval Chebyshev collocation of the period
turning    exact lobes and growth of autonomous cases by the characteristic equation
cases      random milling cases and their case files
========== ===========================================================================
"""
