"""Closing the loop: what a measurement says that the declared case lacks.

=============== ====================================================================
module          responsibility
=============== ====================================================================
measurement     measurement folders: runs, signals in SI, declared case
tables          signals from CSV, NPZ, TDMS, universal files
headings        names and units of columns
columns         columns that a kind needs
signals         checks of the signals before anything is blamed on physics
unusable        verdict where the data and the declared case plainly contradict each other
kinds           milling, axis, stability, frf: predictions and uncertain values
effects         what a case may lack, each a patch
tolerance       how far declared values may be off
fitting         least squares with priors
noise           noise floor of signals
problem         a measurement as a least-squares problem
search          candidates fitted on some runs, judged on others
separation      measurements that would tell apart what fits alike
signature       where the residual lives
explanation     verdict, effects, errors; files
report          report.html
comparison      `compare`: errors of the declared case
=============== ====================================================================
"""
