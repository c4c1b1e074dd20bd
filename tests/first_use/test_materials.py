"""The table of materials: families that a shop cuts, each row with its source."""

import pytest

from chatter.description.material_table import MATERIALS
from tests.command_line import chatter_command


def test_there_are_rows_of_every_family_with_source_and_range():
    assert len(MATERIALS) >= 40
    groups = [row.iso_group for row in MATERIALS.values()]
    # steel, stainless, cast iron, aluminium and other metals, titanium and nickel alloys
    assert set("PMKNS") <= set(groups)
    for name, row in MATERIALS.items():
        assert row.source, name
        assert any(character.isdigit() for character in row.source), name


@pytest.mark.parametrize("word", ["titanium", "nickel", "stainless", "cast iron", "aluminium"])
def test_a_family_is_found_by_its_name(word):
    result = chatter_command("materials", word)
    assert result.exit_code == 0
    assert word in result.stdout.lower()
