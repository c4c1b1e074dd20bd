"""Measured FRFs as structure in the time domain: what lies beyond their band is stepped too."""

import numpy as np
import pytest

import chatter
from chatter.compile.cutter import cutter_of
from chatter.compile.structure import structure_of
from chatter.description.case import Case
from chatter.simulation.structure_in_time import modes_in_time, modes_of
from dynamics.modal.modes import Mode, receptance_matrix

LINES = np.arange(200.0, 2500.0, 4.0)
INSIDE = (Mode(800.0, 0.03, 0.05, (1.0, 0.0, 0.0)), Mode(900.0, 0.03, 0.05, (0.0, 1.0, 0.0)))
#: 9 % of the static compliance, above the band
ABOVE = tuple(
    Mode(frequency, 0.03, INSIDE[0].stiffness / 0.09 / (2.0 * np.pi * frequency) ** 2, direction)
    for frequency, direction in ((6000.0, (1.0, 0.0, 0.0)), (7000.0, (0.0, 1.0, 0.0)))
)


def case_of(structure, folder, depth, speed="8000 rpm"):
    return Case.from_dict(
        {
            "tool": {"teeth": 3, "diameter": "20 mm"},
            "material": {"Ktc": "700 MPa", "Krc": "250 MPa"},
            "cut": {
                "mode": "down",
                "spindle_speed": speed,
                "feed_per_tooth": "0.1 mm",
                "axial_depth": depth,
                "radial_depth": "8 mm",
            },
            "structure": structure,
        },
        folder=folder,
    )


@pytest.fixture(params=[0.0, 1e-3])
def measured(request, tmp_path):
    rng = np.random.default_rng(2)
    receptance = receptance_matrix((*INSIDE, *ABOVE), LINES)
    files = []
    for i, axis in enumerate("xy"):
        values = receptance[:, i, i]
        noise = rng.normal(size=LINES.size) + 1j * rng.normal(size=LINES.size)
        values = values + request.param * np.abs(values).max() * noise
        rows = ["frequency [Hz],real [m/N],imag [m/N]"]
        rows += [f"{f:.3f},{v.real:.12e},{v.imag:.12e}" for f, v in zip(LINES, values, strict=True)]
        (tmp_path / f"{axis}.csv").write_text("\n".join(rows) + "\n")
        files.append({"file": f"{axis}.csv", "direction": axis})
    return {"frf": files}, tmp_path


def stepped_receptance(bus, frequency):
    """Displacement per force along x, y, z of the stepped modes under a sampled harmonic force.

    From its own recursion: state' = T state + c F + r (F' - F).
    """
    found = np.zeros((frequency.size, 3, 3), dtype=complex)
    turn = np.exp(2j * np.pi * frequency * bus.step)
    for k in range(len(bus.shape)):
        transition = bus.transition[k].reshape(2, 2)
        for n, z in enumerate(turn):
            drive = bus.constant[k] + bus.ramp[k] * (z - 1.0)
            state = np.linalg.solve(z * np.eye(2) - transition, drive)
            found[n] += state[0] * np.outer(bus.shape[k], bus.shape[k])
    return found


def test_stepped_structure_has_the_measured_frf_and_its_static_value(measured):
    structure, folder = measured
    case = case_of(structure, folder, "1 mm")
    modes, notes = modes_of(case)
    stepped = modes_in_time(case, cutter_of(case), modes, notes)
    band = LINES[(LINES > 250.0) & (LINES < 1900.0)][::20]
    exact = receptance_matrix((*INSIDE, *ABOVE), band)
    apart = np.abs(stepped_receptance(stepped.tables.bus, band) - exact).max()
    assert apart < 0.01 * np.abs(exact).max()
    static = stepped_receptance(stepped.tables.bus, np.zeros(1))[0]
    wanted = receptance_matrix((*INSIDE, *ABOVE), 0.0)[0]
    assert static == pytest.approx(wanted, abs=0.01 * abs(wanted[0, 0]))
    assert any("stands for the fitted residual" in note for note in stepped.notes)


def test_steps_are_not_those_of_a_mode_above_the_band(measured):
    structure, folder = measured
    case = case_of(structure, folder, "1 mm")
    stepped = modes_in_time(case, cutter_of(case), structure_of(case).modes)
    # 30 steps a period of a compliance at four times the end of the band are enough
    assert stepped.resolution.steps_per_revolution < 1.1 * 30 * 10000.0 / (8000.0 / 60.0)


def test_limits_by_modes_are_those_of_the_whole_structure(measured):
    structure, folder = measured
    whole = {
        "mode": [
            {
                "frequency": m.frequency,
                "damping": m.damping,
                "mass": m.mass,
                "direction": m.direction,
            }
            for m in (*INSIDE, *ABOVE)
        ]
    }
    lobes = {"speeds": {"from": "6000 rpm", "to": "9000 rpm", "count": 3}, "depths": {"to": "4 mm"}}
    limits = [
        chatter.lobes(
            case_of(given, folder, "1 mm").patch({"lobes": lobes}), method="semi-discretization"
        ).limits.critical_depth
        for given in (structure, whole)
    ]
    assert limits[0] == pytest.approx(limits[1], rel=0.01)


@pytest.mark.parametrize(("depth", "verdict"), [("1.70 mm", "stable"), ("1.80 mm", "chatter")])
def test_verdicts_beside_the_limit(measured, depth, verdict):
    # 1.749 mm with the compliance above the band, 1.654 mm without
    structure, folder = measured
    assert chatter.simulate(case_of(structure, folder, depth)).detection.verdict == verdict
