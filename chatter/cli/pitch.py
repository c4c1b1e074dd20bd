"""`chatter pitch CASE`: pitch angles for a range of speeds."""

from __future__ import annotations

from chatter.cli.options import (
    Assignments,
    CaseFile,
    Json,
    OutputFolder,
    output_folder,
    patched_case,
)
from chatter.cli.progress import announce_compilation, progress_bar
from chatter.cli.results import present, print_sentences


def pitch(
    case: CaseFile,
    assignments: Assignments = None,
    out: OutputFolder = None,
    json: Json = False,
) -> None:
    """Find pitch angles that raise the limits over the speeds of [pitch_design]."""
    description = patched_case(case, assignments)
    from chatter.studies.pitch_design.pitch_design import pitch as run_pitch

    announce_compilation()
    folder = output_folder(out, case.stem)
    with progress_bar("designs") as progress:
        found = run_pitch(description, progress, folder)
    present(found, folder, json=json, words=print_sentences, notes=found.notes)
