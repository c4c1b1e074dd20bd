"""Order of the filter before the converter, told by how a case fits all the records together."""

from collections.abc import Sequence

from chatter.description.case import Case
from chatter.explain.measurement import Run
from chatter.explain.records.alignment import ORDERS

#: share of the misfit that another order must take away: less is as well explained by the case
_LEAST_GAIN = 0.05


def order_of_filter(runs: Sequence[Run], case: Case) -> int:
    """Order of the filter by which a case fits the settled records of runs best.

    One converter makes all the records of a measurement. Corner frequency, start angle and offsets
    are found anew for each order.
    """
    now = runs[0].record.filter_order
    of_runs = [run.record.misfits(run.of(case), ORDERS) for run in runs]
    misfit = {order: sum(one[order] for one in of_runs) for order in ORDERS}
    best = min(misfit, key=lambda order: misfit[order])
    return now if misfit[best] > (1.0 - _LEAST_GAIN) * misfit[now] else best
