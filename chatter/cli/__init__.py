"""The command line: one module a command, errors and progress in one place each."""

from __future__ import annotations

import os

# matrices here are small: threads of BLAS cost more than they bring, and take cores from the sweeps
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import typer

from chatter.cli import (
    bifurcation,
    check,
    compare,
    examples,
    explain,
    frf,
    lobes,
    modes,
    move,
    optimum,
    pitch,
    schema,
    simulate,
    uncertainty,
    whatif,
)

app = typer.Typer(
    name="chatter",
    help="Chatter and stability of milling, and the machines that it happens on.",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)

COMMANDS = (
    check.check,
    lobes.lobes,
    simulate.simulate,
    bifurcation.bifurcation,
    whatif.whatif,
    uncertainty.uncertainty,
    optimum.optimum,
    pitch.pitch,
    modes.modes,
    compare.compare,
    explain.explain,
    frf.frf,
    move.move,
    examples.examples,
    schema.schema,
)
for command in COMMANDS:
    app.command()(command)


def main() -> None:
    """Run the command line."""
    app()
