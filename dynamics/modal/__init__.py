"""Modal models at named points.

=============== =================================================================
module          responsibility
=============== =================================================================
modes           modes of a structure, their receptance and lines that resolve it
mode_tracking   modes of a structure over a parameter, each followed by its shape
=============== =================================================================
"""
