"""`chatter app [FOLDER]`: the workbench in the browser."""

from __future__ import annotations

from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from chatter.cli.options import Json
from chatter.cli.progress import progress_bar
from chatter.description.errors import InputError
from chatter.report.console import print_json, print_line

if TYPE_CHECKING:
    from chatter.app.workbench.server import WorkbenchServer


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
    refuse_without_panel()
    with progress_bar("starting the workbench"):
        from chatter.app.workbench.server import WorkbenchServer

        server = WorkbenchServer(folder, port=port)
    serve(server, json=json, no_browser=no_browser, folder=folder)


def refuse_without_panel() -> None:
    """Raise InputError where the extra of the workbench is not installed."""
    if find_spec("panel") is None:
        raise InputError("the workbench requires Panel: pip install 'chatter[app]'")


def serve(
    server: WorkbenchServer, *, json: bool, no_browser: bool, folder: Path | None = None
) -> None:
    """Print the address of a server, open the browser, and serve until Ctrl-C."""
    if json:
        print_json({"url": server.url, "folder": str(folder)})
    else:
        print_line(f"{server.url}  (Ctrl-C ends)")
    if not no_browser:
        import webbrowser

        webbrowser.open(server.url)
    with suppress(KeyboardInterrupt):  # mostly the server ends by itself at Ctrl-C
        server.serve()
    typer.echo("ended", err=True)
