"""Tool, holder and spindle put together: the response at the tool point at any stick-out.

============== ==============================================================================
module         responsibility
============== ==============================================================================
library        tools, holders and spindles: format of a library, the shipped one
catalogue      rows of a maker's catalogue (CSV) as entries of a library
assembly_file  the file that says what is put together
line           entries as stepped lines of round sections
spindle        what holds the holder: a modelled spindle, or a measured one by inverse coupling
tool_point     receptance and modes at the tool point for each stick-out
assemble       `assemble`: all of it, lobes over the stick-out, and the result
============== ==============================================================================
"""
