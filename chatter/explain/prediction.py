"""Predictions of a case for every run, each made once."""

from collections import OrderedDict
from threading import Lock

from chatter.description.case import Case
from chatter.explain.kinds.kind import Kind, Signals
from chatter.explain.measurement import Run

#: memory of the predictions kept, bytes: a few dozen of a measurement of some megabytes
_MOST_BYTES = 256_000_000


class Predictions:
    """Predictions of a kind of measurement, kept by the content of the case and the run.

    A verdict asks for the same predictions several times: for errors, noise, residuals and reports.
    Parts of a run share the prediction of the whole. `made` counts those computed.
    """

    def __init__(self, kind: Kind) -> None:
        self.kind = kind
        self.made = 0
        self._kept: OrderedDict[tuple[Case, int], tuple[Run, Signals]] = OrderedDict()
        self._bytes = 0
        self._lock = Lock()

    def of(self, case: Case, run: Run) -> Signals:
        """Predicted signals at the samples of a run, by a case without its overrides.

        Raises InputError or RunError if the case cannot predict the run.
        """
        whole = run.whole or run
        own = whole.of(case)
        # a run with other weights is predicted alike
        key = (own, id(whole.signals))
        with self._lock:
            kept = self._kept.get(key)
            if kept is not None:
                self._kept.move_to_end(key)
        found = self.kind.predict(own, whole) if kept is None else kept[1]
        if kept is None:
            self._keep(key, whole, found)
        if run.part is None:
            return found
        return {channel: values[run.part] for channel, values in found.items()}

    def _keep(self, key: tuple[Case, int], whole: Run, found: Signals) -> None:
        with self._lock:
            self.made += 1
            if key in self._kept:
                return
            # with the run, whose signals the key tells by their identity
            self._kept[key] = whole, found
            self._bytes += _size(found)
            while self._bytes > _MOST_BYTES and len(self._kept) > 1:
                self._bytes -= _size(self._kept.popitem(last=False)[1][1])


def _size(signals: Signals) -> int:
    return sum(values.nbytes for values in signals.values())
