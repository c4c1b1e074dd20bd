"""Turn errors into one clear message and an exit code."""

import functools
import os
import sys
from collections.abc import Callable
from typing import ParamSpec

import typer

from chatter.description.errors import InputError, RunError

Parameters = ParamSpec("Parameters")

EXIT_RUN_FAILED = 1
EXIT_INPUT_WRONG = 2

#: set to see the traceback of a programming error
_DEBUG_VARIABLE = "CHATTER_DEBUG"


def reports_errors(command: Callable[Parameters, None]) -> Callable[Parameters, None]:
    """Give a command the exit codes 2 for wrong input and 1 for a failed run."""

    @functools.wraps(command)
    def reporting(*args: Parameters.args, **kwargs: Parameters.kwargs) -> None:
        try:
            command(*args, **kwargs)
        except InputError as error:
            _leave(error.messages, EXIT_INPUT_WRONG)
        except RunError as error:
            _leave([str(error)], EXIT_RUN_FAILED)
        except KeyboardInterrupt:
            _leave(["interrupted"], EXIT_RUN_FAILED)
        except BrokenPipeError:
            # the reader of our output has gone; there is nobody left to tell
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            raise typer.Exit(EXIT_RUN_FAILED) from None
        except OSError as error:
            file = f"{error.filename}: " if error.filename else ""
            _leave([f"{file}{error.strerror or error}"], EXIT_INPUT_WRONG)
        except (typer.Exit, typer.Abort):
            raise
        except Exception as error:
            if os.environ.get(_DEBUG_VARIABLE):
                raise
            name = type(error).__name__
            _leave(
                [f"a fault in chatter itself ({name}: {error}); {_DEBUG_VARIABLE}=1 shows where"],
                EXIT_RUN_FAILED,
            )

    return reporting


def _leave(messages: list[str] | tuple[str, ...], code: int) -> None:
    for message in messages:
        typer.echo(f"chatter: {message}", err=True)
    raise typer.Exit(code)
