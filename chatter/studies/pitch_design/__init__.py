"""Pitch angles for a range of speeds.

================== ===================================================================
module             responsibility
================== ===================================================================
families           alternating and linear pitch; the rule that says which cancels regeneration
search             families and then all angles, by the limits of collocation
study              `pitch`: all of it, one after the other
result             what is found: tables, files
================== ===================================================================
"""
