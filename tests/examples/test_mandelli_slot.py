"""The slot on the Mandelli M5: torque on Y by statics, and what decides about chatter."""

import numpy as np
import pytest

import chatter
from chatter.compile.machine_cut import machine_cut
from tests.places import EXAMPLES, example_module

EXAMPLES = EXAMPLES
EXAMPLE = EXAMPLES / "mandelli-m5-slot"


@pytest.fixture(scope="module")
def example():
    return example_module("mandelli-m5-slot")


@pytest.fixture(scope="module")
def case():
    return chatter.load(EXAMPLE / "case.toml")


def test_the_machine_is_that_of_the_other_example_but_for_the_place_of_the_cut():
    other = (EXAMPLES / "machine-mandelli-m5" / "machine.toml").read_text()
    moved = other.replace('tool_point = "tool"', 'tool_point = "nose"')
    assert (EXAMPLE / "machine.toml").read_text() == moved


def test_the_torque_on_y_carries_the_mean_force(example, case):
    result = chatter.simulate(case)
    last = example.settled(result)
    # slot: N b (Ktc c / 4 + Kte / pi), through lead / 2 pi
    force = 4 * 10e-3 * (1650e6 * 0.1e-3 / 4 + 92.1e3 / np.pi)
    assert result.torque_of("Y")[last].mean() == pytest.approx(
        -force * 0.02 / (2 * np.pi), rel=2e-3
    )
    # what the controller sees comes back, X stays aside by the mean force over the stiffness
    assert abs(result.position_of("Y")[last].mean()) < 1e-8
    along = -4 * 10e-3 * (426e6 * 0.1e-3 / 4 + 111e3 / np.pi)
    cut = machine_cut(case)
    structure, row = cut.machine.structure, cut.tool[0]
    # no axis moves in X: the static compliance there is that of the structure
    stiffness = structure.stiffness + 1e-3 * structure.mass
    compliance = row @ np.linalg.solve(stiffness, row)
    aside = result.displacement[last, 0].mean()
    assert aside == pytest.approx(compliance * along, rel=0.01)


def test_four_inserts_without_edge_forces_load_y_evenly(example, case):
    result = chatter.simulate(case.patch(example.as_printed(case)))
    torque = result.torque_of("Y")[example.settled(result)]
    force = 4 * 10e-3 * 0.1e-3 / 4 * (1650e6 + 92.1e3 / 10e-3)
    assert np.ptp(torque) < 0.01
    assert torque.mean() == pytest.approx(-force * 0.02 / (2 * np.pi), rel=2e-3)


@pytest.mark.parametrize(("percent", "chatters"), [(1, True), (2, False)])
def test_a_flexible_cutter_chatters_for_want_of_damping(example, case, percent, chatters):
    changes = {"tool_point": "tool", "damping_ratio": percent / 100}
    result = chatter.simulate(example.varied(case, {"simulation.duration": "1.5 s"}, changes))
    heard = result.detection.chatter_frequency
    assert np.isnan(heard) != chatters
    if chatters:
        # the unreduced machine has this mode as well: no artefact of the static shapes
        whole = example.varied(case, {}, {**changes, "highest_frequency": None})
        high = [mode for mode in machine_cut(whole).modes() if mode.frequency > 1500.0]
        softest = min(high, key=lambda mode: mode.stiffness)
        assert heard == pytest.approx(softest.frequency, rel=0.01)
