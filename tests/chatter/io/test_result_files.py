"""What results write: whole or not at all, and inert in a spreadsheet."""

import csv
import io

import pytest

from chatter.description.whole_files import write_whole
from chatter.io.result_tables import Column, csv_of_rows, csv_text


@pytest.mark.parametrize(
    "hostile",
    [
        "=1+1",
        "+1+cmd|' /C calc'!A0",
        "-2+3+cmd|' /C calc'!A0",
        "@SUM(A1)",
        ' =HYPERLINK("x")',
        "|x",
    ],
)
def test_texts_are_no_formulas(hostile):
    for text in (csv_of_rows([["name"], [hostile]]), csv_text({"name": Column([hostile])})):
        _, (cell,) = csv.reader(io.StringIO(text))
        assert cell == f"'{hostile}"


@pytest.mark.parametrize("plain", ["-1.5", "+3e-9", "-0.5 mm", "-12 m/s^2", "-inf", "-", "a=b", ""])
def test_numbers_and_words_stay_as_they_are(plain):
    assert list(csv.reader(io.StringIO(csv_of_rows([["x", plain]])))) == [["x", plain]]


def test_a_text_with_a_comma_stays_one_cell():
    text = csv_text({"name": Column(["a, b"]), "depth [mm]": Column([1.25], ".3g")})
    assert list(csv.reader(io.StringIO(text))) == [["name", "depth [mm]"], ["a, b", "1.25"]]


def test_a_file_that_is_not_whole_leaves_the_old_one(tmp_path):
    path = tmp_path / "lobes.csv"
    write_whole(path, "old")

    def fails(file):
        file.write(b"half of the n")
        raise OSError(28, "No space left on device")

    with pytest.raises(OSError, match=r"No space left on device.*lobes\.csv"):
        write_whole(path, fails)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_rights_and_links_stay(tmp_path):
    path, link = tmp_path / "a.csv", tmp_path / "b.csv"
    path.write_text("old")
    path.chmod(0o640)
    link.symlink_to(path)
    write_whole(link, "new")
    assert link.is_symlink()
    assert path.read_text() == "new"
    assert path.stat().st_mode & 0o777 == 0o640
