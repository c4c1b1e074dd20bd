"""The command line: a command is a function of its name in a module of its name, and a line here.

Hyphens of a name are underscores in Python.

================= ============================================================================
module            responsibility
================= ============================================================================
options           options that commands share; case and machine files with their patches
options_as_one    commands of many options take them as one dataclass
imported_commands commands are imported when they are called, and help imports none
quick_pictures    the library of pictures without its own documentation
start_up          a word while the program is loaded
garbage           the garbage collector while a command starts and ends
progress          progress bars; what the first use takes
results           what every command does with its result
report            `--report` of every command
command_line      words of the command line as they were typed
errors            one clear message and an exit code for every error
================= ============================================================================
"""

import os
import signal
import threading

# Ctrl-C while the program is imported ends it without a word: there is nothing to tell yet
_HANDLER = signal.getsignal(signal.SIGINT)
_IS_OURS = (
    threading.current_thread() is threading.main_thread() and _HANDLER is signal.default_int_handler
)
if _IS_OURS:
    signal.signal(signal.SIGINT, signal.SIG_DFL)

# matrices here are small: threads of BLAS cost more than they bring, and take cores from the sweeps
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from typing import Annotated, Any

import typer

from chatter.cli.garbage import end_without_collection, start_without_collection
from chatter.cli.imported_commands import CommandGroup, ImportedCommands
from chatter.cli.quick_pictures import leave_documentation_out
from chatter.cli.start_up import START_UP
from chatter.engine.interruption import repeat_swallowed_interruptions

if _IS_OURS:
    signal.signal(signal.SIGINT, _HANDLER)

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
    "friction",
    "detect",
    "frf",
    "move",
    "mode-shapes",
    "export",
    "assemble",
    "sheet",
    "materials",
    "examples",
    "schema",
    "app",
    "doctor",
    "compile",
)


#: exit code of typer for Ctrl-C
_INTERRUPTED = 130


class _Group(CommandGroup):
    """Group of the commands of this list."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        """Build the group as typer does."""
        super().__init__(*args, **kwargs)
        self.commands = ImportedCommands(COMMANDS)


program = typer.Typer(
    name="chatter",
    cls=_Group,
    help="Chatter and stability of milling, and the machines that it happens on.",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)


def _print_version(wanted: bool) -> None:
    if wanted:
        from chatter import __version__

        typer.echo(f"chatter {__version__}")
        raise typer.Exit


@program.callback()
def _of_all(
    _version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version and end."
        ),
    ] = False,
) -> None:
    """Chatter and stability of milling, and the machines that it happens on."""


def _completes_for_a_shell() -> bool:
    """Whether a shell asks what may follow: click's variable of the program's name is set."""
    return any(name.startswith("_") and name.endswith("_COMPLETE") for name in os.environ)


def main() -> None:
    """Run the command line."""
    leave_documentation_out()
    # a word would stand between what the shell completes
    if not _completes_for_a_shell():
        START_UP.begin()
    start_without_collection()
    repeat_swallowed_interruptions()
    try:
        program()
    except SystemExit as ended:
        # an interruption outside of any command, which no command could report
        if ended.code == _INTERRUPTED:
            from chatter.cli.errors import EXIT_RUN_FAILED

            typer.echo("chatter: interrupted", err=True)
            ended.code = EXIT_RUN_FAILED
        raise
    finally:
        START_UP.close()
        end_without_collection()
