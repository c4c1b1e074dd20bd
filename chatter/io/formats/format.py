"""What a file format is: its name, its extensions, and what it can hold."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

from chatter.io.formats.model_parts import StoredMatrix, StoredNodes
from chatter.io.table import Table
from dynamics.frf.container import Frf

Content = Literal["FRFs", "signals", "matrices", "nodes"]
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
    read_records : callable, optional
        Path -> Tables by name, of a file that may hold several records; `read_signals` is then of
        a file that holds one.
    read_matrices : callable, optional
        Path -> list of StoredMatrix: what the file holds, symmetric or not, in its own units.
    read_nodes : callable, optional
        Path -> StoredNodes: nodes of a finite element model.
    recognises : callable, optional
        First bytes of a file -> True where the content is of this format whatever its extension.
    own_unit : str
        Of the signals behind the time, where the format knows no other.

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
    read_records: Callable[[Path], Mapping[str, Table]] | None = None
    read_matrices: Callable[[Path], list[StoredMatrix]] | None = None
    read_nodes: Callable[[Path], StoredNodes] | None = None
    recognises: Callable[[bytes], bool] = lambda head: False  # noqa: ARG005
    own_unit: str = ""

    @property
    def holds(self) -> tuple[Content, ...]:
        """What files of this format can hold."""
        readers = (self.read_frfs, self.read_signals, self.read_matrices, self.read_nodes)
        return tuple(c for c, reader in zip(CONTENTS, readers, strict=True) if reader is not None)
