"""Errors of the machine's mechanics and control, told by file and key."""

import re
from collections.abc import Iterator
from contextlib import contextmanager

from chatter.description.errors import InputError
from dynamics.control.sampling import ControlError
from dynamics.structure.linear_structure import StructureError
from dynamics.trajectory.motion import TrajectoryError


def sentence(error: ValueError, key: str = "") -> str:
    """What an error says, without the name of the part that a key says already."""
    text = str(error)
    if "." not in key:
        return text
    kind, name = key.split(".")[:2]
    return re.sub(rf'^(?:{kind}|{kind} part) "{re.escape(name)}":? ', "", text)


@contextmanager
def machine_errors(name: str, key: str = "") -> Iterator[None]:
    """Turn errors of the machine into errors of input.

    An InputError names the file and the path of the key; none if it is the machine as a whole.
    """
    try:
        yield
    except (StructureError, ControlError, TrajectoryError) as error:
        where = f"{name}: {key}: " if key else f"{name}: "
        raise InputError(where + sentence(error, key)) from error
