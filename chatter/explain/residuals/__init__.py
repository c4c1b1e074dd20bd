"""Where the residual of a measurement lives.

=================== ================================================================
module              responsibility
=================== ================================================================
channel_residual    residual of one channel of one run, against its noise
residual            residual of a measurement
noise               level of white noise beneath lines
variables           what a residual may depend on: variables, forms, conditions
finding             what a diagnostic found: a sentence, numbers, a panel
dependence          share of a residual that depends on a variable, by holdout runs
periods             periods in a variable
ranks               rank correlation over runs
regression          dependence on a variable or a period in the form that suits best
by_channel          diagnostic: residual by run and channel
spectrum, harmonics diagnostic: frequency
over_variable       diagnostics: one variable, and periods in it
over_runs           diagnostic: trend over the runs
over_time           diagnostic: within a run
over_lines          diagnostics of FRFs
misclassified_tests diagnostics of cutting tests
signature           all diagnostics of a kind of measurement
residual_dependence on what a residual that no effect explains depends most
=================== ================================================================
"""
