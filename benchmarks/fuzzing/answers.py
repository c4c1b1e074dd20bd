"""What is asked of each kind of input, by a call of Python or by a command."""

from __future__ import annotations

import contextlib
import shutil
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import tomlkit
from hypothesis import strategies as st
from typer.testing import CliRunner

import chatter
from benchmarks.fuzzing import damaged_bytes
from benchmarks.fuzzing.from_schema import Schema, documents
from benchmarks.fuzzing.from_shipped import changed
from benchmarks.fuzzing.isolated import ANSWERED, FAILED, refusal
from benchmarks.fuzzing.odd_records import odd_tables
from benchmarks.fuzzing.sample_files import REPOSITORY, write_samples
from chatter.cli import program
from chatter.description.case import load
from chatter.description.errors import InputError
from chatter.description.json_schema import machine_schema
from chatter.description.machine.machine_file import load_machine
from chatter.explain.measurement_file import read_measurement
from chatter.explain.measurement_schema import measurement_schema
from chatter.io.formats.format_list import read_frfs
from chatter.io.matrices import read_matrix, read_nodes
from chatter.io.stated_columns import read_signal_table
from chatter.simulation.virtual_tests.from_file import default_frfs, frfs
from dynamics.frf.container import MeasurementError
from dynamics.structure.linear_structure import StructureError

EXAMPLES, SETS = REPOSITORY / "examples", REPOSITORY / "tests/data/measurements"
CASES = (
    "one-degree-of-freedom/case.toml",
    "two-insert-cutter/case.toml",
    "chattering-cut/case.toml",
    "flexible-workpiece/case.toml",
    "face-mill-chatter/case.toml",
    "friction-amplitude/case.toml",
    "pitch-design/case.toml",
    "best-cut/case.toml",
)
MACHINES = (
    "machine-gantry/machine.toml",
    "machine-coupled-milling/machine.toml",
    "machine-drive-control/machine.toml",
    "face-mill-chatter/machine.toml",
    "friction-amplitude/machine.toml",
)
MEASUREMENTS = ("set-104", "set-111", "set-121", "set-131", "set-132")
KINDS = ("case", "machine", "measurement", "file")

Answer = Callable[[Path], str | None]


@dataclass(frozen=True)
class Source:
    """Where inputs of one kind come from, and what is asked of them.

    Parameters
    ----------
    kind, name : str
        As reported.
    path : Path
        File that an input is written to; beside it lies what it refers to.
    whole : bytes
        Content that is not damaged.
    inputs : SearchStrategy of bytes
        Contents to be written.
    answers : tuple of callable
        Path -> `ANSWERED` or None, or an error.
    """

    kind: str
    name: str
    path: Path
    whole: bytes
    inputs: st.SearchStrategy[bytes] = field(repr=False)
    answers: tuple[Answer, ...] = field(repr=False)


def _short(path: Path) -> dict[str, Any]:
    """Changes that make a simulation short."""
    simulation = load(path).simulation
    if simulation is not None and simulation.revolutions:
        return {"simulation.revolutions": min(simulation.revolutions, 10)}
    return {"simulation.duration": "0.2 s"}


def checked(path: Path) -> None:
    """Verdict by the zeroth-order solution."""
    chatter.check(load(path), method="zero-order").summary()


def checked_by_default(path: Path) -> None:
    """Verdict by the method that the case asks for."""
    chatter.check(load(path)).summary()


def simulated(path: Path) -> None:
    """Cut of a few revolutions."""
    changes = _short(path)
    chatter.simulate(load(path).patch(changes)).summary()


def linearised(path: Path) -> None:
    """Linearised FRFs of a machine."""
    machine = load_machine(path)
    sections = dict(machine.frf) or default_frfs(machine)
    frfs(
        machine, {k: one.model_copy(update={"by": "linearised"}) for k, one in sections.items()}
    ).summary()


def moved(path: Path) -> None:
    """First move of a machine."""
    machine = load_machine(path)
    for name in list(machine.move)[:1]:
        chatter.move(machine, name).summary()


def read_set(path: Path) -> None:
    """Measurement as it is read."""
    read_measurement(path.parent)


def compared(path: Path) -> None:
    """Prediction of a measurement beside it."""
    chatter.compare(path.parent).summary()


