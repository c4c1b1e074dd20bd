"""Values of any key that would overflow a solver are refused by file, key and range."""

import pytest

import chatter
from chatter.description.errors import InputError
from chatter.description.magnitudes import is_plausible
from tests.places import EXAMPLES


@pytest.mark.parametrize(
    ("example", "key", "value"),
    [
        ("machine-gantry", "connector.left_seat.stiffness.rx", "1e300 N*m/rad"),
        ("machine-gantry", "connector.left_seat.stiffness.x", "1e300 N/m"),
        ("face-mill-chatter", "body.head.mass", "1e-300 kg"),
        ("face-mill-chatter", "axis.X.drive.motor_inertia", "1e-300 kg*m^2"),
        ("face-mill-chatter", "axis.X.control.position.gain", "1e300 1/s"),
    ],
)
def test_machine_files(example, key, value):
    machine = chatter.load_machine(EXAMPLES / example / "machine.toml")
    with pytest.raises(InputError) as error:
        machine.patch({key: value})
    assert key in str(error.value)
    assert "out of any plausible range" in str(error.value)


@pytest.mark.parametrize("frequency", ["1e300 Hz", "1e-300 Hz"])
def test_modes_of_a_case(frequency):
    case = chatter.load(EXAMPLES / "one-degree-of-freedom" / "case.toml")
    with pytest.raises(InputError, match=r"structure.mode\[0\].frequency"):
        case.patch({"structure.mode[0].frequency": frequency})


def test_rigid_parts_and_free_axes_lie_within():
    assert is_plausible(1e12, "stiffness")
    assert is_plausible(0.0, "mass")
    assert is_plausible(-1e-9, "length")
    assert not is_plausible(1e300, "stiffness")
    assert not is_plausible(1e-300, "mass")


def test_lists_without_end():
    mode = {"frequency": "900 Hz", "damping": 0.01, "mass": "1 kg"}
    with pytest.raises(InputError) as error:
        chatter.description.case.Case.from_dict({"structure": {"mode": [mode] * 20_000}})
    assert "structure.mode: 20000 entries are given; at most 1000" in str(error.value)
