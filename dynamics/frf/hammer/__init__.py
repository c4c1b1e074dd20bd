"""Hammer tests: time records of blows to one frequency response function.

=============== ====================================================================== ============
module          responsibility                                                         source
=============== ====================================================================== ============
record          the record of one blow
hit             where the blow lies; rest level and noise of the channels
findings        what the examination reports
force_checks    force by itself: cut, second blow, dropouts, drift
response_checks response by itself: too early, no answer, drift
channel_checks  either channel: stuck, clipped, dropouts
consensus       which records agree; the function they share
comparison      one record against the prediction of the others
judgement       gain, polarity, timing, bumps and coherence against the others
naming          the fault and its evidence in words
examine         all of it for a set
windows         force, response and exponential windows                                Fladung 1997
spectra         averaged spectra, H1, H2, coherence, usable band                       Bendat 2010
result          the examined and averaged set
=============== ====================================================================== ============
"""

from dynamics.frf.hammer.examine import examine_records
from dynamics.frf.hammer.findings import Finding
from dynamics.frf.hammer.record import HammerRecord
from dynamics.frf.hammer.result import HammerTest, hammer_test
from dynamics.frf.hammer.spectra import (
    Spectra,
    averaged_spectra,
    coherence,
    frf_from_records,
    h1,
    h2,
    usable_band,
)

__all__ = [
    "Finding",
    "HammerRecord",
    "HammerTest",
    "Spectra",
    "averaged_spectra",
    "coherence",
    "examine_records",
    "frf_from_records",
    "h1",
    "h2",
    "hammer_test",
    "usable_band",
]
