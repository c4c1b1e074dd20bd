"""`chatter schema`: the JSON schema of a case file or machine file."""

from typing import Annotated

import typer

from chatter.cli import options
from chatter.report.console import print_json, print_written


def schema(
    machine: Annotated[
        bool, typer.Option("--machine", help="Of the machine file instead of the case file.")
    ] = False,
    out: options.OutputFolder = None,
) -> None:
    """Print the JSON schema of the case or machine file, for editors that complete and check."""
    import json

    if machine:
        from chatter.description.json_schema import machine_schema as content
    else:
        from chatter.stability.case_schema import schema as content
    if out is None:
        print_json(content())
        return
    out.mkdir(parents=True, exist_ok=True)
    path = out / ("machine.schema.json" if machine else "case.schema.json")
    path.write_text(json.dumps(content(), indent=2) + "\n", encoding="utf-8")
    print_written([path])
