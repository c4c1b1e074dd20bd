"""Friction of a drive from records of its moves.

============= ======================================================================
module        responsibility
============= ======================================================================
drive_columns what the columns of a file are: position, velocity, effort; motor or slide
drive_records files and measurement folders -> records in the units of one motion
friction_laws the laws that are tried, and how each is fitted and predicts
identify      laws compared on moves held out, the one to keep
result        table, [friction.NAME], picture
============= ======================================================================
"""
