"""File names in a case: relative to the folder of the case file."""

from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, ValidationInfo, WithJsonSchema

from chatter.description.formatting import formatted


def in_case_folder(given: Any, info: ValidationInfo) -> Path:
    """Path of a file that a case names; ValueError where it is no file name."""
    if not isinstance(given, (str, Path)) or not str(given) or not str(given).isprintable():
        raise ValueError(
            f'{formatted(given)} is not a file name; one is required, such as "tap.uff"'
        )
    return (info.context or {}).get("folder", Path()) / given


#: a file named relative to the folder of the case file
FileName = Annotated[
    Path, BeforeValidator(in_case_folder), WithJsonSchema({"type": "string", "minLength": 1})
]
