"""`chatter compile`: compiled code of every kind of computation, before anyone waits for it."""

from __future__ import annotations

from chatter.cli import options
from chatter.cli.progress import progress_bar
from chatter.report.console import print_json, print_line


def compile(json: options.Json = False) -> None:  # noqa: A001 - the command's name
    """Compile all kernels, some minutes; what is compiled already is passed over."""
    from chatter.first_steps.compile_kernels import compile_kernels
    from chatter.first_steps.installation import compiled_code

    with progress_bar("compiling; Ctrl-C ends it, and what is compiled is kept") as progress:
        asked = list(compile_kernels(progress.stage))
    state = compiled_code()
    if json:
        print_json({"questions": [one._asdict() for one in asked], "cache": state})
        return
    print_line(
        f"{len(asked)} kinds of computation are ready; {state['compiled_functions']} compiled "
        f"functions, {state['MB']} MB, are in {state['folder']}"
    )
    if not state["writable"]:
        print_line("that folder cannot be written: every start compiles anew")
