"""`chatter schema`: the JSON schema of a case, machine or measurement file."""

from typing import Annotated

import typer

from chatter.cli import options
from chatter.description.errors import InputError
from chatter.description.whole_files import write_whole
from chatter.report.console import print_json, print_written


def schema(
    machine: Annotated[
        bool, typer.Option("--machine", help="Of the machine file instead of the case file.")
    ] = False,
    measurement: Annotated[
        bool, typer.Option("--measurement", help="Of measurement.toml instead of the case file.")
    ] = False,
    out: options.OutputFolder = None,
) -> None:
    """Print the JSON schema of the case, machine or measurement file, for editors."""
    import json

    if machine and measurement:
        raise InputError("--machine and --measurement are given; one of the two is enough")
    if machine:
        from chatter.description.json_schema import machine_schema as content

        name = "machine"
    elif measurement:
        from chatter.explain.measurement_schema import measurement_schema as content

        name = "measurement"
    else:
        from chatter.stability.case_schema import schema as content

        name = "case"
    if out is None:
        print_json(content())
        return
    out.mkdir(parents=True, exist_ok=True)
    path = out / f"{name}.schema.json"
    write_whole(path, json.dumps(content(), indent=2) + "\n")
    print_written([path])
