"""Frequency response functions: container, tests that measure them.

========== =========================================================================
module     responsibility
========== =========================================================================
container  measured or computed functions; quantities, common lines, added decay
excitation signals that excite, and FRFs estimated from tests in time
hammer     hammer records examined and averaged
========== =========================================================================
"""
