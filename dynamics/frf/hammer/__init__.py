"""Hammer tests: time records of blows to one frequency response function.

================= ==================================================================== ===========
module            responsibility                                                       source
================= ==================================================================== ===========
record            the record of one blow
hit               where the blow lies; rest level and noise of the channels
force_checks      force by itself: cut, second blow, dropouts, drift
response_checks   response by itself: too early, no answer, drift
channel_checks    either channel: stuck, clipped, dropouts
consensus         which records agree; the function they share
comparison        one record against the prediction of the others
record_comparison gain, polarity, timing, bumps and coherence against the others
naming            the fault and its evidence in words
examine           all of it for a set
windows           force, response and exponential windows                              Fladung 1997
spectra           averaged spectra, H1, H2, coherence, usable band                     Bendat 2010
averaging         the examined and averaged set
================= ==================================================================== ===========
"""
