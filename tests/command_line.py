"""The command line as tests call it."""

from click.testing import Result
from typer.testing import CliRunner

from chatter.cli import program


def chatter_command(*words) -> Result:
    """Result of ``chatter WORDS...``: exit code, what went to stdout and to stderr."""
    return CliRunner().invoke(program, [str(word) for word in words])
