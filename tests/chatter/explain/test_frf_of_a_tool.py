"""FRF of a tool with three modes, of which the declared case has two."""

import numpy as np
import pytest

import chatter
from chatter.explain.checking import checked
from chatter.explain.kinds.kind_list import KINDS
from chatter.explain.measurement_file import read_measurement

#: natural frequency, Hz, damping ratio, modal mass, kg: those of a real tool, as its tap gives them
MODES = ((1068.4, 0.036, 0.466), (1970.0, 0.0436, 0.331), (2608.4, 0.0292, 0.290))
#: the same of small resonances that a tool has everywhere, and no engineer writes down
SMALL = ((620.0, 0.03, 25.0), (1430.0, 0.02, 12.0), (2290.0, 0.02, 9.0), (3120.0, 0.02, 4.0))
LINES = np.arange(400.0, 3500.0, 2.0)
#: parts of the structure beyond the band, as of any real tool, m/N
RESIDUAL = 4e-9


def written(folder, missing):
    """Folder with the FRF of all modes, by its formula, and a case without one of them."""
    omega = 2.0 * np.pi * LINES
    answer = np.full(LINES.size, RESIDUAL, dtype=complex)
    for frequency, damping, mass in MODES + SMALL:
        own = 2.0 * np.pi * frequency
        answer += 1.0 / mass / (own**2 - omega**2 + 2j * damping * own * omega)
    noise = np.random.default_rng(3).standard_normal((2, LINES.size))
    answer *= 1.0 + 0.01 * (noise[0] + 1j * noise[1])
    columns = np.column_stack([LINES, answer.real, answer.imag])
    heading = "frequency [Hz],real [m/N],imag [m/N]"
    np.savetxt(folder / "x.csv", columns, delimiter=",", header=heading, comments="")
    case = '[tool]\nteeth = 4\ndiameter = "10 mm"\n'
    for number, (frequency, damping, mass) in enumerate(MODES):
        if number != missing:
            case += (
                f'[[structure.mode]]\nfrequency = "{frequency} Hz"\ndamping = {damping}\n'
                f'mass = "{mass} kg"\ndirection = [1, 0, 0]\n'
            )
    (folder / "case.toml").write_text(case)
    run = '[[run]]\nfile = "x.csv"\ncondition = "idle"\ndirection = "x"\n'
    (folder / "measurement.toml").write_text(f'kind = "frf"\ncase = "case.toml"\n{run}')


@pytest.mark.parametrize("missing", range(3))
def test_the_mode_that_is_missing_is_named_among_small_resonances(tmp_path, missing):
    written(tmp_path, missing)
    found = chatter.explain(tmp_path).summary()
    (effect,) = found["effects"]
    assert effect["name"] == "missing_mode"
    frequency = effect["parameters"]["frequency"]["value"]
    assert frequency == pytest.approx(MODES[missing][0], rel=0.02)


def test_declared_modes_are_refitted_within_six_tolerances(tmp_path):
    """Without bounds those of a real tool went 90 off, to where one was missing, and hid it."""
    written(tmp_path, 0)
    measurement = checked(read_measurement(tmp_path)).measurement
    declared = KINDS["frf"].nuisance_parameters(measurement)
    assert len(declared) == 6
    for one in declared:
        # damping is known by a factor of 1.2
        by_factor = one.name.endswith("damping")
        highest = one.start * 1.2**6 if by_factor else one.start + 6.0 * one.size
        assert one.upper == pytest.approx(highest)
        assert one.lower >= (one.start / 1.2**6 if by_factor else one.start - 6.0 * one.size) - 1e-9
