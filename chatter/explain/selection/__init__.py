"""Selection of effects: fits, candidates, and the search that adds them one by one.

=================== ================================================================
module              responsibility
=================== ================================================================
criteria            every tuned number of the search and the verdict, with its reason
prior               standard deviations of declared values
fitting             least squares with priors
problem             a measurement as a least-squares problem
candidates          effects tried on top of others, judged on holdout runs
search              which effects are added
discriminating_test measurements in which explanations that fit alike differ
=================== ================================================================
"""
