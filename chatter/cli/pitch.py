"""`chatter pitch CASE`: pitch angles for a range of speeds."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from chatter.cli.errors import reports_errors
from chatter.cli.options import Assignments, CaseFile, Json, OutputFolder
from chatter.cli.search import searched
from chatter.description.case import Case
from chatter.description.progress import Progress

if TYPE_CHECKING:
    from chatter.studies.pitch_design.result import PitchResult


@reports_errors
def pitch(
    case: CaseFile,
    assignments: Assignments = None,
    out: OutputFolder = None,
    json: Json = False,
) -> None:
    """Find pitch angles that raise the limits over the speeds of [pitch_design]."""
    searched(_search, "designs", case, assignments, out, json)


def _search(description: Case, progress: Progress, folder: Path) -> PitchResult:
    from chatter.studies.pitch_design.study import pitch as run_pitch

    return run_pitch(description, progress, folder)
