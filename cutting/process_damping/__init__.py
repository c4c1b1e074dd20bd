"""Process damping and contact: forces between the flank or the tool and the work.

========= ===========================================================================
module    responsibility
========= ===========================================================================
leaves    what the kernels call of a law
viscous   F_r = C (b/V) r_dot
ploughing the flank pressed into the wave that the edge has just cut (Wu 1989)
flank     what a process damping law is, and the list of them, one line each
contact   spring and damper between tool and work while in the cut
========= ===========================================================================
"""
