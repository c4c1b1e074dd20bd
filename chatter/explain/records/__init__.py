"""Records as they come off a rig: what is not told about them is estimated.

=================== ================================================================
module              responsibility
=================== ================================================================
description         [record] and [channels] of measurement.toml
case_axes           channels turned into the axes of the case
spindle             speed by the tacho or by what repeats
stages              air, entry, cut and exit; the settled part
steady_cut          revolution of a settled cut, by the time-domain engine
alignment           start angle, speed, offsets, drifts and filter of a prediction
anti_alias_filter   order of the filter, by all the records together
orientation         directions and signs that are not told
slow_channels       spindle power and torques of drives
steady_record       what a run needs to be predicted in its settled part
settling            runs so near to their limit that they need not have settled
recognition         from runs as read to runs that can be judged
=================== ================================================================
"""
