"""Bayesian learning from a few cutting tests: what they leave possible, and the next cut to make.

=============== ====================================================================
module          responsibility
=============== ====================================================================
cuts            tests from a CSV table or a measurement folder
records_of_cuts records of stable cuts beside a table of tests
stable_cuts     multipliers that the vibration of a stable cut shows
prior           values that are uncertain before any cut, and their distribution
likelihood      how likely verdicts, chatter frequencies and powers are
posterior       particles by tempering and Markov chains, brought up to date by each cut
diagram         margins of all particles over the diagram: probability of stability, limits
next_cut        the cut of most information, or of most metal within a risk
learn           `learn`: all of it, and the result
=============== ====================================================================
"""
