"""A case on a machine of which sliders have changed values."""

from __future__ import annotations

import itertools
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from chatter.app.workbench.session import Session
from chatter.description.case import MACHINE_PATH, Case
from chatter.description.errors import InputError


def with_other_machine(session: Session, case: Case, values: Mapping[str, Any]) -> tuple[Case, str]:
    """Patch a case; a machine that is changed by it is saved as a new file beside the case.

    The file that the case names stays as it is: other cases may name it too.

    Returns
    -------
    Case, str
        The case, and the name of the new machine file; empty where the machine stays.
    """
    own = {path: one for path, one in values.items() if not path.startswith(MACHINE_PATH)}
    patched = case.patch(own) if own else case
    of_machine = {path: one for path, one in values.items() if path not in own}
    if not of_machine:
        return patched, ""
    path = _new_machine_path(session)
    case.patch(of_machine).machine_file().save(path)
    named = Path(os.path.relpath(path, session.folder)).as_posix()
    return patched.patch({"structure.machine": named}), named


def _new_machine_path(session: Session) -> Path:
    """Path of a machine file beside the open case that is not there yet."""
    stem = Path(session.name).stem
    for number in itertools.count(1):
        path = session.folder / f"{stem}-machine-{number}.toml"
        if not path.exists():
            return path
    raise InputError("no name is left for a machine file")
