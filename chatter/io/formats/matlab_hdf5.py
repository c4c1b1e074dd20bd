"""Variables of MAT files of version 7.3, which are HDF5, read by h5py."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from chatter.io.formats.matlab_nodes import DEPTH, Node, require_count
from chatter.io.formats.named_arrays import require_size
from dynamics.frf.container import MeasurementError

#: characters of a text that may name a unit
_LONGEST_TEXT = 256


def variables_of_hdf5(path: Path) -> dict[str, Node]:
    """Numbers, texts and structures of a file by name; links to other files are not followed.

    MeasurementError if h5py is not installed, the file cannot be read, or it holds too much.
    """
    try:
        import h5py
    except ImportError as error:
        raise MeasurementError(
            f'{path}: MAT files of version 7.3 are read with h5py: install "chatter[formats]", '
            "or save with -v7"
        ) from error
    try:
        with h5py.File(path, "r") as file:
            return _Reader(path, h5py, file).structure(file, 0)
    except MeasurementError:
        raise
    except Exception as error:  # whatever the library raises on a broken file
        raise MeasurementError(f"{path}: is no MAT file that can be read: {error}") from error


class _Reader:
    """Items of a file as nodes; what was read is counted, so that references cannot multiply it."""

    def __init__(self, path: Path, h5py: Any, file: Any) -> None:
        self.path, self.h5py, self.file = path, h5py, file
        self.read = 0.0

    def structure(self, group: Any, depth: int) -> dict[str, Node]:
        """Fields of a structure, or variables of the file."""
        nodes = {name: self.node(item, depth) for name, item in self._own_items(group)}
        return {name: one for name, one in nodes.items() if one is not None}

    def node(self, item: Any, depth: int) -> Node | None:
        """Numbers, text, structure or list of elements; None of what is none of these."""
        if isinstance(item, self.h5py.Group):
            if depth > DEPTH or "MATLAB_sparse" in item.attrs:
                return None
            elements = self._elements_of_array(item)
            if elements is None:
                return self.structure(item, depth + 1)
            return [self._fields(one, depth + 1) for one in elements]
        if item.external or item.is_virtual:
            return None
        if item.dtype == self.h5py.ref_dtype:
            nodes = [self.node(self.file[one], depth + 1) for one in self._references(item)]
            return [one for one in nodes if one is not None] if depth <= DEPTH else None
        kind = item.attrs.get("MATLAB_class", b"")
        if not _is_plain(item.dtype):
            return None
        self._count(item)
        if bytes(kind) == b"char":
            return _text(item[()]) if item.size <= _LONGEST_TEXT else None
        is_number = kind in (b"", b"double", b"single") or bytes(kind).startswith((b"int", b"uint"))
        return _numbers(item[()]) if is_number else None

    def _own_items(self, group: Any) -> Iterator[tuple[str, Any]]:
        for name in group:
            is_here = isinstance(group.get(name, getlink=True), self.h5py.HardLink)
            if is_here and not name.startswith("#"):
                yield name, group[name]

    def _elements_of_array(self, group: Any) -> list[dict[str, Any]] | None:
        """Items of the elements of a structure array; None of a single structure.

        Each field of an array is a dataset of references, one an element; that of a cell array
        says that it is one.
        """
        fields = dict(self._own_items(group))
        is_array = fields and all(
            isinstance(one, self.h5py.Dataset)
            and one.dtype == self.h5py.ref_dtype
            and "MATLAB_class" not in one.attrs
            for one in fields.values()
        )
        if not is_array or len({one.size for one in fields.values()}) > 1:
            return None
        columns = {name: self._references(one) for name, one in fields.items()}
        count = len(next(iter(columns.values())))
        return [{name: self.file[one[k]] for name, one in columns.items()} for k in range(count)]

    def _fields(self, items: dict[str, Any], depth: int) -> dict[str, Node]:
        nodes = {name: self.node(item, depth) for name, item in items.items()}
        return {name: one for name, one in nodes.items() if one is not None}

    def _references(self, dataset: Any) -> list[Any]:
        """References in the order of MATLAB, as many as are followed."""
        require_count(self.path, dataset.name, dataset.size)
        return [one for one in np.asarray(dataset[()]).ravel() if one]

    def _count(self, dataset: Any) -> None:
        self.read += float(max(dataset.dtype.itemsize, 8)) * float(dataset.size)
        require_size(self.path, self.read)


def _is_plain(dtype: np.dtype) -> bool:
    """Whether elements are single numbers, real or complex; others may be of any size."""
    if dtype.names == ("real", "imag"):
        return all(dtype[name].kind in "fiu" for name in dtype.names)
    return dtype.kind in "fiu"


def _text(codes: np.ndarray) -> str | None:
    """Text of the codes of its characters."""
    if codes.dtype.kind not in "ui":
        return None
    return "".join(chr(int(one)) for one in codes.ravel())


def _numbers(values: np.ndarray) -> np.ndarray:
    """Array as MATLAB has it: HDF5 holds it transposed, complex numbers as two fields."""
    if getattr(values.dtype, "names", None) == ("real", "imag"):
        values = values["real"] + 1j * values["imag"]
    return np.asarray(values).T
