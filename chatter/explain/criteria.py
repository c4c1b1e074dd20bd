"""Criteria of the search for effects and of the verdict: every tuned number, with its reason.

Residuals are counted in standard deviations of the noise; a model that is right leaves 1.
"""

#: rms of the normalised residual up to which a channel is at its noise: of runs of a few thousand
#: samples the estimate of the noise itself scatters by some percent, and the prediction by other
#: numerics by up to half a percent of the signal
AT_NOISE = 1.12
#: the same of holdout runs by a fit to the others, whose values are uncertain as well: of 43
#: explanations that were right the most was 1.3, of a wrong one 4.7
HOLDOUT_AT_NOISE = 1.5
#: rms below which nothing more is looked for: noise alone
NO_RESIDUAL = 1.0
#: fall of the sum of squares of holdout runs that is significant, and a share of their samples on
#: top: 20 times the log likelihood, as residuals beside a wrong model are not independent, and
#: half the variance by which other numerics may differ
LEAST_GAIN, LEAST_GAIN_SHARE = 40.0, 0.004
#: the same share for an effect beside others: a change of a tenth of the noise, which is no more
#: than what a refit of the others leaves by chance
LEAST_GAIN_SHARE_BESIDE = 0.01
#: the same share of FRFs: a structure is not so exactly a sum of modes, nor a hammer so exact, that
#: a fifth of the scatter, seen over thousands of lines, would be an effect
LEAST_GAIN_SHARE_OF_FRFS = 0.05
#: logarithm of the evidence, over that without it, from which on an effect is added, and from which
#: on it is beyond doubt though something else is left: odds of 400 and of 20000, as some twenty
#: effects are tried
LEAST_EVIDENCE, CERTAIN_EVIDENCE = 6.0, 10.0
#: share of the misfit above the noise that an effect beyond doubt takes away where something else
#: is left: effects that stood for others of the unlisted took away a fifth at the most
LEAST_SHARE_IN_PART = 0.15
#: the same of FRFs, where a mode stood for a third of what a delay of the sensor does
LEAST_SHARE_IN_PART_OF_FRFS = 0.4
#: the same of all effects together where declared values leave their tolerances beside them: what
#: draws a value makes an effect as well; those of the unlisted took away three quarters at the most
LEAST_SHARE_OUT_OF_TOLERANCE = 0.9
#: sum of squares of holdout runs over that without an effect, from which on it is not one
MOST_LOST = 1.02
#: level of the signed-rank test of the runs that gain by such an effect against those that lose
SIGNED_RANK_LEVEL = 0.0625
#: standard deviations of its declared value beyond which a refitted one is out of its tolerance
OUT_OF_TOLERANCE = 3.0
#: standard deviations within which a declared value of a cut is refitted: far enough out of its
#: tolerance to be seen there, and not so far that a mode takes the place of one that is missing
REFITTED_WITHIN = 6.0
#: probability at which an interval of an effect that reaches nothing makes it none
REACHES_NOTHING = 0.95
#: standard deviation, in sizes, from which on a combination of parameters is not determined: half
#: of what holds those that nothing else does
UNDETERMINED = 15.0
#: share of the residual above the noise that an effect must remove: what removes less of a misfit
#: stands for another effect
LEAST_SHARE = 0.05
#: effects that are added at the most: more are not told apart in a few dozen runs
MOST_EFFECTS = 3
#: rms above which pairs of candidates are tried: of two missing effects neither may do well alone
NEAR_NOISE = 1.3
#: candidates that are fitted in full after the linearised step, which ranks the right one among the
#: first three in the blind sets; and those that are fitted again beside another effect
FITTED_IN_FULL, FITTED_AGAIN = 4, 3
#: candidates of which pairs are fitted jointly where effects added one by one leave a misfit
PAIRED = 4
#: cost of the simplest member of a family over that of the best up to which it is tried alone
SIMPLE_ENOUGH = 1.02
#: share of the significant gain that linearised steps must promise for a fit in full: they err by
#: less than a factor of four where they are of any use
PROMISING = 0.25
#: share of the best gain of candidates fitted roughly from which on one is fitted in full: a rough
#: fit ends short of the minimum by less
FINISHED = 0.5
#: starts of a candidate of which a linearised step is made at the most, ranked by one prediction
SCREENED_STARTS = 4
#: starts of a candidate from which a second linearised step is made
FOLLOWED_STARTS = 2
#: logarithms of evidence that differ by less do not rank
EQUAL = 1.0
#: share of the gain of the best that a candidate may lack and still count as confounded with it
CONFOUNDED = 0.03
#: the highest probability that is stated: numerics and laws of the model are no better known
MOST_PROBABLE = 0.999
#: the same of an effect that helps beside something unexplained and is not established: what is
#: unknown does all that it does. Of 13 such in a survey none was in the data, which is (0 + 1) of
#: (13 + 2) by the rule of succession (Laplace 1774); in the next two surveys none of 40 was
MOST_PROBABLE_BESIDE_UNKNOWN = 0.07
#: part of a signal's rms by which predictions of other numerics may differ
NUMERICS = 0.004
#: the same of an acceleration, of which the top of the band is most: filter and numerics differ
#: there most
NUMERICS_OF_ACCELERATION = 0.008
#: the same of a settled record on top of that of any signal: speed, start angle and the edge of the
#: filter are estimated too, which left half a percent in two sets that were explained otherwise
NUMERICS_OF_SETTLED = 0.005
#: normalised residual of a run that a trial case cannot predict: worse than any that it can
IMPOSSIBLE = 1e3
#: noise that is assumed before the first fit, as a share of the signal
FIRST_NOISE = 0.03
#: times the noise by which predictions must differ for a discriminating test to be proposed
DISCRIMINATES = 2.0
#: lines of a periodogram over which its mean is the spectrum of a residual: few enough that what
#: is left at one line does not hide what is lost beside it
SMOOTHED_LINES = 5
#: the same of harmonics of what repeats: those of two or three teeth, with runout between them, so
#: that no single small one decides against much that is gained beside it
SMOOTHED_HARMONICS = 7
#: empirical terms that are learnt at the most, and candidates of each that are fitted in full
MOST_TERMS, LEARNT_IN_FULL = 2, 2
