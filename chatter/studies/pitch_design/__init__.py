"""Pitch angles of a tool that raise its stability limits over a range of speeds.

============ =======================================================================
module       responsibility
============ =======================================================================
families     alternating and linear pitch, and the rule by which they cancel regeneration
pitch_search limits of pitch angles, families and free search
pitch_design `pitch`: families, search, ranking at finer speeds
pitch_result the result: tables, files
============ =======================================================================
"""
