"""Criteria of the search for effects and of the verdict: every tuned number, with its reason.

Residuals are counted in standard deviations of the noise; a model that is right leaves 1.
"""

#: rms of the normalised residual up to which a channel is at its noise: of runs of a few thousand
#: samples the estimate of the noise itself scatters by some percent, and the prediction by other
#: numerics by up to half a percent of the signal
AT_NOISE = 1.12
#: rms below which nothing more is looked for: noise alone
NO_RESIDUAL = 1.0
#: fall of the sum of squares of holdout runs that is significant, and a share of their samples on
#: top: 20 times the log likelihood, as residuals beside a wrong model are not independent, and
#: half the variance by which other numerics may differ
LEAST_GAIN, LEAST_GAIN_SHARE = 40.0, 0.004
#: share of the residual above the noise that an effect must remove: what removes less of a misfit
#: stands for another effect
LEAST_SHARE = 0.05
#: effects that are added at the most: more are not told apart in a few dozen runs
MOST_EFFECTS = 3
#: candidates followed as the first, where the best does not lead near the noise: of two missing
#: effects neither may do well alone; and how near that is, rms
ALTERNATIVES, NEAR_NOISE = 2, 1.3
#: candidates that are fitted in full after the linearised step, which ranks the right one among the
#: first three in the blind sets; and those that are fitted again beside another effect
FITTED_IN_FULL, FITTED_AGAIN = 4, 3
#: starts of a candidate from which a second linearised step is made
FOLLOWED_STARTS = 2
#: sums of squares that differ by less do not rank: the log likelihood changes by one
EQUAL = 2.0
#: share of the gain of the best that a candidate may lack and still count as confounded with it
CONFOUNDED = 0.03
#: samples that count as one in the probability of a candidate, as neighbours are correlated: a
#: record at 12.8 kHz holds about that many a period of a mode at 640 Hz
CORRELATED_SAMPLES = 20.0
#: part of a signal's rms by which predictions of other numerics may differ
NUMERICS = 0.004
#: normalised residual of a run that a trial case cannot predict: worse than any that it can
IMPOSSIBLE = 1e3
#: noise that is assumed before the first fit, as a share of the signal
FIRST_NOISE = 0.03
#: times the noise by which predictions must differ for a discriminating test to be proposed
DISCRIMINATES = 2.0
