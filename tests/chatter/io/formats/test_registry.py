"""The registry of formats: its table in the docs, and every format read for all it can hold."""

from pathlib import Path

import numpy as np
import pytest

from chatter.io.formats.format import Format
from chatter.io.formats.format_list import FORMATS, documentation, format_of, read_frfs
from chatter.io.hammer_records import read_hammer_folder
from chatter.io.signals import read_signals
from chatter.io.table import Column, Table
from dynamics.frf.container import MeasurementError

DOCS = Path(__file__).resolve().parents[4] / "docs"
TIME = np.arange(40) * 1e-3


def test_the_table_in_the_docs_is_that_of_the_registry():
    page = (DOCS / "file-formats.md").read_text(encoding="utf-8")
    # the first table of the page; others are about other things
    before, _, _ = page.partition("\n## ")
    rows = [line for line in before.splitlines() if line.startswith("|")]
    assert len(rows) > 2
    assert set(rows) <= set(documentation().splitlines())


def test_every_format_says_what_it_holds():
    for one in FORMATS:
        assert one.holds, one.name
        assert all(e.startswith(".") and e == e.lower() for e in one.extensions), one.name


@pytest.mark.parametrize(
    "text",
    [
        "time [s],Fx [N]\n{},{}\n{},{}\n",
        "# sampled at 1 kHz\ntime [s]\tFx [N]\n{}\t{}\n{}\t{}\n",
        "time (s);Fx (N)\n{};{}\n{};{}\n",
    ],
)
def test_signals_in_tables_of_all_separators(tmp_path, text):
    cells = ["0,0", "1,5", "0,1", "2,5"] if ";" in text else ["0.0", "1.5", "0.1", "2.5"]
    path = tmp_path / "run.txt"
    path.write_text(text.format(*cells), encoding="utf-8")
    signals = read_signals(path, "milling")
    np.testing.assert_allclose(signals["time"], [0.0, 0.1])
    np.testing.assert_allclose(signals["Fx"], [1.5, 2.5])


def test_rows_that_begin_with_a_word_are_rows(tmp_path):
    path = tmp_path / "points.csv"
    text = "stable,spindle_speed [rpm],axial_depth [mm]\nchatter,9000,1\n,9000,2\n1,9000,0.5\n"
    path.write_text(text, encoding="utf-8")
    signals = read_signals(path)
    np.testing.assert_array_equal(signals["stable"], [0.0, np.nan, 1.0])
    np.testing.assert_allclose(signals["axial_depth"], [1e-3, 2e-3, 0.5e-3])


def test_frfs_of_archives(tmp_path):
    values = 1.0 + 2.0j * np.arange(40)
    np.savez(tmp_path / "tap.npz", **{"frequency [Hz]": 1e3 * TIME, "receptance [um/N]": values})
    (frf,) = read_frfs(tmp_path / "tap.npz")
    np.testing.assert_allclose(frf.values, 1e-6 * values)


def test_hammer_records_of_any_format(tmp_path):
    force, acceleration = np.sin(TIME), np.cos(TIME)
    np.savez(
        tmp_path / "tap1.npz",
        **{"time [s]": TIME, "force [kN]": force, "acceleration [g]": acceleration},
    )
    np.savetxt(
        tmp_path / "tap2.csv",
        np.column_stack([TIME, force, acceleration]),
        delimiter=",",
        header="time [s],force [kN],acceleration [g]",
    )
    first, second = read_hammer_folder(tmp_path).records
    np.testing.assert_allclose(first.force, 1e3 * force)
    np.testing.assert_allclose(first.force, second.force)
    np.testing.assert_allclose(first.response, second.response)
    assert first.sampling_rate == second.sampling_rate == pytest.approx(1000.0)


def test_a_format_of_another_package(tmp_path, monkeypatch):
    """An entry beside ours is read, recognised, and named where nothing else fits."""

    def read(path):
        values = np.frombuffer(path.read_bytes()[4:], dtype="<f8")
        return Table(path, (Column("time [s]", TIME[: values.size]), Column("Fx [N]", values)))

    rig = Format("rig", "rig recorder", "doubles behind RIG1", (".rig",), read_signals=read,
                 recognises=lambda head: head.startswith(b"RIG1"))  # fmt: skip
    monkeypatch.setattr(FORMATS, "_entries", {**FORMATS.entries, "rig": rig})
    path = tmp_path / "run.bin"
    path.write_bytes(b"RIG1" + np.arange(3.0).tobytes())
    np.testing.assert_array_equal(read_signals(path, "milling")["Fx"], [0.0, 1.0, 2.0])
    (tmp_path / "words.doc").write_text("words")
    with pytest.raises(MeasurementError, match=r"rig recorder \(\.rig\)"):
        format_of(tmp_path / "words.doc", "signals")
