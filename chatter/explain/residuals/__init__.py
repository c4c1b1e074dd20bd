"""Where the residual of a measurement lives.

=============== ====================================================================
module          responsibility
=============== ====================================================================
left            what a case leaves of every run and channel, against its noise
finding         what a view found: a sentence, numbers, a panel
variables       what a residual may hang on, sample by sample
dependence      how much of it hangs on a variable, by runs that were not looked at
periods         periods in a variable
views           the views of every kind of measurement: where a new one joins
lead            free-form description of a residual that nothing known explains
=============== ====================================================================

The other modules hold one view each.
"""
