"""Where the residual of a measurement lives.

=================== ================================================================
module              responsibility
=================== ================================================================
channel_residual    residual of one channel of one run, against its noise; level of white noise
residual            residual of a measurement
variables           what a residual may depend on: variables, forms, conditions
finding             what a diagnostic found: a sentence, numbers, a panel
dependence          share of a residual that depends on a variable, by holdout runs
periods             periods in a variable
regression          dependence on a variable or a period in the form that suits best
by_channel          diagnostics: by run and channel, and within a run
spectrum            diagnostic: frequency; harmonics of the spindle and what lies between
over_variable       diagnostics: one variable, and periods in it
over_runs           diagnostic: trend over the runs
over_lines          diagnostics of FRFs
misclassified_tests diagnostics of cutting tests
signature           all diagnostics of a kind of measurement
residual_dependence on what a residual that no effect explains depends most
=================== ================================================================
"""
