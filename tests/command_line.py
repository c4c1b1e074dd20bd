"""The command line as tests call it."""

from typer.testing import CliRunner, Result

from chatter.cli import program


def chatter_command(*words) -> Result:
    """Result of ``chatter WORDS...``: exit code, what went to stdout and to stderr."""
    return CliRunner().invoke(program, [str(word) for word in words])
