"""Commands of many options take them as one frozen dataclass; typer still sees each by itself."""

import functools
from collections.abc import Callable
from dataclasses import MISSING, fields
from inspect import Parameter, Signature
from typing import Any, TypeVar, get_type_hints

Options = TypeVar("Options")


def takes_options(command: Callable[[Options], None]) -> Callable[..., None]:
    """Let typer call a command whose only parameter is a dataclass of its options.

    Parameters
    ----------
    command : callable
        Its parameter is annotated by a frozen dataclass; the fields are annotated as typer wants
        parameters, and become the parameters of what is returned, in their order.
    """
    hints = get_type_hints(command)
    del hints["return"]
    (options,) = hints.values()
    annotations = get_type_hints(options, include_extras=True)

    @functools.wraps(command)
    def called(**given: Any) -> None:
        command(options(**given))

    parameters = [
        Parameter(
            field.name,
            Parameter.POSITIONAL_OR_KEYWORD,
            default=Parameter.empty if field.default is MISSING else field.default,
            annotation=annotations[field.name],
        )
        for field in fields(options)
    ]
    # where inspect.signature and typing.get_type_hints look, which typer asks
    called.__dict__["__signature__"] = Signature(parameters, return_annotation=None)
    called.__annotations__ = {**annotations, "return": None}
    return called
