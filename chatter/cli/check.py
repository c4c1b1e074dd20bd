"""`chatter check CASE`: verdict on the operating point, as JSON."""

from chatter.cli import options
from chatter.cli.progress import announce_compilation
from chatter.report.console import print_json, print_notes, print_written


def check(
    case: options.CaseFile,
    assignments: options.Assignments = None,
    method: options.Method = None,
    out: options.OutputFolder = None,
    json: options.Json = True,  # noqa: ARG001  (the output is JSON either way; scripts pass the option)
) -> None:
    """Judge the operating point of a case: stable or chatter, and the critical depth."""
    description = options.patched_case(case, assignments)
    from chatter.stability.check import check as run_check

    announce_compilation()
    result = run_check(description, method)
    print_json(result.summary())
    print_notes(result.notes)
    if out is not None:
        print_written(result.save(out))
