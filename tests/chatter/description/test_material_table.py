"""A user's own table of materials, and what is printed of the coefficients of a case."""

import pytest

from chatter.description.case import load, loads
from chatter.description.errors import InputError
from chatter.description.material_table import name_of_row, read_material_table, row_named
from chatter.description.material_words import (
    coefficients_in_words,
    notes_on_material,
    thickest_chip,
)
from cutting.material.table import MATERIALS

OWN = """
["our steel"]
Ktc = "1800 MPa"
Krc = "700 MPa"
Kte = "25 N/mm"
source = "own tests, 2026-03-02"
chip_thickness = ["0.02 mm", "0.2 mm"]
examples = ["1.2343"]

["our titanium"]
law = "exponential"
Ktc = "1300 MPa"
h0 = "1 mm"
exponent = 0.76
source = "own tests, 2026-03-04"
"""
CASE = """
[tool]
kind = "end mill"
teeth = 2
diameter = "10 mm"
[material]
name = "our steel"
table = "materials.toml"
[cut]
mode = "down"
spindle_speed = "3000 rpm"
feed_per_tooth = "0.3 mm"
axial_depth = "1 mm"
radial_depth = "1 mm"
"""


@pytest.fixture
def own(tmp_path):
    (tmp_path / "materials.toml").write_text(OWN, encoding="utf-8")
    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    return tmp_path


def test_rows_of_an_own_table(own):
    case = load(own / "case.toml")
    assert case.material.values["Ktc"] == 1.8e9
    assert case.material.values["Kte"] == 25e3
    assert case.material.law == "linear"
    titanium = case.patch({"material.name": "our titanium"}).material
    assert (titanium.law, titanium.h0, titanium.exponent) == ("exponential", 1e-3, 0.76)


def test_a_case_that_is_saved_elsewhere_finds_its_table(own):
    case = load(own / "case.toml")
    case.save(own / "below" / "case.toml")
    assert load(own / "below" / "case.toml") == case


def test_values_beside_the_name_override_the_row(own):
    case = load(own / "case.toml").patch({"material.Krc": "900 MPa"})
    assert case.material.Krc == 9e8
    assert "Krc as in the case" in notes_on_material(case)[0]


def test_the_range_of_a_row_is_checked_against_the_thickest_chip(own):
    case = load(own / "case.toml")
    # h = f_z sin(phi), cos(phi) = 1 - 2/10: sin = 0.6
    assert thickest_chip(case) == pytest.approx(0.18e-3, rel=1e-12)
    assert len(notes_on_material(case)) == 1
    wide = case.patch({"cut.radial_depth": "6 mm"})
    assert thickest_chip(wide) == pytest.approx(0.3e-3, rel=1e-12)
    assert notes_on_material(wide)[-1] == (
        "material.name: the thickest chip is 0.3 mm, out of the range of the row, 0.02 to 0.2 mm"
    )


def test_coefficients_in_words():
    case = loads('[material]\nKtc = "1900 MPa"\nKre = "40 N/mm"')
    assert coefficients_in_words(case) == "coefficients: linear law, Ktc 1900 MPa, Kre 40 N/mm"
    assert notes_on_material(case) == []
    named = loads('[material]\nname = "brass (VDI 27)"')
    assert coefficients_in_words(named) == (
        "coefficients: brass (VDI 27): exponential law, Ktc 700 MPa, Krc 282.8 MPa, h0 1 mm, "
        "exponent 0.73"
    )
    source, assumption = notes_on_material(named)
    assert "ISCAR" in source
    assert "no range of the chip thickness is stated there" in source
    assert "assumption" in assumption
    assert coefficients_in_words(loads("title = 'no material'")) is None


@pytest.mark.parametrize(
    ("row", "problem"),
    [
        ('Ktc = "1800 MPa"', "x.source: is missing"),
        ('source = "s"', "x.Ktc: is missing"),
        ('source = "s"\nKtc = "1800 mm"', 'x.Ktc: "1800 mm" is a length'),
        ('source = "s"\nKtc = -1', "x.Ktc: must be above 0"),
        ('source = "s"\nKtc = "1 MPa"\nKtd = 1', "x.Ktd: unknown key"),
        ('source = "s"\nlaw = "cubic"\nKtc = "1 MPa"', 'x.law: "cubic" is no force law'),
        ('source = "s"\nKtc = "1 MPa"\niso_group = "Q"', "x.iso_group: must be one of P, M"),
        ('source = "s"\nKtc = "1 MPa"\nchip_thickness = ["2 mm", "1 mm"]', "x.chip_thickness:"),
        ('source = "s"\nKtc = "1 MPa"\nchip_thickness = "2 mm"', "x.chip_thickness:"),
        ('source = "s"\nKtc = "1 MPa"\nexamples = 3', "x.examples:"),
        ('source = 3\nKtc = "1 MPa"', "x.source: 3 is given, a text is required"),
    ],
)
def test_wrong_rows_are_named(tmp_path, row, problem):
    path = tmp_path / "own.toml"
    path.write_text(f"[x]\n{row}\n", encoding="utf-8")
    with pytest.raises(InputError) as wrong:
        read_material_table(path)
    assert any(text.startswith(f"{path}: {problem}") for text in wrong.value.messages)


