"""Old keys of files are read for one release, with a note that names the new one."""

import pytest
from typer.testing import CliRunner

from chatter.cli import program
from chatter.description.case import Case, loads
from chatter.description.machine.machine_file import MachineFile
from chatter.description.renamed import CASE, MACHINE, rename
from chatter.description.toml_document import parse_document

OLD = """
[contact]
stiffness = "1 N/um"
full_at = 0.5   # soon

[friction.guide]
law = "tanh"
coulomb = "10 N"
presliding_stiffness = "1 N/um"

[friction.table]
law = "coulomb"
coulomb = "5 N"

[friction.screw]
law = "lugre"
coulomb = "10 N"
static = "12 N"
stribeck_velocity = "1 mm/s"
sigma0 = "1 N/um"
sigma1 = "3 N*s/m"
sigma2 = "2 N*s/m"

[lobes]
method = "time"

[optimum]
speeds = { from = "1000 rpm", to = "2000 rpm" }
depths = { from = "1 mm", to = "2 mm", count = 5 }
widths = { from = "1 mm", to = "2 mm", count = 2 }

[pitch_design]
speeds = { from = "1000 rpm", to = "2000 rpm" }
largest_chip = 1.5
"""


def of_names(case):
    """Notes on names; others are of keys that nothing uses."""
    return [note for note in case.notes if "has no effect" not in note]


def test_every_old_name_of_a_case_is_read_with_a_note():
    case = loads(OLD, "case.toml")
    notes = of_names(case)
    assert len(notes) == len(CASE)
    for one in CASE:
        assert any(f'"{one.old}" is now called "{one.new}"' in note for note in notes), one
    assert notes[0].startswith('case.toml: contact.full_at: "full_at" is now called')
    assert case.contact.full_engagement_share == 0.5
    assert case.friction["guide"].spec().hysteresis_slope == 1e6 / 20.0
    assert case.friction["table"].spec().static == 5.0
    screw = case.friction["screw"].spec()
    assert (screw.bristle_stiffness, screw.bristle_damping, screw.viscous) == (1e6, 3.0, 2.0)
    assert case.lobes.method == "time-domain"
    assert case.optimum.radial_depths.to == 2e-3
    assert case.pitch_design.max_pitch_ratio == 1.5


def test_what_is_written_back_has_the_new_names_alone():
    text = loads(OLD).to_toml()
    assert of_names(loads(text)) == []
    assert loads(text) == loads(OLD)
    assert "# soon" in text


MACHINE_FRICTIONS = """
[friction.guide]
law = "LuGre"
stiffness = "5 N/um"

[friction.screw]
law = "tanh hysteresis"
slow_viscous = 1
slow_decay = 2
inclination = 3

[friction.way]
law = "Coulomb-Stribeck"

[friction.belt]
law = "smooth Coulomb"

[connector.rail]
places = [[0, 0, 0]]

[move.circle]
turns = 2
"""


def test_every_old_name_of_a_machine_is_read_with_a_note():
    document = parse_document(MACHINE_FRICTIONS, "machine.toml")
    notes = rename(document, MACHINE)
    assert MachineFile.RENAMED == MACHINE
    assert len(notes) == len(MACHINE)
    assert rename(document, MACHINE) == []
    assert document["friction"]["guide"].unwrap() == {"law": "lugre", "bristle_stiffness": "5 N/um"}
    assert set(document["friction"]["screw"]) == {
        "law",
        "low_speed_viscous",
        "low_speed_decay",
        "hysteresis_slope",
    }


@pytest.mark.parametrize(
    ("path", "value", "read", "expected"),
    [
        ("contact.full_at", 0.25, "contact.full_engagement_share", 0.25),
        ("contact", {"stiffness": 1e6, "full_at": 0.25}, "contact.full_engagement_share", 0.25),
        ("friction.screw.sigma0", "2 N/um", "friction.screw.bristle_stiffness", 2e6),
        ("lobes.method", "time", "lobes.method", "time-domain"),
    ],
)
def test_patches_take_old_names_too(path, value, read, expected):
    new = Case.from_dict(loads(loads(OLD).to_toml()).model_dump(by_alias=True, exclude_unset=True))
    assert of_names(new) == []
    patched = new.patch({path: value})
    assert patched.get(read) == expected
    assert len(of_names(patched)) == 1
    assert loads(patched.to_toml()).get(read) == expected


def test_both_names_at_once_are_an_error():
    with pytest.raises(Exception, match=r"contact\.full_at: unknown key"):
        loads("[contact]\nstiffness = 1\nfull_at = 0.5\nfull_engagement_share = 0.5")


def test_commands_print_the_note(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(OLD)
    answer = CliRunner().invoke(program, ["check", str(path)])
    assert 'is now called "full_engagement_share"' in " ".join(answer.output.split())
