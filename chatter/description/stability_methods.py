"""Names of stability methods in files: those of the registry, which lies above this layer.

The registry is imported when a name is checked or the schema is written; it loads no compiled code.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any


def method_names() -> tuple[str, ...]:
    """``"auto"`` and the names of all methods."""
    registry = import_module("chatter.stability.registry")
    return (registry.AUTO, *registry.METHODS.names())


def known_method(name: str) -> str:
    """Name of a method, where there is one of it.

    Raises
    ------
    ValueError
        If there is no such method.
    """
    if name not in method_names():
        known = ", ".join(f'"{known}"' for known in method_names())
        raise ValueError(f'method "{name[:60]}" is not known; there are {known}')
    return name


def with_methods(schema: dict[str, Any]) -> None:
    """Enter the names into a JSON schema."""
    schema["enum"] = list(method_names())
