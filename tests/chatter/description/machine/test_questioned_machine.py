"""Values of a machine that no machine is likely to have are asked about, at their key."""

import pytest

import chatter
from chatter import InputError
from tests.command_line import chatter_command
from tests.places import EXAMPLES

FACE_MILL = EXAMPLES / "face-mill-chatter" / "machine.toml"


@pytest.fixture(scope="module")
def machine():
    return chatter.load_machine(FACE_MILL)


@pytest.mark.parametrize(
    "path", sorted(EXAMPLES.glob("*/machine*.toml")), ids=lambda path: path.parent.name
)
def test_nothing_is_asked_of_the_machines_of_the_examples(path):
    assert chatter.load_machine(path).notes == ()


@pytest.mark.parametrize(
    ("path", "value", "asked"),
    [
        # bare, or in m where mm is meant
        ("axis.X.drive.lead", 12, "axis.X.drive.lead: is 12000 mm meant?"),
        ("axis.X.drive.lead", "-12 m", "is 12000 mm meant? ball screws have 0.2 to 200 mm"),
        # 45 kg cm^2
        ("axis.X.drive.motor_inertia", 45, "motor_inertia: is 45 kg*m^2 meant?"),
        ("axis.X.drive.nut_stiffness", "120 N/mm", "nut_stiffness: is 0.12 N/um meant?"),
        ("axis.X.control.position.gain", 0, "is 0 meant? nothing holds the position of the axis"),
        ("axis.X.control.position.gain", "10 1/h", "position.gain: is 0.0027778 1/s meant?"),
        ("axis.X.control.velocity.integral_time", 100, "integral_time: is 1e+05 ms meant?"),
        ("axis.X.control.current.time_constant", "400 ms", "time_constant: is 400 ms meant?"),
        # 100 % is 1
        ("axis.X.control.feedforward.velocity", 100, "velocity: is 10000 % meant?"),
        # 0.0045 + 0.0015 + 152.2 (0.012 / 2 pi)^2
        (
            "axis.X.control.feedforward.inertia",
            "6.56 kg*m^2",
            "is 6.56 kg*m^2 meant? the drive and what the axis carries have 0.00656 kg*m^2",
        ),
        ("axis.X.drive.backlash", "40 mm", "axis.X.drive.backlash: is 40 mm meant?"),
        ("axis.X.control", None, "axis.X: has neither control nor brake: its motor turns freely"),
        # 0.35 m x 0.55 m x 0.5 m = 0.09625 m^3
        ("body.head.mass", "220 g", "is 0.22 kg meant? a block of its size would have 2.29 kg/m^3"),
        ("body.head.mass", "220 t", "would have 2.29e+06 kg/m^3"),
        ("step", "50 ms", "step: is 50000 us meant?"),
    ],
)
def test_slips_are_asked_about_with_the_file(machine, path, value, asked):
    (note,) = machine.patch({path: value}).notes
    assert note.startswith(f"{FACE_MILL}: ")
    assert asked in note


def test_static_friction_below_coulomb_friction_is_asked_about(machine):
    law = {
        "law": "coulomb-stribeck", "on": {"axis": "X"}, "coulomb": "200 N", "static": "100 N",
        "stribeck_velocity": "1 mm/s",
    }  # fmt: skip
    (note,) = machine.patch({"friction.translation_x": law}).notes
    assert "friction.translation_x.static: is 0.5 times coulomb meant?" in note


def test_a_screw_to_the_left_is_not_asked_about(machine):
    assert machine.patch({"axis.X.drive.lead": "-12 mm"}).notes == ()


@pytest.mark.parametrize(
    ("test", "level", "told"),
    [
        # it was taken for 400 N
        ("rest", "400 N*m", 'frf.rest.level: "400 N*m" is a torque; a force is required'),
        ("boring", "20 N", 'frf.boring.level: "20 N" is a force; a torque is required'),
    ],
)
def test_the_level_of_a_test_is_a_force_at_a_point_and_a_torque_at_a_motor(
    machine, test, level, told
):
    with pytest.raises(InputError, match="is required") as caught:
        machine.patch({f"frf.{test}.level": level})
    assert told in str(caught.value)


def test_the_command_asks_before_it_refuses():
    result = chatter_command("frf", FACE_MILL, "--only", "rest", "--set", "axis.X.drive.lead=12 m")
    assert result.exit_code == 2
    told = result.stderr.strip().splitlines()
    (asked,) = [line for line in told if "meant?" in line]
    (refused,) = [line for line in told if line.startswith("chatter: ")]
    assert asked.startswith(f"note: {FACE_MILL}: axis.X.drive.lead: is 12000 mm meant?")
    assert refused.startswith(f'chatter: {FACE_MILL}: frf.rest: axis "X": its control loop is un')


def test_a_drive_that_is_far_too_soft_is_no_fault_of_the_program():
    """A nut of 120, which is N/m, ended in "a fault in chatter itself"."""
    case = chatter.load(EXAMPLES / "face-mill-chatter" / "case.toml")
    with pytest.raises(InputError, match="a stiffness is hardly that of a machine") as caught:
        chatter.check(case.patch({"machine.axis.X.drive.nut_stiffness": 120}))
    assert "axis.X.drive.nut_stiffness: is 0.00012 N/um meant?" in str(caught.value)
