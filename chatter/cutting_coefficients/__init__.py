"""Cutting coefficients from the forces of a series of cuts.

================== ========================================================================
module             responsibility
================== ========================================================================
records_of_cuts    a measurement folder, or one file and its case
varied_cut         one cut that is varied, as a series of cuts
in_the_cut         what of a record is in the cut, and the offsets that the air shows
mean_forces        mean forces of records over whole revolutions, and how well they are known
laws               the laws that are tried: coefficients, and mean forces by the rigid cut
fit                least squares of a law to the mean forces of all cuts, signs of channels
identify           `coefficients`: the laws compared, the one to keep
revolution_average whole waveforms averaged over the revolution, the speed that they show
waveform_model     waveforms by a rigid tool with runout, as a dynamometer shows them
waveform_fit       least squares of the waveforms of all cuts together
waveform_choice    runout, law, offsets and resonances kept by evidence
waveforms          fits of waveforms compared, what is written of them
feed_series        cuts that differ by the feed alone, and what lies between their feeds
prediction         means and waveforms of a cut that was not fitted
predicted_cuts     each cut by the others, and those that are kept apart
oblique_fit        the oblique law, from the linear one and the rake
own_table          a row of the user's own table of materials
coefficient_units  units as they are written
result             what is written and drawn
================== ========================================================================
"""