def test_wrong_tables_are_named(tmp_path):
    def messages(text):
        with pytest.raises(InputError) as wrong:
            loads(text, "case.toml", tmp_path)
        return " ".join(wrong.value.messages)

    assert "there is no such file" in messages('[material]\nname = "x"\ntable = "none.toml"')
    assert "is given without name" in messages('[material]\ntable = "none.toml"')
    assert "is not a file name" in messages('[material]\nname = "x"\ntable = 3')
    (tmp_path / "own.toml").write_text('x = 3\n["y"]\nKtc = 1e9\nsource = "s"\n', encoding="utf-8")
    assert "x: 3 is given, a table of a row" in messages(
        '[material]\nname = "y"\ntable = "own.toml"'
    )
    (tmp_path / "own.toml").write_text('["yy"]\nKtc = 1e9\nsource = "s"\n', encoding="utf-8")
    assert 'did you mean "yy"?' in messages('[material]\nname = "y"\ntable = "own.toml"')


@pytest.mark.parametrize(
    ("grade", "rows"),
    [
        ("ti6al4v", ["alpha and beta alloy, hardened (VDI 37)", "(VDI 37, 2017)"]),
        ("C45", ["(VDI 2)", "hardened (VDI 3)"]),
        ("1.0503", ["(VDI 2)", "(VDI 3)"]),
        ("42 CrMo 4", ["(VDI 7)", "(VDI 8)", "(VDI 9)"]),
    ],
)
def test_a_grade_is_answered_by_the_rows_of_its_conditions(grade, rows):
    with pytest.raises(
        ValueError, match=r"is a grade of [23] rows; the name of a row chooses"
    ) as found:
        row_named(grade)
    assert all(row in str(found.value) for row in rows)


@pytest.mark.parametrize(
    ("grade", "group"), [("316L", "VDI 14"), ("AISI 316 L", "VDI 14"), ("inconel 718", "VDI 34")]
)
def test_a_grade_of_one_row_is_that_row(grade, group):
    assert group in name_of_row(grade)


@pytest.mark.parametrize("word", ["steel", "silicon", "grade", "alloy"])
def test_a_word_of_many_grades_is_none(word):
    with pytest.raises(ValueError, match=r"is not in the table|is a grade of \d+ rows"):
        row_named(word)


@pytest.mark.parametrize(
    ("condition", "group"),
    [
        ("annealed", "(VDI 2)"),
        ("850 MPa", "(VDI 3)"),
        ("Quenched and tempered", "(VDI 3)"),
        ("VDI 2", "(VDI 2)"),
    ],
)
def test_a_condition_chooses_among_the_rows_of_a_grade(condition, group):
    """1.0503 annealed or tempered had to be named by the whole name of its row."""
    found = loads(f'[material]\nname = "1.0503"\ncondition = "{condition}"').material
    assert group in found.row_name
    assert found.row is MATERIALS[found.row_name]
    assert found.Ktc == MATERIALS[found.row_name].values["Ktc"]


@pytest.mark.parametrize(
    ("grade", "condition", "told"),
    [
        (
            "42CrMo4",
            "quenched",
            'leaves 3 of the rows of "42CrMo4": "low-alloy and cast steel, hardened to 275 HB',
        ),
        ("42CrMo4", "annealed", 'chooses none of the rows of "42CrMo4"'),
        ("ti6al4v", "1050 MPa", "leaves 2"),
        ("unobtainium", "annealed", "is not in the table of materials"),
    ],
)
def test_a_condition_that_does_not_choose_says_which_do(grade, condition, told):
    with pytest.raises(InputError) as found:
        loads(f'[material]\nname = "{grade}"\ncondition = "{condition}"')
    assert told in str(found.value)


def test_a_name_of_no_row_is_at_fault_whatever_the_condition():
    """The condition was blamed: "material.condition: unobtainium is not in the table"."""
    with pytest.raises(InputError, match=r"material\.name: \"unobtainium\" is not in the table"):
        loads('[material]\nname = "unobtainium"\ncondition = "annealed"')


def test_a_condition_without_a_grade_is_refused():
    with pytest.raises(InputError, match="is given without name"):
        loads('[material]\ncondition = "annealed"\nKtc = "1 GPa"\nKrc = "1 GPa"')


@pytest.mark.parametrize(
    ("given", "name"), [("304", "304"), ("1.4301", "1.4301"), ("1.2080", "1.2080")]
)
def test_a_grade_of_digits_needs_no_quotes(given, name):
    """`--set material.name=304` was refused, text in quotes being required."""
    text = CASE.replace('name = "our steel"\ntable = "materials.toml"', f"name = {given}")
    if name == "1.2080":
        text = text.replace(f"name = {given}", f'name = {given}\ncondition = "annealed"')
    assert loads(text).material.name == name


def test_rows_of_one_condition_show_their_coefficient():
    with pytest.raises(ValueError, match="the name of a row chooses") as told:
        name_of_row("Ti6Al4V")
    assert '(VDI 37)" (1050 MPa; Ktc 1245 MPa)' in str(told.value)
    assert '(VDI 37, 2017)" (1050 MPa; Ktc 2110 MPa)' in str(told.value)
