"""FRFs of a machine at rest, moving and in the cut: predicted, and explained by what it lacks."""

import numpy as np
import pytest

import chatter
from chatter.compile.machine_response import machine_response
from chatter.description.case import load
from chatter.description.errors import InputError
from chatter.explain.effects.effect_list import candidates
from chatter.explain.effects.machine_friction import FrictionOfGuideAndMotor
from chatter.explain.measurement import Measurement
from tests.places import ROOT

EXAMPLE = ROOT / "examples" / "face-mill-chatter"
LINES = np.arange(20.0, 140.0, 1.0)
CONTACT = {"contact.stiffness": "2.50 N/um", "contact.damping": "3.35 kN*s/m"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The face mill, its machine without a contact of its own."""
    path = tmp_path_factory.mktemp("machine")
    text = (EXAMPLE / "machine.toml").read_text(encoding="utf-8")
    bare = text[: text.index("[contact]")]
    (path / "machine.toml").write_text(bare, encoding="utf-8")
    (path / "case.toml").write_bytes((EXAMPLE / "case.toml").read_bytes())
    return path


def measured(
    folder, truth, name, directions=("x", "y"), conditions=("at_rest", "moving", "in_cut")
):
    """Folder with FRFs of a case, each with a scatter of 2 % of itself."""
    random = np.random.default_rng(3)
    runs = []
    for condition in conditions:
        for direction in directions:
            exact = machine_response(truth, condition, direction, direction, LINES)
            for repetition in range(2):
                noise = random.standard_normal((2, LINES.size)) * np.abs(exact) * 0.02 / np.sqrt(2)
                file = f"{name}_{condition}_{direction}_{repetition}.csv"
                columns = np.c_[LINES, exact.real + noise[0], exact.imag + noise[1]]
                head = "frequency [Hz],real [m/N],imag [m/N]"
                np.savetxt(folder / file, columns, delimiter=",", header=head, comments="")
                runs.append(
                    f'[[run]]\nfile = "{file}"\ncondition = "{condition}"\n'
                    f'direction = "{direction}"\n'
                )
    text = 'kind = "frf"\ncase = "case.toml"\n' + "".join(runs)
    (folder / "measurement.toml").write_text(text, encoding="utf-8")
    return folder


def test_contact_joined_to_frfs_is_that_assembled_in_the_machine():
    """Two ways: springs between the bodies of the machine, and ports joined afterwards."""
    case = load(EXAMPLE / "case.toml")
    machine = case.machine_file()
    section = {
        "excite": "table:y", "read": "motor:Y", "by": "linearised",
        "band": ["20 Hz", "139 Hz"], "lines": LINES.size, "in_cut": True,
    }  # fmt: skip
    section |= {"excite": "motor:Y", "read": "table:y"}
    assembled = chatter.frf(machine.patch({"frf.held": section}), ("held",))["held"].harmonic
    joined = machine_response(case, "in_cut_at_rest", "table:y", "motor:Y", LINES)
    free = machine_response(case, "at_rest", "table:y", "motor:Y", LINES)
    assert joined == pytest.approx(assembled.values, rel=1e-6, abs=1e-9 * np.abs(free).max())
    assert np.abs(joined - free).max() > 0.2 * np.abs(free).max()


@pytest.mark.nightly
def test_missing_contact_is_found(folder):
    truth = load(folder / "case.toml").patch(CONTACT)
    found = chatter.explain(measured(folder, truth, "contact", ("y",), ("moving", "in_cut")))
    summary = found.summary()
    assert summary["verdict"] == "explained"
    (effect,) = summary["effects"]
    assert effect["name"] == "contact"
    for name, true in (("stiffness", 2.5e6), ("damping", 3.35e3)):
        one = effect["parameters"][name]
        assert one["ci95"][0] <= true <= one["ci95"][1]
        assert one["value"] == pytest.approx(true, rel=0.03)
    assert summary["error"]["after"] < 0.2 * summary["error"]["before"]


@pytest.mark.nightly
def test_nothing_is_missing_where_nothing_is(folder):
    case = load(folder / "case.toml")
    found = chatter.explain(measured(folder, case, "nothing", ("y",), ("at_rest", "moving")))
    assert found.summary()["verdict"] == "nothing-missing"


@pytest.mark.nightly
def test_a_softer_nut_is_named(folder, tmp_path):
    path = "machine.axis.Y.drive.nut_stiffness"
    case = load(folder / "case.toml")
    truth = case.patch({path: 0.7 * case.get(path)})
    found = chatter.explain(measured(folder, truth, "nut", ("y",), ("moving",)))
    summary = found.summary()
    (effect,) = summary["effects"]
    assert effect["name"] == "joint_stiffness"
    assert effect["parameters"]["Y_nut_stiffness"]["value"] == pytest.approx(0.7, rel=0.02)
    # the repaired case carries a machine of its own
    found.save(tmp_path)
    repaired = load(tmp_path / "case-updated.toml")
    assert repaired.get(path) == pytest.approx(0.7 * case.get(path), rel=0.02)
    assert case.get(path) != pytest.approx(repaired.get(path), rel=0.1)


@pytest.mark.nightly
def test_values_of_the_machine_have_tolerances(folder):
    """A nut that is known to 30 % only is refitted, and nothing is missing."""
    path = "machine.axis.Y.drive.nut_stiffness"
    case = load(folder / "case.toml")
    made = measured(folder, case.patch({path: 0.8 * case.get(path)}), "known", ("y",), ("moving",))
    text = (made / "measurement.toml").read_text(encoding="utf-8")
    (made / "measurement.toml").write_text(
        text.replace('case = "case.toml"\n', f'case = "case.toml"\n[tolerance]\n"{path}" = 0.3\n'),
        encoding="utf-8",
    )
    found = chatter.explain(made)
    assert found.summary()["verdict"] == "nothing-missing"
    assert found.case.get(path) == pytest.approx(0.8 * case.get(path), rel=0.02)


def without_friction(truth, missing, folder):
    """Case on the same machine without one of its frictions."""
    text = truth.machine_file().to_toml()
    begin = text.index(f"[friction.{missing}]")
    end = text.find("[", text.index("hysteresis_slope", begin))
    file = folder / f"without_{missing}.toml"
    file.write_text(text[:begin] + text[end:], encoding="utf-8")
    return truth.patch({"structure.machine": str(file)})


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("missing", "named", "coulomb"),
    [("translation_y", "Y", 99.2), ("rotation_y", "motor_Y", 0.113)],
)
def test_missing_friction_of_an_axis_is_named(folder, missing, named, coulomb):
    """Declared without friction on the guides of Y, or on its motor; FRFs at rest and in motion."""
    truth = load(folder / "case.toml")
    made = measured(folder, truth, f"rub_{named}", ("y",), ("at_rest", "moving"))
    declared = without_friction(truth, missing, folder)
    summary = chatter.explain(made, declared).summary()
    assert [effect["name"] for effect in summary["effects"]] == ["axis_friction"]
    found = summary["effects"][0]["parameters"]
    # what shows at rest is twice the friction times the slope of its hysteresis
    told = found[f"presliding_stiffness_{named}"]["value"]
    assert told == pytest.approx(2.0 * coulomb * 1.15e4, rel=0.1)


def effect_of(case, name, first):
    """Effect of a name whose first parameter is called so."""
    measurement = Measurement("frf", "effects", case.folder, case, ())
    return next(
        one
        for one in candidates(measurement)
        if one.name == name and one.parameters(measurement)[0].name == first
    )


def test_what_a_contact_and_a_nut_are_made_of_is_what_machines_have(folder):
    """The effects that `explain` tries, with the values of the truth, are the truth."""
    case = load(folder / "case.toml")
    path = "machine.axis.Y.drive.nut_stiffness"
    for name, values, condition, truth in (
        ("contact", {"stiffness": 2.5e6, "damping": 3.35e3}, "in_cut", CONTACT),
        ("joint_stiffness", {"Y_nut_stiffness": 0.7}, "moving", {path: 0.7 * case.get(path)}),
    ):
        effect = effect_of(case, name, next(iter(values)))
        found, true, declared = (
            machine_response(one, condition, "y", "y", LINES)
            for one in (case.patch(effect.patch(case, values)), case.patch(truth), case)
        )
        assert found == pytest.approx(true, rel=1e-9, abs=1e-9 * np.abs(true).max())
        assert np.abs(true - declared).max() > 0.05 * np.abs(declared).max()


@pytest.mark.parametrize(
    ("missing", "named", "coulomb"),
    [("translation_y", "Y", 99.2), ("rotation_y", "motor_Y", 0.113)],
)
def test_friction_at_rest_is_twice_the_force_times_its_slope(folder, missing, named, coulomb):
    """Of another force and slope with the same product, the axis answers alike at rest."""
    truth = load(folder / "case.toml")
    case = without_friction(truth, missing, folder)
    effect = effect_of(case, "axis_friction", f"coulomb_{named}")
    values = {f"coulomb_{named}": coulomb * 1.15, f"viscous_{named}": 0.0}
    stiffness, _ = effect.reported(values)[f"presliding_stiffness_{named}"]
    assert stiffness == pytest.approx(2.0 * coulomb * 1.15e4)
    found, true, without = (
        machine_response(one, "at_rest", "y", "y", LINES)
        for one in (case.patch(effect.patch(case, values)), truth, case)
    )
    change = np.abs(true - without).max()
    assert change > 0.02 * np.abs(true).max()
    assert np.abs(found - true).max() < 0.05 * change


def test_friction_of_guide_and_motor_with_the_values_declared_is_that_of_the_machine(folder):
    """At rest and moving, with what is higher at low speed; between the parts lies the screw."""
    truth = load(folder / "case.toml")
    case = without_friction(without_friction(truth, "rotation_y", folder), "translation_y", folder)
    measurement = Measurement("frf", "effects", case.folder, case, ())
    effect = next(
        one
        for one in candidates(measurement)
        if isinstance(one, FrictionOfGuideAndMotor) and one.axis(measurement) == "Y"
    )
    declared = truth.machine_file().friction
    values = {
        f"{key}_{named}Y": getattr(declared[law], key)
        for named, law in (("", "translation_y"), ("motor_", "rotation_y"))
        for key in (
            "coulomb", "viscous", "hysteresis_slope", "low_speed_viscous", "low_speed_decay",
        )
    }  # fmt: skip
    assert set(values) == {one.name for one in effect.parameters(measurement)}
    assert effect.reported(values)["presliding_stiffness_Y"][0] == pytest.approx(2.28e6, rel=1e-3)
    for condition in ("at_rest", "moving"):
        found, true, without = (
            machine_response(one, condition, "y", "y", LINES)
            for one in (case.patch(effect.patch(case, values)), truth, case)
        )
        assert found == pytest.approx(true, rel=1e-9, abs=1e-9 * np.abs(true).max())
        assert np.abs(true - without).max() > 0.02 * np.abs(true).max()


def test_a_slower_current_loop_is_another_machine(folder):
    """The factor of the effect is that of the time constant, which the motor shows."""
    case = load(folder / "case.toml")
    measurement = Measurement("frf", "loops", folder, case, ())
    path = "machine.axis.Y.control.current.time_constant"
    delays = [one for one in candidates(measurement) if one.name == "control_delay"]
    names = [one.parameters(measurement)[0].name for one in delays]
    assert names[:2] == ["X_current", "X_velocity"]
    effect = delays[names.index("Y_current")]
    slower = case.patch(effect.patch(case, {"Y_current": 3.0}))
    assert slower.get(path) == pytest.approx(3.0 * 0.4e-3)
    lines = np.array([60.0, 100.0])
    before, after = (
        machine_response(one, "moving", "motor:Y", "motor:Y", lines) for one in (case, slower)
    )
    assert np.all(np.abs(after / before - 1.0) > 0.01)


def test_what_a_machine_does_not_know_is_told(folder):
    case = load(folder / "case.toml")
    with pytest.raises(InputError, match='condition: "sliding" is none of a machine'):
        machine_response(case, "sliding", "x", "x", LINES)
    with pytest.raises(InputError, match="tabel"):
        machine_response(case, "moving", "tabel:y", "table:y", LINES)
    with pytest.raises(InputError, match="no control"):
        machine_response(case, "moving", "table:y", "motor:Q", LINES)
    with pytest.raises(InputError, match="the case is on no machine"):
        load(ROOT / "examples" / "two-degrees-of-freedom" / "case.toml").patch(
            {"machine.axis.Y.drive.nut_stiffness": 1.0}
        )
