"""Examination of hammer records: faults found and good records lost, on sets made for it."""

import contextlib
import io

from benchmarks.figures.figure import Figure, Reached
from benchmarks.hammer_examination import CONDITIONS, study

#: sets of each condition; the seed is of this figure alone, nothing was tuned by it
_SETS, _SEED = 10, 20261127


def _examined() -> Reached:
    with contextlib.redirect_stdout(io.StringIO()):
        each = [study(_SETS, _SEED, condition) for condition in CONDITIONS.values()]
    found, faulty, lost, good = (sum(one) for one in zip(*each, strict=True))
    told = f"{found} of {faulty} faults found, {lost} of {good} good records lost"
    return Reached(faulty - found + lost, told)


FIGURES = (
    Figure("hammer", "hammer records judged wrong, 30 generated sets", 0.0, "records", _examined),
)
