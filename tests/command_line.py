"""The command line as tests call it."""

from click.testing import Result
from typer.testing import CliRunner

from chatter.cli import app


def chatter_command(*words) -> Result:
    """Result of ``chatter WORDS...``: exit code, what went to stdout and to stderr."""
    return CliRunner().invoke(app, [str(word) for word in words])
