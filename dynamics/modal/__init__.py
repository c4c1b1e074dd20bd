"""Modal models at named points.

====== ===============================================================
module responsibility
====== ===============================================================
modes  modes of a structure, their receptance and lines that resolve it
====== ===============================================================
"""
