"""Tables of results as CSV and Parquet."""

import math

import numpy as np
import pytest

from chatter import InputError
from chatter.io.result_tables import Column, csv_text, write_table
from tests.cases import TOOL_OF_922_HERTZ
from tests.command_line import chatter_command

parquet = pytest.importorskip("pyarrow.parquet")

COLUMNS = {
    "depth [mm]": Column(np.array([1.23456789, math.nan, math.inf]), ".4g", infinite="inf"),
    "value": Column(["as given", 0.1, None], ".9g"),
    "stable": Column(np.array([True, False, True])),
    "name": Column(["a, b", "", "=1+1"]),
}


def test_csv_writes_numbers_in_their_form_and_nothing_for_none():
    assert csv_text(COLUMNS) == (
        'depth [mm],value,stable,name\n1.235,as given,true,"a, b"\n,0.1,false,\ninf,,true,\'=1+1\n'
    )


def test_an_infinite_number_without_a_word_is_nothing_in_csv():
    assert csv_text(
        {"x": Column([math.inf, 1.0], "g"), "y": Column([-math.inf, 2], "g", "inf")}
    ) == ("x,y\n,-inf\n1,2\n")


def test_parquet_keeps_all_digits_and_types(tmp_path):
    (path,) = write_table(tmp_path, "found", "parquet", COLUMNS)
    assert parquet.read_table(path).to_pydict() == {
        "depth [mm]": [1.23456789, None, math.inf],
        # a column has one type: texts where some are
        "value": ["as given", "0.1", None],
        "stable": [True, False, True],
        "name": ["a, b", "", "=1+1"],
    }


def test_no_table_of_another_kind_stays_beside_a_new_one(tmp_path):
    write_table(tmp_path, "found", "parquet", COLUMNS)
    write_table(tmp_path, "found", "csv", COLUMNS)
    assert [path.name for path in tmp_path.iterdir()] == ["found.csv"]
    assert write_table(tmp_path, "found", "none", COLUMNS) == []
    assert list(tmp_path.iterdir()) == []


def test_another_kind_is_refused(tmp_path):
    with pytest.raises(InputError, match='tables: "xlsx" is not known; there are csv, parquet'):
        write_table(tmp_path, "found", "xlsx", COLUMNS)


def commands(case):
    tornado = ("--vary", "material.Ktc=500 MPa,700 MPa", "--tornado", "--result", "critical-depth")
    over = ("--x", "cut.radial_depth=2 mm..8 mm:3")
    maps = ("--x", "cut.axial_depth=1 mm..2 mm:2", "--y", "cut.radial_depth=2 mm..8 mm:3")
    return {
        "whatif": ("whatif", case, *tornado, "--method", "zero-order"),
        "lobes": ("lobes", case, "--method", "zero-order", *over),
        "map": ("lobes", case, *maps),
    }


@pytest.mark.parametrize("name", ["whatif", "lobes", "map"])
def test_parquet_of_a_study_holds_the_numbers_of_its_csv(tmp_path, name):
    case, out = tmp_path / "case.toml", tmp_path / "out"
    case.write_text(TOOL_OF_922_HERTZ)
    words = (*commands(case)[name], "--out", out, "--tables")
    stem = "whatif" if name == "whatif" else "lobes"
    assert chatter_command(*words, "csv").exit_code == 0
    lines = [line.split(",") for line in (out / f"{stem}.csv").read_text().splitlines()]
    assert chatter_command(*words, "parquet").exit_code == 0
    columns = parquet.read_table(out / f"{stem}.parquet").to_pydict()
    assert list(columns) == lines[0]
    assert not (out / f"{stem}.csv").exists()
    for heading, cells in zip(lines[0], zip(*lines[1:], strict=True), strict=True):
        for cell, value in zip(cells, columns[heading], strict=True):
            if isinstance(value, str) or value is None:
                assert cell == (value or "")
            else:
                assert float(cell) == pytest.approx(value, rel=1e-6)


def test_an_unknown_kind_is_told_before_any_work(tmp_path):
    case = tmp_path / "case.toml"
    case.write_text(TOOL_OF_922_HERTZ)
    result = chatter_command("lobes", case, "--tables", "xlsx", "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert '--tables: "xlsx" is not known; there are csv, parquet, none' in result.stderr
    assert not (tmp_path / "out").exists()
