"""`chatter doctor`: the state of the installation, and a self-check."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import typer

from chatter.cli import options
from chatter.cli.progress import progress_bar
from chatter.report.console import answer_in_report, print_json, print_line, print_table

if TYPE_CHECKING:
    from chatter.first_steps.self_check import CheckedAnswer


def doctor(json: options.Json = False) -> None:
    """Versions, cores, threads, compiled code, and three answers checked in ten seconds."""
    from chatter.first_steps.installation import installation
    from chatter.first_steps.self_check import self_check

    with progress_bar("self-check"):
        answers = self_check()
    state = installation()  # the code that the check compiled is among it
    right = all(one.right is not False for one in answers)
    if json:
        print_json({**state, "self_check": [one._asdict() for one in answers], "right": right})
    else:
        _print_state(state, answers)
    if not right:
        raise typer.Exit(1)


def _judgement(answers: list[CheckedAnswer]) -> str:
    wrong = sum(one.right is False for one in answers)
    asked = sum(one.right is not None for one in answers)
    return (
        f"{wrong} of {asked} answers are wrong"
        if wrong
        else f"{asked} answers of {asked} are right"
    )


def _print_state(state: dict[str, Any], answers: list[CheckedAnswer]) -> None:
    answer_in_report(_judgement(answers))
    versions = ", ".join(f"{name} {version}" for name, version in state["libraries"].items())
    print_line(f"Python {state['python']} on {state['system']}; {versions}")
    print_line(f"{state['cores']} cores, {state['threads']} threads")
    cache = state["cache"]
    told = "writable" if cache["writable"] else "cannot be written: every start compiles anew"
    print_line(
        f"compiled code: {cache['compiled_functions']} functions, {cache['MB']} MB in "
        f"{cache['folder']} ({told})"
    )
    for name, one in state["optional"].items():
        if not one["installed"]:
            print_line(f"{name} is not installed ({one['for']})")
    judged = {True: "right", False: "WRONG", None: ""}
    rows = [
        [one.name, one.found, one.wanted, judged[one.right],
         "" if one.right is None else f"{one.seconds:.1f} s"]
        for one in answers
    ]  # fmt: skip
    print_table("self-check", ["answer", "found", "wanted", "", "took"], rows)
    if any(one.right is None for one in answers):
        print_line(
            "what would have to be compiled first was not asked: chatter compile does so in some "
            "minutes, then chatter doctor asks it too"
        )
