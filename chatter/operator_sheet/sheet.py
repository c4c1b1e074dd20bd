"""The operator's sheet of one or several cases."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from chatter.description.case import Case, load
from chatter.description.described_or_path import described_or_read
from chatter.description.errors import InputError
from chatter.description.progress import Progress, begin, no_progress
from chatter.description.whole_files import write_whole
from chatter.io.result_files import NotebookResult, as_json, presentation, short_repr, write_results
from chatter.operator_sheet.cuts import CaseCuts, cuts_of
from chatter.operator_sheet.variation import variation_that_helps
from chatter.operator_sheet.workbook import workbook_of
from chatter.stability.lobes import lobes
from chatter.stability.neglected_effects import STABLE
from chatter.stability.pockets import DEPTH_MARGIN, SPEED_MARGIN


@dataclass(frozen=True, eq=False, repr=False)
class Sheet(NotebookResult):
    """Cuts worth making of one or several cases: tools, materials, engagements.

    Parameters
    ----------
    cases : tuple of CaseCuts
    """

    cases: tuple[CaseCuts, ...]

    def __repr__(self) -> str:
        """Short: the diagrams would fill the screen."""
        return short_repr(self)

    def summary(self) -> dict[str, Any]:
        """Content of summary.json."""
        return {
            "margin": {"depth": DEPTH_MARGIN, "spindle_speed": SPEED_MARGIN},
            "cases": [_summary(one) for one in self.cases],
        }

    def plot(self) -> Any:
        """Return the pages as a list of matplotlib figures."""
        return presentation("plots.sheet").pages(self)

    def save(self, folder: str | Path) -> list[Path]:
        """Write sheet.pdf, sheet.xlsx and summary.json into a folder."""
        folder = Path(folder)
        written = write_results(folder, {"summary.json": as_json(self.summary())}, {})
        pages = io.BytesIO()
        presentation("plots.sheet").write_pages(self, pages)
        contents = {"sheet.pdf": pages.getvalue(), "sheet.xlsx": workbook_of(self.cases)}
        for name, content in contents.items():
            write_whole(folder / name, content)
        return [*(folder / name for name in contents), *written]


def sheet(
    cases: str | Path | Case | Sequence[str | Path | Case], progress: Progress = no_progress
) -> Sheet:
    """Cuts worth making of one or several cases, with limits and margins.

    For each case: the cut as stated, the best pockets of its stability diagram, and the depth that
    any speed of the range allows; depths but the stated one keep 15 % of the limit in hand, or what
    edge forces may take of it. Where the stated cut has less than 15 %, a variation of the spindle
    speed is tried.

    Parameters
    ----------
    cases : path, Case, or sequence of them
    progress : callable, optional
        Called with (done, total) of the part under way: limits at all speeds of the first case,
        the lowest one between them, and so on.

    Raises
    ------
    InputError
        If a case lacks something, or none is given.
    """
    single = isinstance(cases, (str, Path)) or not isinstance(cases, Sequence)
    given = [cases] if single else list(cases)
    if not given:
        raise InputError("no case is given; a sheet is of one case or more")
    found = []
    for place, one in enumerate(given, start=1):
        case = described_or_read(one, Case, load)
        which = f"{case.name} ({place} of {len(given)}): " if len(given) > 1 else ""
        found.append(_cuts(case, _PartsOfCase(progress, which)))
    return Sheet(tuple(found))


class _PartsOfCase:
    """Progress of one case, the parts of which count and are timed anew.

    Parts of a case, and cases, differ in what they take: no pace holds for all of them.
    """

    def __init__(self, progress: Progress, which: str) -> None:
        self._progress, self._which = progress, which

    def __call__(self, done: int, total: int) -> None:
        """Report how many pieces of the part are done."""
        self._progress(done, total)

    def begin(self, description: str) -> None:
        """Announce another part."""
        begin(self._progress, f"{self._which}{description}")


def _cuts(case: Case, progress: Progress) -> CaseCuts:
    begin(progress, "limits at all speeds")
    diagram = lobes(case, progress=progress)
    begin(progress, "variation of the spindle speed")
    variation = variation_that_helps(case, float(diagram.operating.critical_depth[0]))
    return CaseCuts(case, diagram, cuts_of(diagram), variation)


def _summary(one: CaseCuts) -> dict[str, Any]:
    variation = one.variation
    return {
        "title": one.case.title or one.case.name,
        "method": one.diagram.method,
        "cuts": [
            {
                "name": cut.name,
                "verdict": cut.verdict,
                "not_certain_because": cut.because or None,
                "stable": cut.verdict == STABLE,
                "spindle_speed_rpm": cut.spindle_speed,
                "cutting_speed_m_per_min": cut.cutting_speed,
                "axial_depth_mm": cut.axial_depth,
                "width_of_cut_mm": cut.width_of_cut,
                "feed_per_tooth_mm": cut.feed_per_tooth,
                "feed_rate_mm_per_min": cut.feed_rate,
                "critical_depth_mm": cut.limit,
                "margin": cut.margin,
                "removal_rate_cm3_per_min": cut.removal_rate,
            }
            for cut in one.cuts
        ],
        "speed_variation": None
        if variation is None
        else {
            "amplitude": variation.amplitude,
            "frequency_Hz": variation.frequency,
            "critical_depth_mm": None if variation.limit is None else 1e3 * variation.limit,
        },
        "notes": list(one.diagram.notes),
    }
