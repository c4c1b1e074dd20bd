"""Selection of effects: candidates, and the search that adds them one by one.

=================== ================================================================
module              responsibility
=================== ================================================================
problem             a measurement as a least-squares problem
split               runs fitted, and runs held out
evidence            evidence of a model by Laplace's and Whittle's approximations
significance        whether a candidate gains more than chance gives
candidates          effects tried on top of others
cheaper_runs        candidates screened by the runs that cost little to predict
joint_steps         pairs that may pay together though neither does alone
other_starts        fits that begin elsewhere, where much is left
path                effects added one by one or in pairs, and tried again
established         which effects are certain though something is left, and which are none
search              which effects are added
discriminating_test measurements in which explanations that fit alike differ
=================== ================================================================
"""
