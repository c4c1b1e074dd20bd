"""First files as editors and fingers make them: what stands wrong is said with what to write."""

import codecs

import pytest

import chatter
from chatter import InputError
from chatter.studies.diagram_over_axes import lobes_over
from tests.command_line import chatter_command
from tests.first_use.shop import CUT, cut, written


@pytest.mark.parametrize(
    ("given", "instead", "told"),
    [
        # "Invalid value (at line 5, column 12)" was all that was said
        ('"16 mm"', "16 mm", 'diameter = 16 mm; a quantity stands in quotes: "16 mm"'),
        ('"16 mm"', "\u201c16 mm\u201d", 'straight quotes are required: "16 mm"'),
        ('"16 mm"', "", ": diameter ="),
        # "4.0 is not a whole number"
        ("teeth = 4", "teeth = 4.0", "as it stands; write 4, without a decimal point"),
        ("teeth = 4", 'teeth = "4"', "as it stands; write 4, without quotes"),
        # "it must be less than 90 deg" of a number in rad
        ('"40 deg"', "40", 'it must be less than 90 deg; is "40 deg" meant?'),
        ('"16 mm"', "16", 'it must be at most 2 m; is "16 mm" meant?'),
        ("damping = 0.03", "damping = 3", 'it must be less than 1; is "3 %" meant?'),
    ],
)
def test_what_to_write(given, instead, told, tmp_path):
    path = tmp_path / "shop.toml"
    path.write_text(CUT.replace(given, instead, 1), encoding="utf-8")
    result = chatter_command("check", path)
    assert result.exit_code == 2
    assert told in result.stderr


def test_nothing_is_asked_where_the_usual_unit_is_out_of_range_too():
    with pytest.raises(InputError) as raised:
        cut(tool__helix=95.0)
    assert "it must be less than 90 deg" in str(raised.value)
    assert "meant?" not in str(raised.value)


@pytest.mark.parametrize(("mark", "kind"), [(codecs.BOM_UTF16_LE, "utf-16-le"),
                                            (codecs.BOM_UTF16_BE, "utf-16-be")])  # fmt: skip
def test_text_in_utf_16_is_called_that(mark, kind, tmp_path):
    """It was "a binary file"."""
    path = tmp_path / "shop.toml"
    path.write_bytes(mark + CUT.encode(kind))
    result = chatter_command("check", path)
    assert result.exit_code == 2
    assert "is text in UTF-16; a case file is TOML text in UTF-8" in result.stderr


@pytest.mark.parametrize("band", ["10 Hz..60 Hz", "10 Hz, 60 Hz"])
def test_a_band_is_a_range_as_elsewhere(band):
    from chatter.cli.frf import _ends

    assert _ends(band) == ["10 Hz", "60 Hz"]


@pytest.mark.parametrize("key", ["cut.radial_depth", "cut.stepover"])
def test_lobes_over_a_range_that_goes_beyond_says_what_is_left_of_it(key):
    """20 values from 1 to 20 mm with a tool of 16 mm: it said what is wrong with 17 mm alone."""
    with pytest.raises(InputError) as raised:
        lobes_over(cut(), f"{key}=1 mm..20 mm:20")
    (said,) = raised.value.messages
    assert "17 mm is more than the diameter of the tool, 16 mm" in said
    assert said.endswith("; 16 of the 20 values make a cut, 1 to 16 mm")
    with pytest.raises(InputError) as raised:
        lobes_over(cut(), f"{key}=17 mm..20 mm:4")
    assert "make a cut" not in str(raised.value)


@pytest.mark.parametrize(
    ("mode", "away", "wall"), [("down", "5 deg", "-y"), ("up", "-5 deg", "+y")]
)
def test_a_tilt_away_from_the_work_is_called_that(mode, away, wall):
    """A flat end of 16 mm at 5 deg stands 0.7 mm high at its middle: 0.5 mm are not reached."""
    case = cut(cut__mode=mode, cut__tilt=away)
    for command in (chatter.check, chatter.simulate):
        with pytest.raises(InputError) as raised:
            command(case)
        assert f"the tool cuts on its side at {wall}" in str(raised.value)
        assert "stepover" not in str(raised.value)


def test_whatif_names_the_points_whose_verdict_is_not_certain(tmp_path):
    """It said "verdict: chatter -> not certain" and nothing of where or why."""
    arguments = ("--vary", "cut.axial_depth=0.1 mm,0.85 mm", "--result", "critical depth")
    arguments = (*arguments, "--method", "collocation")
    found = chatter_command("whatif", written(tmp_path), *arguments, "--out", tmp_path / "out")
    assert (
        "the verdict is not certain at cut.axial_depth = 0.85 mm: `chatter check`" in found.stdout
    )
