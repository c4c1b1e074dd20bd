"""Folders that tests read, and the scripts of the shipped examples as modules."""

import importlib.util
from pathlib import Path
from types import ModuleType

ROOT = Path(__file__).resolve().parents[1]
EXAMPLES = ROOT / "examples"
DATA = ROOT / "tests" / "data"  # where from: README.md there


def example_module(example: str, script: str = "run") -> ModuleType:
    """Script of a shipped example, imported under a name of its own."""
    path = EXAMPLES / example / f"{script}.py"
    name = f"{example}_{script}".replace("-", "_")
    specification = importlib.util.spec_from_file_location(name, path)
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module
