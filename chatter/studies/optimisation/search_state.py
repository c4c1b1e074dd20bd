"""State that all parts of a search share: the compiled case, the result cache, progress."""

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

from chatter.description.case import Case
from chatter.description.progress import Progress
from chatter.stability.model import milling_model
from chatter.studies.model import fingerprint
from chatter.studies.optimisation.candidate import Candidate, candidate_at
from chatter.studies.optimisation.limits import limits_of
from chatter.studies.optimisation.operating_point import OperatingPoint
from chatter.studies.optimisation.sampled_cuts import samples_of
from chatter.studies.result_cache import ResultCache


class OptimumSearch:
    """A case compiled for a search, its parts on disk, and how far the search is.

    `folder` keeps finished parts; `progress` is called with (done, total) parts of the work.
    """

    def __init__(
        self, case: Case, samples: int, seed: int, progress: Progress, folder: str | Path | None
    ) -> None:
        self.model = milling_model(case)
        self.drawn = samples_of(self.model, samples, seed)
        sampled = self.drawn.models if self.drawn is not None else ()
        self.limits = limits_of(case, self.model, sampled)
        self.cache = ResultCache(folder, "optimum", fingerprint(case))
        #: what parts depend on where something is uncertain
        self.draw = (samples, seed) if self.drawn is not None else None
        self._progress, self._lock = progress, threading.Lock()
        self.total, self.finished = 1, 0

    def expect(self, total: int) -> None:
        """Set how much work there is in all, at the most."""
        self.total = total + 1

    def part(self, size: int) -> Progress:
        """Progress of a part of this size."""
        return lambda done, total: self._report(self.finished + size * done // max(total, 1))

    def parts(self, count: int, size: int) -> list[Progress]:
        """Progress of parts of this size that go on at the same time, in threads."""
        shares = [0] * count

        def of(index: int) -> Progress:
            def report(done: int, total: int) -> None:
                with self._lock:
                    shares[index] = size * done // max(total, 1)
                    self._report(self.finished + sum(shares))

            return report

        return [of(index) for index in range(count)]

    def done(self, size: int) -> None:
        """Count a part of this size."""
        self.finished += size
        self._report(self.finished)

    def _report(self, finished: int) -> None:
        self._progress(min(finished, self.total - 1), self.total)

    def end(self) -> None:
        """Report that nothing remains to do."""
        self._progress(self.total, self.total)

    def candidate(
        self, name: str, point: OperatingPoint, compute: Callable[[], Candidate | None]
    ) -> Candidate | None:
        """Candidate of a point, or that it has none, computed if it is not known yet."""

        def found() -> dict[str, Any] | None:
            candidate = compute()
            return candidate and candidate.record()

        record = self.cache.record(name, (tuple(point), self.draw), found)
        return record and Candidate.from_record(record)

    def at(self, point: OperatingPoint) -> Candidate:
        """Candidate at a point in round numbers."""
        found = self.candidate(
            "rounded", point, lambda: candidate_at(self.model, self.limits, point)
        )
        assert found is not None
        return found
