"""The command line: one module a command, errors and progress in one place each."""

from __future__ import annotations

import typer

from chatter.cli import bifurcation, check, examples, lobes, modes, schema, simulate

app = typer.Typer(
    name="chatter",
    help="Chatter and stability of milling: from a tap test to a stability diagram.",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)

COMMANDS = (
    check.check,
    lobes.lobes,
    simulate.simulate,
    bifurcation.bifurcation,
    modes.modes,
    examples.examples,
    schema.schema,
)
for command in COMMANDS:
    app.command()(command)


def main() -> None:
    """Run the command line."""
    app()
