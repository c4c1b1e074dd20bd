"""Values of a path: lists, ranges, shares, and what is refused."""

import pytest

from chatter.description.errors import InputError
from chatter.studies.model import load_model, patched, value_of
from chatter.studies.whatif.variation import read_variation
from chatter.studies.whatif.whatif_study import whatif


def numbers(text, case, count=None):
    one = read_variation(text, case, count)
    return one.unit, one.numbers


def test_lists_keep_the_unit_of_the_first_value(case):
    assert numbers("cut.axial_depth=1 mm, 0.2 cm,3mm", case) == ("mm", pytest.approx([1, 2, 3]))
    assert numbers("material.Ktc=6e8,7e8", case) == ("Pa", [6e8, 7e8])
    assert numbers("tool.teeth=2,4", case) == ("", [2.0, 4.0])
    one = read_variation('tool.pitch=["180 deg","180 deg"],["170 deg","190 deg"],none', case)
    assert [value.label for value in one.values] == ["180 deg,180 deg", "170 deg,190 deg", "none"]
    assert one.values[2].patch == {"tool.pitch": None}
    assert one.numbers is None


def test_ranges_are_even_and_end_where_they_say(case):
    unit, found = numbers("cut.spindle_speed=3000 rpm..9000 rpm", case, 4)
    assert (unit, found) == ("rpm", pytest.approx([3000, 5000, 7000, 9000]))
    assert numbers("cut.axial_depth=1..4 mm", case, 4) == ("mm", pytest.approx([1, 2, 3, 4]))
    assert len(numbers("cut.axial_depth=1 mm..4 mm", case)[1]) == 5


@pytest.mark.parametrize(
    ("text", "unit", "values"),
    [
        ('"0.5 mm".."2 mm"', "mm", [0.5, 1.25, 2.0]),
        ('"0.5".."2 mm"', "mm", [0.5, 1.25, 2.0]),
        ('"0.5 mm..2 mm"', "mm", [0.5, 1.25, 2.0]),
        ('"0.5 mm..2 mm:3"', "mm", [0.5, 1.25, 2.0]),
        ('"0.5 mm..2 mm":3', "mm", [0.5, 1.25, 2.0]),
        ('1/4"..1/2"', "in", [0.25, 0.375, 0.5]),
        ('"1/4 in".."1/2 in"', "in", [0.25, 0.375, 0.5]),
        ("1/4..1/2 in", "in", [0.25, 0.375, 0.5]),
    ],
)
def test_ends_of_a_range_may_have_quotes_or_marks_of_an_inch(case, text, unit, values):
    """The quote before an end was read as a mark of an inch: "in2 mm"."""
    assert numbers(f"cut.axial_depth={text}", case, 3) == (unit, pytest.approx(values))


def test_a_range_of_teeth_is_one_of_whole_numbers(case):
    assert numbers("tool.teeth=2..5", case) == ("", [2.0, 3.0, 4.0, 5.0])
    assert numbers("tool.teeth=2..6:3", case) == ("", [2.0, 4.0, 6.0])
    # no tooth twice
    assert numbers("tool.teeth=2..4:9", case) == ("", [2.0, 3.0, 4.0])
    with pytest.raises(InputError, match="the range is empty"):
        read_variation("tool.teeth=4..2", case)


def test_shares_are_of_what_stands_in_every_place(case):
    one = read_variation("structure.mode[*].damping=+-20%", case)
    low, high = (patched(case, value.patch) for value in one.values)
    assert low.get("structure.mode[0].damping") == pytest.approx(0.8 * 0.011, rel=1e-12)
    assert high.get("structure.mode[0].damping") == pytest.approx(1.2 * 0.011, rel=1e-12)


def test_paths_lead_into_the_machine_of_a_case(case_on_machine):
    case = load_model(case_on_machine)
    changed = patched(case, {"machine.body.head.mass": "50 kg", "cut.axial_depth": "2 mm"})
    assert value_of(changed, "machine.body.head.mass") == 50.0
    assert value_of(case, "machine.body.head.mass") == 100.0
    assert changed.get("cut.axial_depth") == 2e-3
    # later patches stay on that machine; the case is another one
    assert value_of(changed.patch({"cut.axial_depth": 1e-3}), "machine.body.head.mass") == 50.0
    assert changed != case.patch({"cut.axial_depth": "2 mm"})


@pytest.mark.parametrize(
    ("texts", "words"),
    [
        (["cut.axial_depht=1 mm,2 mm"], ["cut.axial_depht", "axial_depth"]),
        (["cut.axial_depth="], ["cut.axial_depth", "no values"]),
        (["cut.axial_depth=1 mm,,2 mm"], ["empty"]),
        (["cut.axial_depth"], ["PATH=VALUES"]),
        (["=1,2"], ["PATH=VALUES"]),
        (["cut.axial_depth=1,2,3 mm"], ["no unit", "every value its unit"]),
        (["cut.axial_depth=1 mm,2 Hz"], ["2 Hz", "a length is required"]),
        (["cut.axial_depth=1 mm..2 Hz"], ["2 Hz", "a length is required"]),
        (["cut.axial_depth=1 mm..-2 mm"], ["out of range"]),
        (["material.Ktc=-10%..10%:3"], ["a change in percent is written", "+-10%"]),
        (["process_damping.coefficient=+-10%"], ["no quantity", "values instead"]),
        (["machine.body.head.mass=1 kg"], ["on no machine", "structure"]),
        (["cut.axial_depth=1 mm,2 mm", "cut.axial_depth=3 mm"], ["given twice"]),
        (
            ["cut.axial_depth=1 mm", "tool.teeth=2", "cut.spindle_speed=1 rpm"],
            ["3 paths", "--tornado"],
        ),
        ([], ["nothing varies"]),
    ],
)
def test_errors_are_sentences(case, texts, words):
    with pytest.raises(InputError) as caught:
        whatif(case, texts, "critical depth")
    text = "\n".join(caught.value.messages)
    assert all(word in text for word in words), text


def test_other_wrong_wishes(case, machine_file):
    with pytest.raises(InputError, match="a low and a high value"):
        whatif(case, ["cut.axial_depth=1 mm"], "lobes", tornado=True)
    with pytest.raises(InputError, match='"lobs" is not known; there are lobes'):
        whatif(case, ["cut.axial_depth=1 mm"], "lobs")
    with pytest.raises(InputError, match="a machine alone makes no cut"):
        whatif(load_model(machine_file), ["body.head.mass=1 kg"], "lobes")
    with pytest.raises(InputError, match='"depth" is not known; lobes has critical_depth_mm'):
        whatif(case, ["cut.axial_depth=1 mm"], "lobes", quantity="depth")
    with pytest.raises(InputError, match="--count 1"):
        whatif(case, ["cut.axial_depth=1 mm..2 mm"], "lobes", count=1)
