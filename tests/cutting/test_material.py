"""The table of materials: numbers as printed in their sources, the law that they are of, search."""

import functools
import math

import numpy as np
import pytest

from chatter.description.case import loads
from cutting.force.exponential import ExponentialLaw
from cutting.material import row as row_module
from cutting.material.families import family_of
from cutting.material.grades import EQUIVALENT_GRADES, bare
from cutting.material.specific_cutting_force import RADIAL_RATIO
from cutting.material.table import MATERIALS, found_rows

#: kc1.1 in MPa and mc by group, typed from the catalogue page apart from the table
PRINTED = {
    1: (1350, 0.21), 2: (1500, 0.22), 3: (1675, 0.24), 4: (1700, 0.24), 5: (1900, 0.24),
    6: (1775, 0.24), 7: (1675, 0.24), 8: (1725, 0.24), 9: (1800, 0.24), 10: (2450, 0.23),
    11: (2500, 0.23), 12: (1875, 0.21), 13: (1875, 0.21), 14: (2150, 0.20), 15: (1150, 0.20),
    16: (1350, 0.28), 17: (1225, 0.25), 18: (1350, 0.28), 19: (1225, 0.25), 20: (1420, 0.30),
    21: (700, 0.25), 22: (800, 0.25), 23: (700, 0.25), 24: (700, 0.25), 25: (750, 0.25),
    26: (700, 0.27), 27: (700, 0.27), 28: (700, 0.27), 31: (2600, 0.24), 32: (3100, 0.24),
    33: (3300, 0.24), 34: (3300, 0.24), 35: (3300, 0.24), 36: (1160, 0.24), 37: (1245, 0.24),
}  # fmt: skip


def row_of_group(group):
    (row,) = [row for name, row in MATERIALS.items() if name.endswith(f"(VDI {group})")]
    return row


@pytest.mark.parametrize("group", PRINTED)
def test_specific_cutting_forces_as_printed(group):
    specific, mc = PRINTED[group]
    row = row_of_group(group)
    assert row.law == "exponential"
    assert row.values["Ktc"] == pytest.approx(specific * 1e6, rel=1e-14)
    assert row.values["exponent"] == pytest.approx(1.0 - mc, rel=1e-14)
    assert row.values["h0"] == 1e-3


def test_the_force_is_that_of_kienzle():
    # Fc = kc1.1 b h^(1 - mc), h and b in mm: steel of group 7, b = 2 mm, h = 0.1 mm
    by_hand = 1675.0 * 2.0 * 0.1**0.76
    material = loads('[material]\nname = "low-alloy and cast steel, hardened to 275 HB (VDI 7)"')
    law = material.material.force_law(0.0)
    tangential, radial, axial = ExponentialLaw.leaf(ExponentialLaw.table([law]), 0, 1e-4)
    assert tangential * 2e-3 == pytest.approx(by_hand, rel=1e-12)
    assert radial / tangential == pytest.approx(1.0 / math.tan(math.radians(68.0)), rel=1e-12)
    assert axial == 0.0


def test_there_are_materials_of_every_group():
    assert len(MATERIALS) >= 40
    groups = {row.iso_group for row in MATERIALS.values()}
    assert groups == {"P", "M", "K", "N", "S"}
    for word in ("titanium", "nickel", "stainless", "tool steel", "cast iron", "aluminium"):
        assert found_rows([word]), word


@pytest.mark.parametrize("name", MATERIALS)
def test_every_row_names_its_source_and_what_it_assumes(name):
    row = MATERIALS[name]
    assert row.source
    # a catalogue has the cutting force alone: the rest of such a row is an assumption, and said
    assert bool(row.assumption) == (row.law == "exponential")
    assert all(np.isfinite(list(row.values.values())))


def test_the_ratio_of_the_assumption_is_among_those_of_tests():
    ratios = [row.cutting[1] / row.cutting[0] for row in MATERIALS.values() if row.law == "linear"]
    assert f"{min(ratios):.2f} to {max(ratios):.2f}" in row_of_group(7).assumption
    assert min(ratios) < RADIAL_RATIO < max(ratios)


def test_search_needs_all_words_in_any_case():
    assert list(found_rows(["INCONEL", "718"])) == ["nickel or cobalt alloy, hardened (VDI 34)"]
    assert len(found_rows(["4140"])) == 3
    assert not found_rows(["inconel", "aluminium"])
    assert found_rows([]) == MATERIALS


def test_two_editions_of_a_catalogue_differ_as_the_documents_have_it():
    # at a chip of 0.08 mm and at 1 mm
    alloy = [2110.0 * h**-0.22 / (1245.0 * h**-0.24) for h in (0.08, 1.0)]
    pure = [1700.0 * h**-0.23 / (1160.0 * h**-0.24) for h in (0.08, 1.0)]
    assert [round(one, 1) for one in (*alloy, *pure)] == [1.6, 1.7, 1.4, 1.5]
    (old,) = [row for name, row in MATERIALS.items() if name.endswith("(VDI 37, 2017)")]
    assert (old.values["Ktc"], old.values["exponent"]) == (2110e6, 0.78)


