"""Terms learnt from a residual that no known effect explains.

term        a table over a physical variable whose entries are fitted
candidates  terms that a kind of measurement may have, from coarse to fine
learning    those that holdout runs ask for, and their errors before and after
"""
