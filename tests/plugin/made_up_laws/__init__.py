"""A package that adds one of each: what a package of yours may look like.

================= ===========================================================================
module            what it adds
================= ===========================================================================
force_law         `root`: a force that grows with the root of the chip thickness
friction_law      `arctan-coulomb`: Coulomb friction smoothed by an arc tangent
stability_method  `cautious-zero-order`: zeroth-order limits less a margin
effect            `tilted_guide`: the weight of a slide on a guide that is not level
file_format       `labbook`: columns of numbers below names and units
================= ===========================================================================
"""
