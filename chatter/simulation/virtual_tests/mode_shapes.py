"""Mode shapes of a machine, drawn by the outlines of its parts."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from chatter.compile.machine_parts import assembled_machine
from chatter.description.given_values import whole_number_given
from chatter.description.machine.machine_file import MachineFile
from chatter.description.machine.machine_or_path import takes_machine_or_path
from chatter.io.presentation import presentation
from chatter.io.result_files import NotebookResult, as_json, write_results
from chatter.simulation.virtual_tests.outline import outlines
from dynamics.reduction.modal_truncation import undamped_modes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: modes below this are motions of the whole that nothing resists, Hz
_RIGID = 0.5
#: most modes that one may ask for
_MOST_MODES = 10_000


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
        """Write summary.json, frequencies.csv, mode-shapes.npz and mode-shapes.png."""
        rows = [f"{number},{f:.6g}" for number, f in enumerate(self.frequency, start=1)]
        texts = {
            "summary.json": as_json(self.summary()),
            "frequencies.csv": "\n".join(["mode,natural frequency [Hz]", *rows]) + "\n",
        }
        written = write_results(folder, texts, {"mode-shapes.png": self.plot()})
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
    count = whole_number_given(count, "count of modes", 1, _MOST_MODES)
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
    for one in outlines(file):
        lines += [(len(places) + a, len(places) + b) for a, b in one.lines]
        places += [(one.part, point) for point in one.points]
    return places, lines
