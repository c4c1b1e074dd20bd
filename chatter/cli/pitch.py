"""`chatter pitch CASE`: pitch angles for a range of speeds."""

from chatter.cli import options
from chatter.cli.progress import progress_bar
from chatter.cli.results import present, print_sentences


def pitch(
    case: options.CaseFile,
    assignments: options.Assignments = None,
    out: options.OutputFolder = None,
    json: options.Json = False,
) -> None:
    """Find pitch angles that raise the limits over the speeds of [pitch_design]."""
    description = options.patched_case(case, assignments)
    from chatter.studies.pitch_design.pitch_design import pitch as run_pitch

    folder = options.output_folder(out, case.stem)
    with progress_bar("pitch designs") as progress:
        found = run_pitch(description, progress, folder)
    options.print_coefficients(description)
    present(found, folder, json=json, words=print_sentences, notes=found.notes)
