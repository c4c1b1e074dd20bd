"""Closing the loop: what a measurement says that the declared case lacks.

The package is called as a function too: ``chatter.explain(folder)`` is
`chatter.explain.explanation.explain`.

=================== ================================================================
module              responsibility
=================== ================================================================
measurement         runs with their signals, and the declared case
measurement_file    measurement folders
criteria            every tuned number of the search and the verdict, with its reason
fitting             least squares with priors, which declared values have
residuals           residual diagnostics
data_checks         checks of the signals before anything is blamed on physics
kinds               milling, axis, stability, frf: predictions, nuisance parameters
checking            the checks of a kind, and the exclusion of what they find
prediction          predictions of a case for every run, each made once
effects             what a case may lack, each a patch of it
selection           candidates, search, discriminating tests
errors              errors of predictions, before and after
reported_effects    numbers, intervals and probability of an effect
lobes_before_after  stability lobes before and after
stability_margin    how far cutting tests are from the limit
tests_side_by_side  dominant multipliers of tests that share a tool, solved together
cutting_tests       search, verdict and limits of cutting tests
verdict             explained, in part, nothing missing or unexplained
contradiction       what is said of data that contradict themselves or their case
explanation         `explain`: effects and errors; files
comparison          `compare`: errors of the declared case
=================== ================================================================
"""

import sys
from types import ModuleType
from typing import Any


class _CallablePackage(ModuleType):
    """Package that is the call of its name: whatever was imported before, `chatter.explain` is it.

    Importing any module below sets the attribute ``chatter.explain`` to the package, so that no
    function can stand there under this name.
    """

    def __call__(self, *args: Any, **options: Any) -> Any:
        """Find out what the declared case of a measurement lacks; see `explanation.explain`."""
        from chatter.explain.explanation import explain

        return explain(*args, **options)


sys.modules[__name__].__class__ = _CallablePackage
