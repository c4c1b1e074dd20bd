"""`chatter new`: a first case by five questions."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from chatter.description.errors import InputError
from chatter.report.console import print_line, print_message, print_written

Answer = str | None


def new(
    case: Annotated[
        Path, typer.Argument(metavar="[CASE]", help="File to write; it must not be there yet.")
    ] = Path("case.toml"),
    tool: Annotated[Answer, typer.Option(help='Such as "12 mm, 4".')] = None,
    material: Annotated[Answer, typer.Option(help='Such as "Al7075-T6".')] = None,
    cut: Annotated[Answer, typer.Option(help='Such as "8000 rpm, 0.05 mm, 1 mm".')] = None,
    engagement: Annotated[Answer, typer.Option(help='Such as "down, 6 mm" or "slot".')] = None,
    dynamics: Annotated[
        Answer, typer.Option(help='Such as "900 Hz, 0.03, 15 N/um" or "x.uff, y.uff".')
    ] = None,
) -> None:
    """Write a first case from five answers, asked for where they are not given."""
    from chatter.first_steps.first_case import first_case

    if case.exists():
        raise InputError(f"{case}: is there already; name another file, or remove it")
    given = {
        "tool": tool,
        "material": material,
        "cut": cut,
        "engagement": engagement,
        "dynamics": dynamics,
    }
    answers = {name: answer or _asked(name) for name, answer in given.items()}
    text = first_case(answers, case.parent)
    case.parent.mkdir(parents=True, exist_ok=True)
    case.write_text(text, encoding="utf-8")
    print_written([case])
    print_line(f"now: chatter check {case}; chatter lobes {case}")


def _asked(name: str) -> str:
    """Ask until the answer has its parts."""
    from chatter.first_steps.first_case import QUESTIONS, check_answer

    question = QUESTIONS[name]
    while True:
        try:
            answer = typer.prompt(question.text, default=question.example)
        except typer.Abort:
            raise InputError(
                f"{name}: no answer; give it as --{name} where there is no one to ask"
            ) from None
        try:
            check_answer(name, answer)
        except InputError as error:
            print_message(str(error))
            continue
        return answer
