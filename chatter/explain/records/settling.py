"""Runs so near to their stability limit that their records need not show the settled cut.

At the limit transients last longer than a record and hardly change within it, and small differences
of the case are large ones of the settled cut.
"""

from collections.abc import Sequence
from typing import NamedTuple

from chatter.description.case import Case
from chatter.explain.data_checks.finding import RUN, SignalFinding
from chatter.explain.measurement import Measurement
from chatter.explain.records.steady_cut import change_left
from chatter.explain.records.steady_record import SteadyRecord

#: change, over the signal, that is left when a record ends, from which it need not have settled: as
#: much as the noise of a good record
_LEFT = 0.01
#: revolutions from rest after which a run is near its limit that has so large a change left: near
#: it, cuts that have settled can be two, the one from rest and the one that was entered slowly
_NEAR, _LEFT_NEAR = 20, 0.1


class Settling(NamedTuple):
    """A run and the cut in its record."""

    name: str
    case: Case  # with the overrides of the run
    revolutions: int  # of the cut in the record

    @property
    def reason(self) -> str:
        """Why the record need not show the settled cut from rest; empty where it does.

        A transient from rest would outlast the record, or dies out so slowly that another settled
        cut may be beside that from rest.
        """
        if change_left(self.case, self.revolutions) > _LEFT:
            return (
                f"does not settle within the {self.revolutions} revolutions of the record: whether "
                "it had settled cannot be told"
            )
        if change_left(self.case, _NEAR) > _LEFT_NEAR:
            return "may settle otherwise after another entry: which cut it shows cannot be told"
        return ""


def too_slow(runs: Sequence[Settling], model: str) -> list[SignalFinding]:
    """Runs that do not settle within their records by a model, unless these are half of all."""
    reasons = {one.name: reason for one in runs if (reason := one.reason)}
    if 2 * len(reasons) >= len(runs):
        return []
    near = f"by the {model} case the cut is so near to its stability limit that it"
    return [
        SignalFinding(RUN, name, "", f"{name}: {near} {reason}") for name, reason in reasons.items()
    ]


def without_too_slow(
    measurement: Measurement, case: Case, model: str
) -> tuple[Measurement, list[SignalFinding]]:
    """Leave out the runs that do not settle within their records by a case that was found."""
    records = [run for run in measurement.runs if isinstance(run.record, SteadyRecord)]
    found = too_slow(
        [Settling(run.name, run.of(case), run.record.revolutions_recorded) for run in records],
        model,
    )
    slow = {one.run for one in found}
    return measurement.with_runs([one for one in measurement.runs if one.name not in slow]), found
