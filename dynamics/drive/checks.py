"""Refusals of a drive's numbers, by the name of drive and key."""

from __future__ import annotations

import numpy as np

from dynamics.structure.linear_structure import StructureError


def require_not_negative(where: str, **values: float) -> None:
    """Refuse what is negative or not finite.

    Raises
    ------
    StructureError
        The message begins with `where` and names the key.
    """
    for what, value in values.items():
        if not (np.isfinite(value) and value >= 0.0):
            raise StructureError(f"{where}: {what} is {value}; it must be 0 or more")


def require_stiffness(where: str, **values: float) -> None:
    """Refuse a stiffness that is not above 0; infinite means rigid.

    Raises
    ------
    StructureError
        The message begins with `where` and names the key.
    """
    for what, value in values.items():
        if not value > 0.0:
            raise StructureError(
                f"{where}: {what} is {value}; it must be above 0 (infinite if rigid)"
            )


def require_not_zero(where: str, **values: float) -> None:
    """Refuse zero and what is not finite.

    Raises
    ------
    StructureError
        The message begins with `where` and names the key.
    """
    for what, value in values.items():
        if not np.isfinite(value) or value == 0.0:
            raise StructureError(f"{where}: {what} is {value}; it must be finite and not 0")