def read_as_all(path: Path) -> None:
    """File of a format read as all that files can hold."""
    readers = (read_frfs, read_signal_table, read_matrix, lambda path: read_nodes(path, 6))
    refusals = []
    for reader in readers:
        try:
            reader(path)
        except (MeasurementError, StructureError, InputError) as error:
            refusals.append(error)
    for error in refusals:
        # each of them as if it were the only one
        if path.name not in str(error):
            raise error
    if len(refusals) == len(readers):
        raise InputError(str(refusals[0]))


def modal_fit(path: Path) -> None:
    """Modes of the FRFs of a file."""
    chatter.modes(path).summary()


def listened_to(path: Path) -> None:
    """Chatter in the signals of a file."""
    chatter.detect(path, teeth=4, spindle_speed="3000 rpm").summary()


def command(*words: str) -> Answer:
    """Command on the file: exit code 0, or 2 and 1 with a message; never a fault of the program."""

    def asked(path: Path) -> str | None:
        with tempfile.TemporaryDirectory() as out:
            after = [out if word == "OUT" else word for word in words[1:]]
            result = CliRunner().invoke(program, [words[0], str(path), *after])
        said = result.stderr
        if "a fault in chatter itself" in said:
            return said.strip()[:1500]
        if result.exception is not None and not isinstance(result.exception, SystemExit):
            return f"traceback of {type(result.exception).__name__}: {result.exception}"
        if result.exit_code == 0:
            return ANSWERED
        if result.exit_code == 1:
            return FAILED
        lines = [line for line in said.splitlines() if line.startswith("chatter: ")]
        named = (path.name, path.parent.name)
        return refusal(lines, named) if lines else f"exit {result.exit_code} without a message"

    asked.__name__ = f"command {words[0]}"
    return asked


_CASE = (
    checked,
    checked_by_default,
    simulated,
    command("check"),
    command("simulate", "--signals", "none", "--set", "simulation.revolutions=5", "--out", "OUT"),
)
_MACHINE = (linearised, moved, command("frf", "--out", "OUT"))
_MEASUREMENT = (read_set, compared)
#: what is asked of files by what they hold: FRFs and taps, recordings, anything
_FILE = {
    "tap": (read_as_all, modal_fit, listened_to, command("modes", "--out", "OUT")),
    "trace": (read_as_all, listened_to),
    "": (read_as_all,),
}
_FRFS = ("beam", "tool", "frf")


def _as_toml(data: dict[str, Any]) -> bytes:
    return tomlkit.dumps(data).encode("utf-8", "replace")


def _documents(file: Path, schema: Schema) -> tuple[bytes, st.SearchStrategy[bytes]]:
    """Shipped content, and changes of it, whole documents of the schema and damaged text."""
    whole = file.read_bytes()
    shipped = changed(tomlkit.parse(whole.decode()).unwrap(), schema).map(_as_toml)
    return whole, st.integers(0, 19).flatmap(
        lambda k: (
            damaged_bytes.damaged(whole)
            if k == 0
            else documents(schema).map(_as_toml)
            if k <= 2
            else shipped
        )
    )


def sources(folder: Path, kinds: tuple[str, ...] = KINDS) -> Iterator[Source]:
    """All sources of some kinds, their files in a folder."""
    schemas = (
        ("case", CASES, EXAMPLES, chatter.schema(), _CASE),
        ("machine", MACHINES, EXAMPLES, machine_schema(), _MACHINE),
        (
            "measurement",
            tuple(f"{one}/measurement.toml" for one in MEASUREMENTS),
            SETS,
            measurement_schema(),
            _MEASUREMENT,
        ),
    )
    for kind, names, root, schema, answers in schemas:
        for name in names if kind in kinds else ():
            file = root / name
            beside = folder / kind / file.parent.name
            with contextlib.suppress(FileExistsError):
                shutil.copytree(file.parent, beside)
            whole, inputs = _documents(file, schema)
            yield Source(kind, name, beside / file.name, whole, inputs, answers)
    if "file" in kinds:
        for path in write_samples(folder / "file"):
            whole = path.read_bytes()
            inputs = damaged_bytes.damaged(whole)
            if path.name == "tap.csv":
                inputs |= odd_tables(whole)
            stem = "tap" if path.stem in _FRFS else path.stem.rstrip("0123456789")
            answers = _FILE.get("trace" if stem in ("cut", "mr") else stem, _FILE[""])
            yield Source("file", path.name, path, whole, inputs, answers)
