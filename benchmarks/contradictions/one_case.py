"""One drawn case of a confrontation, judged."""

from __future__ import annotations

import time
from dataclasses import asdict, dataclass, field

import numpy as np

from benchmarks.contradictions.confrontation import Confrontation, Document, PremiseFailsError
from chatter.description.errors import InputError, RunError

#: what can come of a case, in the order of the table
OUTCOMES = ("agrees", "disagrees", "premise", "refused", "failed", "too long")


@dataclass
class Judged:
    """A drawn case and what came of it.

    Parameters
    ----------
    confrontation : str
    seed, number : int
        Both fix the case.
    outcome : str
        One of `OUTCOMES`: a premise that does not hold, and a case that is refused, are the
        product's own words; a failure is any other exception.
    reason : str
        In words, where there is no number.
    compared : list of dict
        Quantity, both numbers, what is allowed and the difference over it.
    seconds : float
    """

    confrontation: str
    seed: int
    number: int
    outcome: str
    reason: str = ""
    compared: list[dict] = field(default_factory=list)
    seconds: float = 0.0

    @property
    def key(self) -> tuple[str, int, int]:
        """What tells it from all others."""
        return self.confrontation, self.seed, self.number

    @property
    def is_finding(self) -> bool:
        """Whether a case file of it is written."""
        return self.outcome in ("disagrees", "failed", "too long")

    def as_dict(self) -> dict:
        """Content of its line in the file of results."""
        return asdict(self)


def drawn(confrontation: Confrontation, seed: int, number: int) -> Document:
    """Case of a number; it hangs on seed, confrontation and number alone."""
    words = [seed, number, *confrontation.name.encode()]
    return confrontation.draw(np.random.default_rng(words))


def judged(confrontation: Confrontation, seed: int, number: int) -> Judged:
    """Draw a case and put its ways against each other."""
    start = time.monotonic()
    found = Judged(confrontation.name, seed, number, "agrees")
    try:
        compared = confrontation.compare(drawn(confrontation, seed, number))
    except PremiseFailsError as error:
        found.outcome, found.reason = "premise", str(error)
    except (InputError, RunError) as error:
        found.outcome, found.reason = "refused", str(error)
    except Exception as error:  # a finding, whatever it is
        found.outcome, found.reason = "failed", f"{type(error).__name__}: {error}"
    else:
        found.compared = [{**asdict(one), "excess": one.excess} for one in compared]
        if not all(one.agrees for one in compared):
            found.outcome = "disagrees"
    found.seconds = time.monotonic() - start
    return found
