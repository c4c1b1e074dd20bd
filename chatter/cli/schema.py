"""`chatter schema`: the JSON schema of a case file."""

from __future__ import annotations

from chatter.cli.errors import reports_errors
from chatter.cli.options import OutputFolder
from chatter.cli.report import print_json, print_written


@reports_errors
def schema(out: OutputFolder = None) -> None:
    """Print the JSON schema of the case file, for editors that complete and check."""
    import json

    from chatter.case import schema as case_schema

    if out is None:
        print_json(case_schema())
        return
    out.mkdir(parents=True, exist_ok=True)
    path = out / "case.schema.json"
    path.write_text(json.dumps(case_schema(), indent=2) + "\n", encoding="utf-8")
    print_written([path])
