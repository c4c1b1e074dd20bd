"""Pictures and pages of results, loaded when they are asked for.

Results know how to plot and save themselves, yet no layer imports the pictures above it: a result
names the module of `chatter.plots` or `chatter.report` that presents it.
"""

from importlib import import_module
from types import ModuleType


def presentation(module: str) -> ModuleType:
    """Return a module of pictures or pages, such as ``"plots.stability_diagram"``."""
    return import_module(f"chatter.{module}")
