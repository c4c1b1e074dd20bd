"""Predictions of a case for every run, each made once."""

from collections import OrderedDict
from collections.abc import Mapping
from pathlib import Path
from threading import Lock
from typing import Any

from chatter.description.case import Case
from chatter.explain.kinds.kind import Kind, Signals
from chatter.explain.kinds.same_case import OfSameCase
from chatter.explain.measurement import Measurement, Run
from chatter.studies.kept_arrays import KeptArrays, digest_of
from chatter.studies.model import fingerprint

#: memory of the predictions kept, bytes: two dozen of a measurement of some megabytes
_MOST_BYTES = 96_000_000
#: contents of cases that are kept
_MOST_CONTENTS = 48


class Predictions:
    """Predictions of a kind of measurement, kept by the content of the case and the run.

    A verdict asks for the same predictions several times: for errors, noise, residuals and reports.
    Parts of a run share the prediction of the whole. `made` counts those computed or read.

    Parameters
    ----------
    kind : Kind
    kept : KeptArrays, optional
        Where they are kept on disk, so that a search that was ended goes on.
    """

    def __init__(self, kind: Kind, kept: KeptArrays | None = None) -> None:
        self.kept = kept or KeptArrays(None)
        self.kind = kind.keeping(self.kept)
        self._digests: dict[int, tuple[Run, str]] = {}
        self.made = 0
        self._kept: OrderedDict[tuple[str, int, str], tuple[Run, Signals]] = OrderedDict()
        self._bytes = 0
        self._lock = Lock()
        self._coarse: dict[int, tuple[Run, Mapping[str, Any]]] = {}
        self._contents: OfSameCase[str] = OfSameCase(_MOST_CONTENTS)

    def of(self, case: Case, run: Run) -> Signals:
        """Predicted signals at the samples of a run, by a case without its overrides.

        Raises InputError or RunError if the case cannot predict the run.
        """
        whole = run.whole or run
        own = self.kind.reduced(whole.of(case), whole)
        # a run with other weights is predicted alike
        content = self._contents.of(own, None, lambda: own.content)
        key = (content, id(whole.signals), self.kind.predicted_as(whole))
        with self._lock:
            kept = self._kept.get(key)
            if kept is not None:
                self._kept.move_to_end(key)
        found = self._made(own, content, whole) if kept is None else kept[1]
        if kept is None:
            self._keep(key, whole, found)
        if run.part is None:
            return found
        return {channel: values[run.part] for channel, values in found.items()}

    def coarse(self, case: Case, run: Run) -> Run:
        """Run as it is predicted at less cost, near enough for differences; itself where it is.

        By a declared case, without the overrides of the run.
        """
        whole = run.whole or run
        with self._lock:
            known = self._coarse.get(id(whole.signals))
        if known is None:
            known = whole, self.kind.coarse(case, whole)
            with self._lock:
                self._coarse[id(whole.signals)] = known
        return run.with_overrides(known[1]) if known[1] else run

    def _made(self, own: Case, content: str, whole: Run) -> Signals:
        """Predict a whole run, or read what is kept of it."""
        if not self.kind.stands_alone(whole):
            return self.kind.predict(own, whole)
        told = self.kind.predicted_as(whole)
        inputs = f"{whole.kind} {whole.name} {self._digest_of(whole)} {content} {told}"
        return self.kept.made(inputs, lambda: self.kind.predict(own, whole))

    def _digest_of(self, whole: Run) -> str:
        """Digest of the signals of a run."""
        with self._lock:
            known = self._digests.get(id(whole.signals))
        if known is None:
            known = whole, digest_of(whole.signals)
            with self._lock:
                self._digests[id(whole.signals)] = known
        return known[1]

    def _keep(self, key: tuple[str, int, str], whole: Run, found: Signals) -> None:
        with self._lock:
            self.made += 1
            if key in self._kept:
                return
            # with the run, whose signals the key tells by their identity
            self._kept[key] = whole, found
            self._bytes += _size(found)
            while self._bytes > _MOST_BYTES and len(self._kept) > 1:
                self._bytes -= _size(self._kept.popitem(last=False)[1][1])


def kept_predictions(
    folder: str | Path | None, purpose: str, measurement: Measurement
) -> KeptArrays:
    """Predictions of a measurement that an earlier run has kept in a folder of results, if any."""
    if folder is None:
        return KeptArrays(None)
    signals = "".join(f"{run.name} {digest_of(run.signals)}" for run in measurement.runs)
    described = repr((measurement.kind, measurement.record, dict(measurement.tolerances)))
    return KeptArrays(folder, purpose, fingerprint(measurement.case), described, signals)


def _size(signals: Signals) -> int:
    return sum(values.nbytes for values in signals.values())
