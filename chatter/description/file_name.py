"""File names in a case: relative to the folder of the case file."""

import os
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, ValidationInfo, WithJsonSchema

from chatter.description.file_access import VARIABLE, is_allowed
from chatter.description.formatting import formatted

#: longest part of a path that file systems hold, bytes
_LONGEST_PART = 255


def is_file_name(given: Any) -> bool:
    """Whether a value can name a file."""
    return (
        isinstance(given, (str, Path))
        and bool(str(given))
        and str(given).isprintable()
        and all(len(os.fsencode(part)) <= _LONGEST_PART for part in Path(given).parts)
    )


def in_case_folder(given: Any, info: ValidationInfo) -> Path:
    """Path of a file that a case names; ValueError where it is no file name, or not allowed."""
    if not is_file_name(given):
        raise ValueError(
            f'{formatted(given)} is not a file name; one is required, such as "tap.uff"'
        )
    context = info.context or {}
    folder = context.get("folder", Path())
    if context.get("is_foreign") and (said := outside(folder, given)):
        raise ValueError(said)
    return folder / given


def outside(folder: Path, given: str | Path) -> str:
    """What is said of a file that a description in a folder may not name; empty where it may."""
    if is_allowed(folder / given, folder):
        return ""
    return (
        f"{formatted(str(given))} lies outside the folder of this file; where that is meant, allow "
        f"its folder: {VARIABLE}={(folder / given).parent.resolve()}"
    )


#: a file named relative to the folder of the case file
FileName = Annotated[
    Path, BeforeValidator(in_case_folder), WithJsonSchema({"type": "string", "minLength": 1})
]
