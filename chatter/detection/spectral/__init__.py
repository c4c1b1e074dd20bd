"""Chatter or not from the spectra of a recording: sound, acceleration, force, current or power.

==================== =========================================================================
module               responsibility
==================== =========================================================================
recording            `Recording`: channels over time, what they are of
spectra              power spectra of short frames, their noise floor
revolution_frequency frequency of the spindle by the spacing of lines, or by a tacho
stated_speed         whether the lines speak for another speed than the stated one
chatter_lines        the strongest line off the harmonics: its share, its sidebands
activity             frames in which nothing is cut
frame_evidence       all of this over the frames of a recording
envelope             whether a line is a limit cycle or a mode that noise shakes
steady_family        whether a small line is steady, with sidebands at the teeth
line_of_cut          whether a line is that of a cut that chatters, or of the machine
sideband_family      chatter whose own sidebands show the speed that it is judged by
segments             segments of one verdict, their frequency, bifurcation and confidence
two_speeds           the same where the lines speak for another speed than the stated one
overload             samples at the ends of a recorder's range
running_detection    a verdict every revolution while a recording goes on
==================== =========================================================================
"""
