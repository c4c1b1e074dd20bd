"""Structures with fewer degrees of freedom.

================ ============================================================ ====================
module           responsibility                                               source
================ ============================================================ ====================
modal_truncation modes below a frequency, residual compliance, state space    Craig, Kurdila 2006
craig_bampton    super-elements with exact points, joined at points           Craig, Bampton 1968
imported_part    an imported structure, reduced, as a part of an assembly
================ ============================================================ ====================
"""
