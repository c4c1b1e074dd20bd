"""Process damping and contact: forces between the flank or the tool and the work.

========= ===========================================================================
module    responsibility
========= ===========================================================================
law       what a process damping law is
viscous   F_r = C (b/V) r_dot
ploughing the flank pressed into the wave that the edge has just cut (Wu 1989)
flank     the list of the laws, one line each, and their leaves for the kernels
contact   spring and damper between tool and work while in the cut
========= ===========================================================================
"""
