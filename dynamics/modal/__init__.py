"""Modal models at named points.

=============== =================================================================
module          responsibility
=============== =================================================================
modes           modes of a structure and their receptance
frequency_lines lines over frequency that resolve the resonances
mode_tracking   modes of a structure over a parameter, each followed by its shape
=============== =================================================================
"""
