"""Mode shapes of a machine, drawn by the corners of its bodies and the nodes of its beams."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from chatter.compile.machine_parts import assembled_machine
from chatter.description.machine.machine_file import MachineFile
from chatter.description.machine.machine_or_path import takes_machine_or_path
from chatter.io.presentation import presentation
from chatter.io.result_files import NotebookResult, as_json, write_results
from dynamics.reduction.modal_truncation import undamped_modes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: modes below this are motions of the whole that nothing resists, Hz
_RIGID = 0.5
_BEAM_POINTS = 13
#: corners of a block, of which neighbours differ in one place, are its edges
_CORNERS = tuple(itertools.product((-0.5, 0.5), repeat=3))
_EDGES = tuple(
    (a, b)
    for a, b in itertools.combinations(range(8), 2)
    if sum(p != q for p, q in zip(_CORNERS[a], _CORNERS[b], strict=True)) == 1
)


@dataclass(frozen=True, eq=False, repr=False)
class ModeShapes(NotebookResult):
    """Undamped modes of a machine without its control.

    Parameters
    ----------
    machine : str
    frequency : (m,) array of float
        Natural frequencies, Hz, ascending.
    points : (p, 3) array of float
        Places of the machine at rest, m.
    shapes : (m, p, 3) array of float
        Displacement of the places in each mode, the largest of a mode being 1.
    lines : (l, 2) array of int
        Places that are joined by a line.
    """

    machine: str
    frequency: NDArray[np.float64]
    points: NDArray[np.float64]
    shapes: NDArray[np.float64]
    lines: NDArray[np.int64]

    def __repr__(self) -> str:
        """Short: the arrays would fill the screen."""
        return f"<ModeShapes {self.machine!r}, {len(self.frequency)} modes>"

    def summary(self) -> dict:
        """Content of summary.json."""
        return {"machine": self.machine, "frequencies_Hz": self.frequency.tolist()}

    def plot(self) -> Figure:
        """Return a picture of the first modes."""
        return presentation("plots.mode_shapes").plot_mode_shapes(self)

    def save(self, folder: str | Path) -> list[Path]:
        """Write summary.json, mode-shapes.npz and mode-shapes.png."""
        written = write_results(
            folder, {"summary.json": as_json(self.summary())}, {"mode-shapes.png": self.plot()}
        )
        path = Path(folder) / "mode-shapes.npz"
        arrays = ("frequency", "points", "shapes", "lines")
        np.savez(path, **{name: getattr(self, name) for name in arrays})
        return [*written, path]


@takes_machine_or_path
def mode_shapes(file: MachineFile, count: int = 12) -> ModeShapes:
    """Mode shapes of a machine, of the lowest elastic modes.

    Parameters
    ----------
    file : MachineFile
    count : int, optional
        Largest number of modes.

    Returns
    -------
    ModeShapes

    Raises
    ------
    InputError
        If the machine cannot be assembled.
    """
    machine = assembled_machine(file)
    modes = undamped_modes(machine.structure)
    elastic = np.flatnonzero(modes.frequency > _RIGID)[:count]
    places, lines = _outline(file)
    rows = [machine.assembly.motion("mode shapes", part, at)[:3] for part, at in places]
    basis = machine.basis
    moved = np.array([row if basis is None else row @ basis for row in rows])  # (p, 3, n)
    shapes = np.moveaxis(moved @ modes.shapes[:, elastic], 2, 0)
    size = np.linalg.norm(shapes, axis=2).max(axis=1)
    points = np.array([at for _, at in places])
    return ModeShapes(
        file.title or file.name,
        modes.frequency[elastic],
        points,
        shapes / np.where(size > 0.0, size, 1.0)[:, None, None],
        np.array(lines, dtype=np.int64).reshape(-1, 2),
    )


PartPoint = tuple[str, NDArray[np.float64]]


def _outline(file: MachineFile) -> tuple[list[PartPoint], list[tuple[int, int]]]:
    """Part and place (m) of every point that is drawn, and which are joined."""
    places: list[PartPoint] = []
    lines: list[tuple[int, int]] = []
    for name, at, joined in (*_blocks(file), *_beams(file)):
        lines += [(len(places) + a, len(places) + b) for a, b in joined]
        places += [(name, one) for one in at]
    return places, lines


Outline = tuple[str, NDArray[np.float64], tuple[tuple[int, int], ...]]


def _blocks(file: MachineFile) -> Iterator[Outline]:
    for name, body in file.body.items():
        centre = np.asarray(body.centre, dtype=np.float64)
        if body.size is None:
            yield name, centre[None, :], ()
        else:
            yield name, centre + np.array(_CORNERS) * np.asarray(body.size), _EDGES


def _beams(file: MachineFile) -> Iterator[Outline]:
    joined = tuple((k, k + 1) for k in range(_BEAM_POINTS - 1))
    for name, beam in file.beam.items():
        axis = np.asarray(beam.axis, dtype=np.float64)
        length = sum(one.length for one in beam.segments)
        stations = np.linspace(0.0, length, _BEAM_POINTS)
        origin = np.asarray(beam.origin, dtype=np.float64)
        yield name, origin + stations[:, None] * (axis / np.linalg.norm(axis)), joined
