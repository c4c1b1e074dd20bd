"""The face mill enters a block of voxels or dexels: chatter sets in, in the published order."""

import numpy as np
import pytest

import chatter
from tests.places import EXAMPLES, example_module

EXAMPLE = EXAMPLES / "face-mill-chatter"
SPEED, FEED = 840.0 / 60.0, 840.0 / 60.0 * 5 * 0.2e-3


@pytest.fixture(scope="module")
def example():
    return example_module("face-mill-chatter")


@pytest.fixture(scope="module")
def case():
    return chatter.load(EXAMPLE / "case.toml").patch({"simulation.duration": "3 s"})


@pytest.fixture(scope="module")
def entering(example, case):
    return example.simulated(case, example.RUNS, "voxel")


def test_the_tool_comes_from_the_air(entering):
    result = entering["neither"]
    # the corner of the block is 0.5 mm before the circle of the cutter
    circle = np.sqrt(25.0**2 - 20.0**2) * 1e-3
    first = result.time[np.argmax(np.abs(result.force[:, 1]) > 1.0)]
    reached = (15.5e-3 - circle) / FEED
    assert reached <= first < reached + 1.0 / SPEED


def test_chatter_sets_in_when_the_paper_says(example, entering):
    """About 1 s without both, later with friction, after 2 s with friction and contact."""
    onsets = {name: example.begun(result) for name, result in entering.items()}
    assert onsets["neither"] == pytest.approx(1.0, abs=0.15)
    assert onsets["neither"] + 0.25 < onsets["friction"] < 2.0
    assert 2.0 < onsets["friction and contact"] < 3.0
    frequency = entering["neither"].detection.chatter_frequency
    assert frequency == pytest.approx(50.0, rel=0.05)


@pytest.mark.nightly
def test_every_run_has_what_it_needs(example, case):
    """The fourth run ploughs, which asks for a clearance angle that the others do not need."""
    begun = case.patch({"simulation.duration": "0.02 s"})
    results = example.simulated(begun, {**example.RUNS, **example.FOURTH}, "dexel")
    assert all(result.time[-1] >= 0.019 for result in results.values())
    assert results["friction and ploughing"].case.tool.clearance_angle == pytest.approx(
        0.1222, 1e-3
    )


@pytest.mark.nightly
def test_voxels_and_dexels_agree_on_a_machine(example, case, entering):
    """Before chatter the forces agree as far as the grids allow; the onset within two turns."""
    dexel = example.simulated(case, {"friction": {}}, "dexel")["friction"]
    voxel = entering["friction"]
    early = (voxel.time > 0.2) & (voxel.time < 0.8)
    apart = voxel.force[early] - dexel.force[early]
    assert np.sqrt(np.mean(apart**2)) < 0.05 * np.sqrt(np.mean(voxel.force[early] ** 2))
    assert example.begun(dexel) == pytest.approx(example.begun(voxel), abs=2.1 / SPEED)


def test_the_spindle_drive_gives_the_power_of_the_cut(entering):
    """Ktc times removal rate, and edge forces at the cutting speed of the teeth in the cut."""
    result = entering["friction and contact"]
    settled = (result.time > 1.0) & (result.time < 2.0)
    power = np.mean(result.torque_of("S")[settled]) * 2.0 * np.pi * SPEED
    removed = 1800e6 * 5e-3 * 5e-3 * FEED
    teeth_in_cut = 5 * np.arccos(1.0 - 5.0 / 25.0) / (2.0 * np.pi)
    edges = 40e3 * 5e-3 * teeth_in_cut * 2.0 * np.pi * SPEED * 25e-3
    assert power == pytest.approx(removed + edges, rel=0.02)
