"""`chatter examples [NAME]`: list, copy or run the shipped examples."""

from pathlib import Path
from typing import Annotated

import typer

from chatter.cli import options
from chatter.cli.progress import progress_bar
from chatter.description.errors import InputError
from chatter.report.console import print_json, print_table, print_written


def _names() -> list[str]:
    from chatter.io.shipped_examples import examples as shipped

    return list(shipped())


def examples(
    name: Annotated[
        str | None, typer.Argument(metavar="NAME", help="Which one.", autocompletion=_names)
    ] = None,
    run: Annotated[bool, typer.Option("--run", help="Run it instead of copying it.")] = False,
    open_picture: Annotated[
        bool, typer.Option("--open", help="Show the first picture on the desktop.")
    ] = False,
    out: options.OutputFolder = None,
    json: options.Json = False,
) -> None:
    """List the shipped examples, copy one here, or run it."""
    from chatter.io.shipped_examples import example
    from chatter.io.shipped_examples import examples as shipped

    if name is None:
        listed = {one.name: one.summary for one in shipped().values()}
        if json:
            print_json(listed)
        else:
            print_table("examples", ["name", "shows"], [list(row) for row in listed.items()])
        return
    if json:
        raise InputError("--json prints the list of examples; leave NAME or --json out")
    chosen = example(name)
    if not run:
        print_written([chosen.copy(out if out is not None else Path(name))])
        return
    with progress_bar(f"running {name}"):
        written = chosen.run(out if out is not None else Path(f"{name}-out"))
    print_written(written)
    pictures = [path for path in written if path.suffix == ".png"]
    if open_picture and pictures and has_desktop():
        typer.launch(str(pictures[0]))


def has_desktop() -> bool:
    """Tell whether there is a screen to show a picture on."""
    import os
    import sys

    return sys.platform in ("darwin", "win32") or any(
        os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY")
    )
