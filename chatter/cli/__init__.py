"""The command line: one module a command, errors and progress in one place each."""

from __future__ import annotations

import typer

from chatter.cli import check, examples, lobes, modes, schema

app = typer.Typer(
    name="chatter",
    help="Chatter and stability of milling: from a tap test to a stability diagram.",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)

for command in (check.check, lobes.lobes, modes.modes, examples.examples, schema.schema):
    app.command()(command)


def main() -> None:
    """Run the command line."""
    app()
