"""Chatter in recordings of cuts, and what to do about it.

============== ============================================================================
module         responsibility
============== ============================================================================
recording_file channels of a file of any format: which are of use, what they are of
detect         `detect`: verdicts over a recording, advice
advice         speeds that a chatter frequency proposes, or that a case has as stable
result         what is written and drawn
growing_file   samples of a file that is still being written
follow         such a file: a verdict every revolution
============== ============================================================================
"""
