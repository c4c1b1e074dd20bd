"""What some sixty cases give: stored numbers that a change of the code must not move.

============= ===========================================================================
module        responsibility
============= ===========================================================================
cases         the cases: `cases.toml` and the case and machine files beside it
results       case and call -> numbers; the one place that knows names in results
store         `numbers.toml`: stored values with their tolerances; comparison
update        command that stores new values, with the reason of the change
============= ===========================================================================
"""
