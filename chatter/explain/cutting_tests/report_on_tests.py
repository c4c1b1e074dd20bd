"""Verdict on cutting tests, with what was refitted and what the tests do not tell."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from chatter.description.case import Case
from chatter.explain.cutting_tests.limits import limits_over_time
from chatter.explain.cutting_tests.refitted import Refitted, in_words, refitted_values
from chatter.explain.cutting_tests.search_of_tests import SearchOfTests
from chatter.explain.selection.search import Search


class ReportOnTests:
    """What explanation.json says of cutting tests beside the entries of every kind."""

    def __init__(self, found: SearchOfTests) -> None:
        self.found = found

    @cached_property
    def refitted(self) -> list[Refitted]:
        """Declared values and what became of them beside the effects accepted."""
        return refitted_values(self.found.problem, self.found.final)

    @cached_property
    def words(self) -> list[str]:
        """Sentences on what was refitted, the residual, and which tool the updated case is."""
        found, sentences = self.found, [in_words(self.refitted)]
        if found.out_of_tolerance:
            sentences.append(
                "The tests move declared values further than their tolerances make likely, and "
                "no known effect explains it: measure these values again."
            )
        reliability = found.reliability
        sentences.append(
            f"Of {reliability.tests} tests, each predicted by a case fitted to others, "
            f"{reliability.right} are as predicted."
        )
        if not reliability.is_as_scatter:
            sentences.append("That is fewer than the scatter of limits allows: something is left.")
        if "wear" in found.effect_names:
            sentences.append("The updated case is the worn tool, as it is at the last test.")
        return sentences

    def summary(self, case: Case) -> dict[str, Any]:
        """Entries of explanation.json, with the limits of a case."""
        summary: dict[str, Any] = {
            "refitted": [one.summary() for one in self.refitted],
            "holdout_tests": self.found.reliability.summary(),
            "remarks": self.words,
        }
        limits = limits_over_time(self.found.measurement, case)
        if limits is not None:
            summary["limits"] = limits
        return summary


def entries_on_tests(found: Search, case: Case) -> dict[str, Any]:
    """Entries of explanation.json on cutting tests; none of another kind of measurement."""
    return ReportOnTests(found).summary(case) if isinstance(found, SearchOfTests) else {}
