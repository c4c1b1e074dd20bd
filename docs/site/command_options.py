"""Page of all commands with their arguments and options, made from the command line itself."""

from __future__ import annotations

from typing import Any

import typer.main

_HEAD = """# Commands: arguments and options

Made from the program, as `chatter COMMAND --help` prints it.
What the commands have in common stands in [commands](../commands.md).
"""


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")


def _option_row(option: Any) -> list[str]:
    names = [*option.opts, *option.secondary_opts]
    takes = "" if getattr(option, "is_flag", False) else (option.metavar or option.name.upper())
    default = option.default
    shown = "" if default in (None, False, (), []) or callable(default) else f"`{default}`"
    return [", ".join(f"`{one}`" for one in names), takes, shown, getattr(option, "help", "") or ""]


def _section(name: str, command: Any) -> str:
    arguments = [one for one in command.params if one.param_type_name == "argument"]
    options = [one for one in command.params if one.param_type_name == "option"]
    words = " ".join(one.metavar or one.name.upper() for one in arguments)
    lines = [f"## chatter {name}", "", command.help or "", ""]
    lines += ["```text", f"chatter {name} {words}".rstrip() + " [OPTIONS]", "```", ""]
    if arguments:
        lines += ["| argument | what it is |", "|---|---|"]
        lines += [f"| {one.metavar or one.name} | {_cell(one.help or '')} |" for one in arguments]
        lines.append("")
    if options:
        lines += ["| option | takes | default | what it does |", "|---|---|---|---|"]
        lines += [f"| {' | '.join(map(_cell, _option_row(one)))} |" for one in options]
    return "\n".join(lines) + "\n"


def page() -> str:
    """Return the page."""
    from chatter.cli import COMMANDS, program

    group = typer.main.get_command(program)
    return "\n".join([_HEAD, *(_section(name, group.commands[name]) for name in COMMANDS)])
