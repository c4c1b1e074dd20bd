"""What all sections of the case file share."""

from collections.abc import Sequence

from pydantic import BaseModel, ConfigDict


class Section(BaseModel):
    """A table of the case file: immutable, unknown keys refused."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class SectionError(ValueError):
    """Several problems of one section: (key, sentence) each; an empty key means the section."""

    def __init__(self, problems: Sequence[tuple[str, str]]) -> None:
        self.problems = tuple(problems)
        super().__init__("; ".join(text for _, text in problems))


def raise_if_any(problems: Sequence[tuple[str, str]]) -> None:
    """Raise the problems found, all together."""
    if problems:
        raise SectionError(problems)
