"""State space of a machine, with names and units, for other programs."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from chatter.compile.linearised_friction import closed_backlashes
from chatter.description.errors import InputError
from chatter.description.given_values import texts_given
from chatter.description.machine.frequency_response import StateSection, parse_tested_point
from chatter.description.machine.machine_file import MachineFile
from chatter.description.machine.machine_or_path import takes_machine_or_path
from chatter.description.whole_files import write_whole
from chatter.io.result_files import as_json, short_repr, write_results
from chatter.simulation.virtual_tests.from_file import in_state, is_rotation, row_of_point
from dynamics.machine.state_space import StateSpace, state_space


@dataclass(frozen=True, eq=False, repr=False)
class StateSpaceExport:
    """State space of a machine between named places.

    Parameters
    ----------
    file : MachineFile
    system : StateSpace
    inputs, outputs : tuple of str
        Places such as ``"motor:Y"`` and ``"tool/work:x"``.
    input_units, output_units : tuple of str
        ``"N"`` or ``"N*m"``, ``"m"`` or ``"rad"``.
    assumed : tuple of str
        What was made linear.
    """

    file: MachineFile
    system: StateSpace
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    input_units: tuple[str, ...]
    output_units: tuple[str, ...]
    assumed: tuple[str, ...] = ()

    def __repr__(self) -> str:
        """Short: the matrices would fill the screen."""
        return short_repr(self)

    def summary(self) -> dict[str, Any]:
        """Content of summary.json."""
        poles = np.linalg.eigvals(self.system.a)
        elastic = np.unique(np.round(np.abs(poles[poles.imag > 0.0]) / (2.0 * np.pi), 6))
        return {
            "machine": self.file.name,
            "states": len(self.system.a),
            "inputs": self._listed(self.inputs, self.input_units),
            "outputs": self._listed(self.outputs, self.output_units),
            "natural_frequencies_Hz": elastic.tolist(),
            "notes": [
                "control loops are open and frictions are left out; preload and weight do not show",
                *self.assumed,
            ],
        }

    @staticmethod
    def _listed(names: Sequence[str], units: Sequence[str]) -> list[dict[str, str]]:
        return [{"name": name, "unit": unit} for name, unit in zip(names, units, strict=True)]

    def arrays(self) -> dict[str, Any]:
        """Matrices, names and units by name, as they are written."""
        system = self.system
        return {
            "A": system.a,
            "B": system.b,
            "C": system.c,
            "D": system.d,
            "input_names": np.array(self.inputs),
            "input_units": np.array(self.input_units),
            "output_names": np.array(self.outputs),
            "output_units": np.array(self.output_units),
        }

    def save(self, folder: str | Path) -> list[Path]:
        """Write state_space.npz, state_space.mat and summary.json."""
        folder = Path(folder)
        written = write_results(folder, {"summary.json": as_json(self.summary())}, {})
        arrays = self.arrays()
        names = {key: value for key, value in arrays.items() if value.dtype.kind == "U"}
        matrices = {key: value for key, value in arrays.items() if key not in names}
        content = io.BytesIO()
        np.savez_compressed(content, **arrays)
        write_whole(folder / "state_space.npz", content.getvalue())
        cells = {key: value.astype(object).reshape(-1, 1) for key, value in names.items()}
        content = io.BytesIO()
        scipy.io.savemat(content, {**matrices, **cells}, do_compression=True)
        write_whole(folder / "state_space.mat", content.getvalue())
        return [*written, folder / "state_space.npz", folder / "state_space.mat"]


@takes_machine_or_path
def export(
    machine: MachineFile,
    inputs: Sequence[str] = (),
    outputs: Sequence[str] = (),
    state: StateSection | None = None,
) -> StateSpaceExport:
    """State space of a machine's structure, its control loops open, without friction.

    Parameters
    ----------
    machine : MachineFile, or the path of its file
    inputs, outputs : sequence of str
        Places such as ``"motor:Y"``, ``"table:y"`` or ``"tool/work:x"``. By default the motors
        under control and the tool against the workpiece along x, y and z, both ways.
    state : StateSection, optional
        What holds the axes, and where they stand.

    Raises
    ------
    InputError
        If there is no such place, or the machine names none by itself.
    """
    file = machine
    assembled = in_state(file, state or StateSection())
    usual = _usual(file, [drive.axis for drive in assembled.drives])
    names = (
        texts_given(inputs, "places of inputs") or usual,
        texts_given(outputs, "places of outputs") or usual,
    )
    for name in (*names[0], *names[1]):
        try:
            parse_tested_point(name)
        except ValueError as error:
            raise InputError(f"{file.name}: {error}") from error
    if not all(names):
        raise InputError(
            f"{file.name}: no axis is under control and tool_point is missing; say what is excited "
            'and read, such as --excite "table:y"'
        )
    rows = [
        np.array([row_of_point(f"{file.name}: {name}", assembled, name) for name in group])
        for group in names
    ]
    turning = [[is_rotation(file, name) for name in group] for group in names]
    return StateSpaceExport(
        file,
        state_space(assembled.structure, *rows),
        names[0],
        names[1],
        tuple("N*m" if turns else "N" for turns in turning[0]),
        tuple("rad" if turns else "m" for turns in turning[1]),
        closed_backlashes(assembled),
    )


def _usual(file: MachineFile, driven: Sequence[str]) -> tuple[str, ...]:
    """Motors under control, and the tool against the workpiece."""
    places = [f"motor:{name}" for name in dict.fromkeys(driven)]
    if file.tool_point is not None:
        against = f"/{file.workpiece}" if file.workpiece else ""
        places += [f"{file.tool_point}{against}:{axis}" for axis in "xyz"]
    return tuple(places)
