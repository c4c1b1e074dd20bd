"""Random sections of case files, over what users have.

========== =========================================================================
module     responsibility
========== =========================================================================
quantities numbers with units, log-uniform and chosen
tool       every kind of tool, pitch, helix by flute, runout, setting errors, serration
material   every law, edge terms, rows of the table
cut        engagement from 1 % to the slot, speeds, feeds, varying speed
structure  modes on either side and along any direction, process damping
========== =========================================================================
"""
