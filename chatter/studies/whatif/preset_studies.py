"""Preset studies: common questions, each one command on a shipped example."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from typing import Any

from chatter.description.errors import InputError
from chatter.description.toml_document import parse_document
from chatter.description.wording import nearest


@dataclass(frozen=True)
class PresetStudy:
    """A study with its paths and values."""

    name: str
    question: str
    example: str  # shipped example that it is made for, as folder/file
    vary: Sequence[str]  # as on the command line
    result: str
    #: patch of the case before anything varies
    settings: Mapping[str, Any] = field(default_factory=dict)
    only: Sequence[str] = ()  # names of [frf.NAME]
    quantity: str | None = None
    tornado: bool = False

    def file(self) -> Path:
        """Case or machine file of the shipped example; InputError if it is not there."""
        from chatter.io.shipped_examples import examples

        folders = {Path(one.folder).parent for one in examples().values()}
        for folder in folders:
            if (folder / self.example).is_file():
                return folder / self.example
        raise InputError(f"study {self.name}: the example {self.example} is not installed")


def preset_studies() -> dict[str, PresetStudy]:
    """Preset studies by name, from preset_studies.toml."""
    text = files("chatter.studies.whatif").joinpath("preset_studies.toml").read_text("utf-8")
    return {
        name: PresetStudy(name=name, **keys)
        for name, keys in parse_document(text, "preset_studies.toml").unwrap().items()
    }


def preset_study(name: str) -> PresetStudy:
    """Return a preset study; InputError if there is none of that name."""
    known = preset_studies()
    if name not in known:
        raise InputError(f'--study "{name}" is not known; {nearest(name, list(known))}')
    return known[name]
