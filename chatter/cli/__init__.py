"""The command line: a command is a function of its name in a module of its name, and a line here.

============== ===============================================================================
module         responsibility
============== ===============================================================================
options        options that commands share; case and machine files with their patches
options_as_one commands of many options take them as one dataclass
progress       progress bars; what the first use takes
results        what every command does with its result
errors         one clear message and an exit code for every error
============== ===============================================================================
"""

import os

# matrices here are small: threads of BLAS cost more than they bring, and take cores from the sweeps
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from importlib import import_module

import typer

from chatter.cli.errors import reports_errors

COMMANDS = (
    "new",
    "check",
    "lobes",
    "simulate",
    "bifurcation",
    "whatif",
    "uncertainty",
    "optimum",
    "pitch",
    "modes",
    "compare",
    "explain",
    "learn",
    "coefficients",
    "detect",
    "frf",
    "move",
    "export",
    "sheet",
    "materials",
    "examples",
    "schema",
    "doctor",
)

app = typer.Typer(
    name="chatter",
    help="Chatter and stability of milling, and the machines that it happens on.",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)

for _name in COMMANDS:
    app.command(_name)(reports_errors(getattr(import_module(f"chatter.cli.{_name}"), _name)))


def main() -> None:
    """Run the command line."""
    app()
