"""What a file format is: its name, its extensions, and what it can hold."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

import scipy

from chatter.description.arrays import Array
from chatter.io.table import Table
from dynamics.frf.container import Frf

Content = Literal["FRFs", "signals", "matrices"]
CONTENTS: tuple[Content, ...] = get_args(Content)


@dataclass(frozen=True)
class Format:
    """One file format: an entry of the registry, from its own module or another package.

    Parameters
    ----------
    name, label, help : str
        As in messages, in words, and one line for the documentation.
    extensions : tuple of str
        Lower case, with the dot.
    read_frfs : callable, optional
        Path -> list of Frf, in SI units, in the order of the file.
    read_signals : callable, optional
        Path -> Table: time records, or a table of points.
    read_matrix : callable, optional
        Path -> (n, m) array or sparse array.
    recognises : callable, optional
        First bytes of a file -> True where the content is of this format whatever its extension.

    Notes
    -----
    A reader raises `dynamics.frf.container.MeasurementError` naming file, line and reason.
    """

    name: str
    label: str
    help: str
    extensions: tuple[str, ...]
    read_frfs: Callable[[Path], list[Frf]] | None = None
    read_signals: Callable[[Path], Table] | None = None
    read_matrix: Callable[[Path], Array | scipy.sparse.sparray] | None = None
    recognises: Callable[[bytes], bool] = lambda head: False  # noqa: ARG005

    @property
    def holds(self) -> tuple[Content, ...]:
        """What files of this format can hold."""
        readers = (self.read_frfs, self.read_signals, self.read_matrix)
        return tuple(c for c, reader in zip(CONTENTS, readers, strict=True) if reader is not None)
