"""Where the teeth are in the material.

=============== ====================================================================
module          responsibility
=============== ====================================================================
immersion       entry and exit angles, cutting speed, removal rate, section removed
inclined_tool   uncut work about a tool whose axis is inclined
=============== ====================================================================
"""