# EN 10088-1, EN 10083-2, EN 10083-3, EN 10025-2, EN 1563, EN 573-3, DIN 17007
@pytest.mark.parametrize(
    ("designation", "group"),
    [
        ("1.4404", 14), ("X5CrNi18-10", 14), ("316L", 14), ("1.4021", 13), ("1.4016", 12),
        ("1.7225", 8), ("1.6582", 9), ("C45E", 2), ("1.0503", 3), ("S355J2", 1), ("1.3343", 10),
        ("GGG-40", 17), ("EN-GJS-700-2", 18), ("EN AW-7075", 22), ("3.2315", 22), ("AlSi10Mg", 24),
        ("2.4668", 34), ("3.7165", 37),
        # ISO 4957, EN 1561, EN 10084, EN 12163; UNS and JIS
        ("1.2343", 10), ("1.2343", 11), ("H13", 11), ("SKD61", 10), ("D2", 10), ("1.2379", 11),
        ("P20", 8), ("1.2311", 8), ("GG25", 16), ("EN-GJL-250", 16), ("0.6015", 15),
        ("16MnCr5", 6), ("100Cr6", 6), ("SCM440", 7), ("SAE 4140", 9), ("G10450", 2),
        ("UNS S30400", 14), ("SUS316L", 14), ("DIN 1.4301", 14), ("1.4571", 14), ("17-4PH", 13),
        ("A97075", 22), ("AlZnMgCu1.5", 22), ("EN AW-5083", 21), ("A356", 24), ("CuZn39Pb3", 26),
        ("Cu-ETP", 28), ("N06625", 33), ("1.4980", 32), ("3.7035", 36), ("GGG50", 17),
        ("GGG50", 18),
    ],
)  # fmt: skip
def test_a_grade_is_found_by_any_standard(designation, group):
    assert any(f"group {group}" in row.examples for row in found_rows([designation]).values())
    assert f"(VDI {group})" in " ".join(found_rows([designation.lower()]))


def test_tests_of_an_alloy_are_found_by_its_other_names():
    """ "AlZnMgCu1.5" had the row of the catalogue, and none of the four of cutting tests."""
    found = found_rows(["AlZnMgCu1.5"])
    assert [name for name in found if name.startswith("Al7075")] == [
        "Al7075-T6", "Al7075-T6 (second source)", "Al7075 HSS", "Al7075 (Altintas)"
    ]  # fmt: skip


def test_a_grade_in_two_words_is_found():
    """Nodular iron was found: "gg" of GGG, "25" of 250 HB."""
    assert list(found_rows(["GG", "25"])) == list(found_rows(["GG25"]))


@pytest.mark.parametrize(
    ("grade", "groups"),
    [
        ("1.2767", (6, 8, 10, 11)), ("1.0570", (1, 2, 3, 4, 5)), ("1.4539", (12, 13, 14)),
        ("1.4841", (14, 31, 32)), ("1.6587", (6, 7, 8, 9)), ("0.6040", (15, 16)),
        ("GGG80", (17, 18)), ("7050", (21, 22, 23, 24, 25)), ("EN AW-6063", (21, 22, 23, 24, 25)),
        ("AISI 4330", (6, 7, 8, 9)), ("AISI 1144", (1, 2, 3, 4, 5)), ("S7", (6, 8, 10, 11)),
        ("CuSn8", (26, 27, 28)), ("Hastelloy X", (33, 34, 35)), ("TiAl6Nb7", (36, 37)),
        ("AISI 310", (12, 13, 14)), ("18CrNiMo7-6", (6, 7, 8, 9)), ("AZ91", ()), ("POM", ()),
    ],
)  # fmt: skip
def test_the_family_of_a_grade_without_a_row(grade, groups):
    """Numbers of EN 10027-2 and DIN 17007, names of AISI, SAE and EN."""
    assert not any(row.has_grade(grade) for row in MATERIALS.values())
    assert family_of(grade).groups == groups


@pytest.mark.parametrize("grade", ["unobtainium", "", "12", "titan", "ours"])
def test_what_is_no_designation_has_no_family(grade):
    assert family_of(grade) is None


def test_every_line_of_grades_leads_to_rows_and_no_designation_is_in_two(monkeypatch):
    # every row asks anew for the names of the same grade, by all lines of the table
    for name in ("designations", "bare"):
        monkeypatch.setattr(row_module, name, functools.cache(getattr(row_module, name)))
    seen = [name for line in EQUIVALENT_GRADES for name in set(map(bare, line))]
    assert len(seen) == len(set(seen))
    for line in EQUIVALENT_GRADES:
        of = {tuple(name for name, row in MATERIALS.items() if row.has_grade(one)) for one in line}
        assert len(of) == 1, line
        assert of != {()}, line
