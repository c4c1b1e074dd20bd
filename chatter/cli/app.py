"""`chatter app [FOLDER]`: the workbench in the browser."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import typer

from chatter.cli.options import Json
from chatter.cli.progress import progress_bar
from chatter.description.errors import InputError
from chatter.report.console import print_json, print_line


def app(
    folder: Annotated[
        Path, typer.Argument(metavar="FOLDER", help="Folder of case files.")
    ] = Path(),
    port: Annotated[int, typer.Option("--port", help="By default a free one.")] = 0,
    no_browser: Annotated[bool, typer.Option("--no-browser", help="Open no browser.")] = False,
    json: Json = False,
) -> None:
    """Open the workbench in the browser; Ctrl-C ends it."""
    if not folder.is_dir():
        raise InputError(f"{folder}: a folder is required")
    if find_spec("panel") is None:
        raise InputError("the workbench requires Panel: pip install 'chatter[app]'")
    with progress_bar("starting the workbench"):
        from chatter.app.workbench.server import WorkbenchServer

        server = WorkbenchServer(folder, port=port)
    if json:
        print_json({"url": server.url, "folder": str(folder)})
    else:
        print_line(f"{server.url}  (Ctrl-C ends)")
    if not no_browser:
        import webbrowser

        webbrowser.open(server.url)
    try:
        server.serve()
    except KeyboardInterrupt:
        typer.echo("ended", err=True)
