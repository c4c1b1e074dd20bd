"""`chatter pitch CASE`: pitch angles for a range of speeds."""

from __future__ import annotations

from chatter.cli.errors import reports_errors
from chatter.cli.options import (
    Assignments,
    CaseFile,
    Json,
    OutputFolder,
    output_folder,
    patched_case,
)
from chatter.cli.report import (
    announce_compilation,
    print_json,
    print_line,
    print_notes,
    print_written,
    progress_bar,
)


@reports_errors
def pitch(
    case: CaseFile,
    assignments: Assignments = None,
    out: OutputFolder = None,
    json: Json = False,
) -> None:
    """Find pitch angles that raise the limits over the speeds of [pitch_design]."""
    description = patched_case(case, assignments)
    from chatter.pitch_angles.study import pitch as run_pitch

    announce_compilation()
    with progress_bar("designs") as progress:
        found = run_pitch(description, progress)
    written = found.save(output_folder(out, case.stem))
    if json:
        print_json(found.summary())
    else:
        for line in found.told():
            print_line(line)
    print_notes(found.notes)
    print_written(written)
