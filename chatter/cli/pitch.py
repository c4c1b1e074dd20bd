"""`chatter pitch CASE`: pitch angles for a range of speeds."""

from functools import partial

from chatter.cli import options
from chatter.cli.progress import progress_bar
from chatter.cli.results import present, print_sentences
from chatter.io.result_tables import require_kind


def pitch(
    case: options.CaseFile,
    assignments: options.Assignments = None,
    tables: options.Tables = "csv",
    out: options.OutputFolder = None,
    json: options.Json = False,
) -> None:
    """Find pitch angles that raise the limits over the speeds of [pitch_design]."""
    require_kind(tables, "--tables")
    description = options.patched_case(case, assignments)
    from chatter.studies.pitch_design.pitch_design import pitch as run_pitch

    folder = options.output_folder(out, case.stem)
    with progress_bar("pitch designs") as progress:
        found = run_pitch(description, progress, folder)
    options.print_coefficients(description)
    present(
        found,
        folder,
        json=json,
        words=print_sentences,
        notes=found.notes,
        save=partial(found.save, tables=tables),
    )
