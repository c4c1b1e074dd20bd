"""`chatter whatif CASE --vary PATH=v1,v2`: what would change if a value were another."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from chatter.cli.options import (
    Assignments,
    Cluster,
    Json,
    Method,
    OutputFolder,
    Tables,
    output_folder,
    print_coefficients,
)
from chatter.cli.options_as_one import takes_options
from chatter.cli.progress import announce_resumed, progress_bar
from chatter.cli.results import present, print_sentences
from chatter.description.assignments import parse_assignments
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.io.result_tables import require_kind
from chatter.report.console import print_line

if TYPE_CHECKING:
    from chatter.studies.whatif.preset_studies import PresetStudy


@dataclass(frozen=True)
class WhatIfOptions:
    """What `chatter whatif` is given."""

    file: Annotated[
        Path | None,
        typer.Argument(metavar="CASE|MACHINE", help="Case or machine file; a study has its own."),
    ] = None
    vary: Annotated[
        list[str] | None,
        typer.Option(
            "--vary",
            metavar="PATH=VALUES",
            help='"1 mm, 2 mm", "1 mm..4 mm:9" or "+-10%"; once for an overlay, twice for a heat '
            "map, more with --tornado. Paths into the machine of a case begin with machine.",
        ),
    ] = None
    count: Annotated[
        int | None, typer.Option("--count", help="Values of a range that gives none [5].")
    ] = None
    result: Annotated[
        str | None, typer.Option("--result", help="lobes, critical depth, forces, surface or frf.")
    ] = None
    tornado: Annotated[
        bool, typer.Option("--tornado", help="Each path low and high, one at a time.")
    ] = False
    quantity: Annotated[
        str | None, typer.Option("--quantity", help="Number to show, by its column in whatif.csv.")
    ] = None
    study: Annotated[
        str | None, typer.Option("--study", metavar="NAME", help="A preset study.")
    ] = None
    studies: Annotated[bool, typer.Option("--studies", help="List the preset studies.")] = False
    only: Annotated[
        list[str] | None, typer.Option("--only", help="Name of a [frf.NAME]; repeatable.")
    ] = None
    assignments: Assignments = None
    method: Method = None
    cluster: Cluster = None
    tables: Tables = "csv"
    out: OutputFolder = None
    json: Json = False


@takes_options
def whatif(options: WhatIfOptions) -> None:
    """Ask what would change: lobes, limits, forces, surface or FRFs over values of any path."""
    require_kind(options.tables, "--tables")
    if options.studies:
        _list_studies()
        return
    file, study = options.file, options.study
    chosen = _chosen(study, options.vary)
    if file is None:
        if chosen is None:
            raise InputError("a case or machine file is required, or --study NAME; --studies lists")
        file = chosen.file()
    from chatter.studies.model import load_model, patched

    model = patched(load_model(file), parse_assignments(options.assignments or []))
    name = file.parent.name if chosen is not None else file.stem
    folder = output_folder(options.out, f"{name}-{study}" if study else name)
    if chosen is not None:
        model = _fitted(chosen, lambda: patched(model, chosen.settings))
    from chatter.studies.whatif.whatif_study import whatif as run_whatif

    with progress_bar("points of the study") as progress:
        found = _fitted(
            chosen,
            lambda: run_whatif(
                model,
                options.vary or (chosen.vary if chosen else []),
                options.result or (chosen.result if chosen else None),
                tornado=options.tornado or (chosen is not None and chosen.tornado),
                count=options.count,
                quantity=options.quantity or (chosen.quantity if chosen else None),
                method=options.method,
                only=options.only or (chosen.only if chosen else ()),
                folder=folder,
                progress=progress,
                resumed=partial(announce_resumed, "points"),
                cluster=options.cluster,
            ),
        )
    if isinstance(model, Case):
        print_coefficients(model)
    present(
        found,
        folder,
        json=options.json,
        words=print_sentences,
        save=partial(found.save, tables=options.tables),
    )


def _chosen(study: str | None, vary: list[str] | None) -> PresetStudy | None:
    if study is None:
        return None
    if vary:
        raise InputError("--study and --vary are both given; a study has its own paths and values")
    from chatter.studies.whatif.preset_studies import preset_study

    return preset_study(study)


def _fitted(chosen: PresetStudy | None, make):
    """Result of a function; errors of a study on another file say what it was made for."""
    try:
        return make()
    except InputError as error:
        if chosen is None:
            raise
        hint = f"--study {chosen.name} is made for the example {chosen.example}"
        raise InputError([*error.messages, hint]) from None


def _list_studies() -> None:
    from chatter.studies.whatif.preset_studies import preset_studies

    for one in preset_studies().values():
        print_line(f"{one.name}: {one.question}")
        print_line(f"    chatter whatif --study {one.name}      (example {one.example})")
        for each in one.vary:
            print_line(f"    --vary '{each}'")
        for path, value in one.settings.items():
            print_line(f"    with {path} = {value}")
        flag = " --tornado" if one.tornado else ""
        print_line(f"    --result {one.result}{flag}")
