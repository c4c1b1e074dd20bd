"""Commands that are imported when they are called: start-up imports one of them, help none."""

from __future__ import annotations

import ast
from collections.abc import Iterator, MutableMapping
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import typer
from typer.core import TyperGroup

from chatter.cli.command_line import TYPED


def python_name(name: str) -> str:
    """Name of the module and of the function of a command."""
    return name.replace("-", "_")


def in_a_line(name: str) -> str:
    """First line of the docstring of a command, read without importing it."""
    module = find_spec(f"chatter.cli.{python_name(name)}")
    tree = ast.parse(Path(module.origin).read_text(encoding="utf-8"))
    functions = (node for node in tree.body if isinstance(node, ast.FunctionDef))
    command = next(node for node in functions if node.name == python_name(name))
    return (ast.get_docstring(command) or "").splitlines()[0]


class ImportedCommands(MutableMapping[str, Any]):
    """Commands by name, each imported when it is first taken."""

    def __init__(self, names: tuple[str, ...]) -> None:
        self.names = names
        self._taken: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        """Command of a name; KeyError where there is none."""
        if name not in self._taken:
            if name not in self.names:
                raise KeyError(name)
            self._taken[name] = _imported(name)
        return self._taken[name]

    def __setitem__(self, name: str, command: Any) -> None:
        """Add a command."""
        self.names = (*self.names, name)
        self._taken[name] = command

    def __delitem__(self, name: str) -> None:
        """Take a command away."""
        self.names = tuple(one for one in self.names if one != name)

    def __iter__(self) -> Iterator[str]:
        """Names in the order of the list."""
        return iter(self.names)

    def __len__(self) -> int:
        """Number of commands."""
        return len(self.names)


def _imported(name: str) -> Any:
    from chatter.cli.errors import reports_errors
    from chatter.cli.report import with_report

    alone = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
    module = import_module(f"chatter.cli.{python_name(name)}")
    command = with_report(name, getattr(module, python_name(name)))
    alone.command(name)(reports_errors(command))
    return typer.main.get_command(alone)


class CommandGroup(TyperGroup):
    """Group that lists its commands without importing them."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Leave the words as they were typed, for the report."""
        TYPED.set(tuple(args))
        return super().parse_args(ctx, args)

    def list_commands(self, ctx: Any) -> list[str]:  # noqa: ARG002 (as typer calls it)
        """Names in the order of the list."""
        return list(self.commands)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write each command with the first line of its docstring."""
        with formatter.section("Commands"):
            formatter.write_dl([(name, in_a_line(name)) for name in self.list_commands(ctx)])
