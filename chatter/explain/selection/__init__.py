"""Selection of effects: candidates, and the search that adds them one by one.

=================== ================================================================
module              responsibility
=================== ================================================================
problem             a measurement as a least-squares problem
candidates          effects tried on top of others, judged on holdout runs
search              which effects are added
discriminating_test measurements in which explanations that fit alike differ
=================== ================================================================
"""
