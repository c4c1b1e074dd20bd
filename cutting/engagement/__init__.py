"""Where the teeth are in the material.

=============== ====================================================================
module          responsibility
=============== ====================================================================
immersion       entry and exit angles, cutting speed, removal rate
removed_section cross-section of what a tool removes
=============== ====================================================================
"""
