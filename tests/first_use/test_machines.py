"""A cut on a machine: positions beyond the travel, frictions at rest, one truth across commands."""

import shutil

import pytest

import chatter
from chatter import InputError
from chatter.description.machine.machine_file import MachineFile, load_machine
from tests.command_line import chatter_command
from tests.places import EXAMPLES

FACE_MILL = EXAMPLES / "face-mill-chatter"
#: the bed is 1500 mm long along Y, and nothing of the machine reaches farther
LENGTH_OF_MACHINE = "along Y the whole machine is 1500 mm long"
AT_5_M = ("--position", "Y=5 m", "--excite", "work:y", "--by", "linearised")


@pytest.fixture(scope="module")
def case():
    return chatter.load(FACE_MILL / "case.toml")


@pytest.fixture
def limited(tmp_path):
    """The machine with 400 mm of travel along Y."""
    path = tmp_path / "machine.toml"
    shutil.copy(FACE_MILL / "machine.toml", path)
    text = path.read_text(encoding="utf-8")
    limits = '[axis.Y]\ntravel_limits = ["-200 mm", "200 mm"]'
    path.write_text(text.replace("[axis.Y]", limits), encoding="utf-8")
    return path


def test_a_position_farther_than_the_machine_is_asked_about(case, tmp_path):
    """5 m were taken without a word, by an axis of a bed of 1.5 m."""
    band = ("--band", "10 Hz..60 Hz", "--out", tmp_path)
    found = chatter_command("frf", FACE_MILL / "machine.toml", *AT_5_M, *band)
    assert found.exit_code == 0
    assert "axis.Y.position: is 5000 mm meant?" in found.stderr
    assert LENGTH_OF_MACHINE in found.stderr
    machine = case.machine_file()
    assert machine.questions_of_positions({"Y": "1.4 m"}) == ()
    (asked,) = machine.questions_of_positions({"Y": "-1.6 m"})
    assert LENGTH_OF_MACHINE in asked
    (asked,) = [one for one in machine.patch({"axis.Y.position": "5 m"}).notes if "5000" in one]
    assert LENGTH_OF_MACHINE in asked


TOLD = "is not within -200 to 200 mm, the travel of the axis (travel_limits)"


def test_a_position_beyond_the_travel_is_refused(limited, case, tmp_path):
    found = chatter_command("frf", limited, *AT_5_M, "--band", "10 Hz..60 Hz", "--out", tmp_path)
    assert found.exit_code == 2
    assert f"position of axis Y: 5000 mm {TOLD}" in found.stderr
    on_it = case.patch({"structure.machine": str(limited)})
    with pytest.raises(InputError, match="300 mm is not within -200 to 200 mm"):
        chatter.check(on_it.patch({"structure.position": {"Y": "300 mm"}}))
    file = load_machine(limited)
    # the end itself is of the travel
    assert file.positions({"Y": "200 mm"}) == {"Y": 0.2}
    assert file.questions_of_positions({"Y": "-200 mm"}) == ()


def test_a_move_beyond_the_travel_is_refused(limited, tmp_path):
    far = ("--set", 'move.speed.travel="250 mm"', "--out", tmp_path)
    found = chatter_command("move", limited, "--only", "speed", *far)
    assert found.exit_code == 2
    assert f"axis Y would leave its travel: 250 mm {TOLD}" in found.stderr


@pytest.mark.parametrize(
    ("value", "told"),
    [
        ('["200 mm", "-200 mm"]', "travel_limits: 200 mm is not below -200 mm"),
        ('["10 mm", "200 mm"]', "position: 0 mm is not within 10 to 200 mm"),
    ],
)
def test_limits_of_travel_that_are_none(limited, value, told):
    text = limited.read_text(encoding="utf-8").replace('["-200 mm", "200 mm"]', value)
    with pytest.raises(InputError) as raised:
        MachineFile.from_text(text, "machine.toml")
    assert told in str(raised.value)


def test_check_leaves_open_what_friction_at_rest_decides(case):
    """It said "chatter" of 2 mm, where the time domain is stable; 1.37 mm is no bound of it.

    The limit is highest where presliding damps most: at a vibration of tenths of a micrometre.
    """
    found = {depth: chatter.check(case.patch({"cut.axial_depth": depth})) for depth in (2e-3, 5e-3)}
    assert not found[2e-3].stable
    assert found[2e-3].verdict == "not certain"
    assert found[5e-3].verdict == "chatter"
    (resting,) = [one for one in found[2e-3].neglected if one.name == "resting friction"]
    assert resting.highest * found[2e-3].critical_depth > 2e-3
    assert "it is highest, 3.51 mm, at vibration of about 0.3 um" in resting.note
    # half of 1/(1.15e4 1/m), the hysteresis slope of the file, and of 1/(1.15e4 1/rad)
    assert "translation_y 43 um" in resting.note
    assert "rotation_y 43 urad" in resting.note


def test_what_lobes_call_stable_at_any_speed_check_calls_stable(case):
    """Lobes said "stable at any speed below 0.95 mm", check of one of them "at least 0.67 mm"."""
    few = case.patch({"lobes.speeds": {"from": "700 rpm", "to": "1000 rpm", "count": 20}})
    few = few.patch({"lobes.method": "zero-order"})
    diagram = chatter.lobes(few)
    assert 0.0 < diagram.lowest_depth < diagram.lowest.critical_depth
    assert diagram.lowest_depth <= chatter.check(few).lowest_depth


def test_a_direction_against_an_axis_has_a_name(case):
    assert case.patch({"structure.feed": "-x"}).structure.feed == (-1.0, 0.0, 0.0)
    assert case.patch({"structure.feed": "-y"}).structure.feed == (0.0, -1.0, 0.0)


def test_an_amplitude_of_millimetres_is_asked_about(case):
    notes = chatter.check(case.patch({"structure.friction_amplitude": "5 mm"})).notes
    assert any("structure.friction_amplitude: is 5000 um meant?" in one for one in notes)


def test_errors_of_a_move_are_written_without_exponents(capsys):
    """ "2e+04" um stood in the table."""
    from chatter.cli.move import _print_errors

    errors = {
        "motor_error_um": 20000.0, "tracking_error_um": 20000.0, "effort": 1.0,
        "effort_unit": "N*m",
    }  # fmt: skip
    _print_errors({"far": {"axes": {"Y": errors}, "contour_error_um": None}})
    printed = capsys.readouterr().out
    assert "20000" in printed
    assert "e+" not in printed
