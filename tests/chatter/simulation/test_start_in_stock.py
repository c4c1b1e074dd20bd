"""A tool that stands in its stock at the start: what it stands in is cleared and said."""

import math

import numpy as np
import pytest

from chatter import Case, InputError
from chatter.simulation.simulate import simulate

RADIUS, DEPTH, FEED, TEETH = 5e-3, 2e-3, 0.08e-3, 3
KTC, KTE = 8e8, 1e4
BLOCK = {"x": [-20e-3, 40e-3], "y": [-20e-3, 20e-3], "z": [0.0, 5e-3]}


def case(chip, stock, tool=None, structure=None, **simulation):
    content = {
        "tool": {"kind": "end mill", "teeth": TEETH, "diameter": 2.0 * RADIUS, **(tool or {})},
        "material": {"Ktc": KTC, "Krc": 3e8, "Kte": KTE},
        "cut": {
            "mode": "slot",
            "spindle_speed": "4000 rpm",
            "feed_per_tooth": FEED,
            "axial_depth": DEPTH,
            "radial_depth": 2.0 * RADIUS,
        },
        "stock": {"box": stock},
        "simulation": {
            "chip": chip, "steps": 720, "slices": 2, "resolution": "50 um", "revolutions": 4,
            **simulation,
        },
    }  # fmt: skip
    if structure:
        content["structure"] = {"mode": structure}
    return Case.from_dict(content)


def said(found):
    return [note for note in found.notes if "cleared before the first step" in note]


def steady_forces(revolutions=2):
    """Slot of the delayed chip."""
    content = case("dexel", [BLOCK]).model_dump(mode="json", exclude_unset=True)
    content.pop("stock")
    content["simulation"] = {"revolutions": revolutions}
    return simulate(Case.from_dict(content))


@pytest.mark.parametrize("chip", ["dexel", "voxel"])
@pytest.mark.parametrize("path", [None, [[3e-3, 2e-3], [3e-3, 15e-3], [20e-3, 15e-3]]])
def test_in_the_middle_of_a_block(chip, path):
    """The first forces are those of a slot, not of a chip as thick as the tool."""
    found = simulate(case(chip, [BLOCK], **({"path": path} if path else {})))
    wanted = steady_forces()
    noisy = 1.5 if chip == "voxel" else 1.05
    largest = np.linalg.norm(wanted.force, axis=1).max()
    assert np.linalg.norm(found.force, axis=1).max() < noisy * largest
    assert found.power.max() < noisy * wanted.power.max()
    last = slice(-720, None)
    assert found.power[last].mean() == pytest.approx(wanted.power[last].mean(), rel=0.03)
    (note,) = said(found)
    assert f"{math.pi * RADIUS**2 * DEPTH * 1e9:.3g}" in note
    assert ("simulation.path[0]" in note) == (path is not None)
    # nothing that was cleared counts as cut
    swept = 2.0 * RADIUS * DEPTH * FEED * TEETH * 4
    removed = float(found.setup.groups[0].removed[0])
    assert removed == pytest.approx(swept, rel=0.1)


@pytest.mark.parametrize("chip", ["dexel", "voxel"])
def test_partly_in_the_block(chip):
    """A front through the axis: half of the tool stands in the block."""
    block = {**BLOCK, "x": [0.0, 40e-3]}
    found = simulate(case(chip, [block]))
    (note,) = said(found)
    half = 0.5 * math.pi * RADIUS**2 * DEPTH * 1e9
    given = float(note.split(" mm3")[0].split()[-1])
    assert given == pytest.approx(half, rel=0.01)
    noisy = 1.5 if chip == "voxel" else 1.05
    assert found.power.max() < noisy * steady_forces().power.max()


@pytest.mark.parametrize("kind", ["ball", "taper", "bull nose"])
def test_tools_of_other_profiles(kind):
    more = {"taper": {"taper_angle": "10 deg"}, "bull nose": {"corner_radius": "1 mm"}}
    tool = {"kind": kind, "helix": "30 deg", "runout": {"offset": "20 um"}, **more.get(kind, {})}
    found = simulate(case("dexel", [BLOCK], tool, slices=12))
    assert said(found)
    thickest = TEETH * FEED + 40e-6
    edge = 0.5 * math.pi * RADIUS if kind == "ball" else 1.3 * DEPTH
    # no tooth ever meets more than the chip of a revolution
    assert np.abs(found.torque).max() < 2.0 * (KTC * thickest + KTE) * edge * 1.4 * RADIUS


@pytest.mark.parametrize("chip", ["dexel", "voxel"])
def test_from_the_air_nothing_is_cleared(chip):
    block = {**BLOCK, "x": [RADIUS, 40e-3]}
    found = simulate(case(chip, [block]))
    assert not said(found)


def test_vibrating_tool_begins_without_a_blow():
    mode = {"frequency": "600 Hz", "damping": 0.04, "stiffness": "2e7 N/m", "direction": [0, 1, 0]}
    found = simulate(case("dexel", [BLOCK], structure=[mode], revolutions=12))
    wanted = steady_forces()
    assert said(found)
    assert np.linalg.norm(found.force, axis=1).max() < 1.6 * np.abs(wanted.force).max()


def test_second_cut_that_begins_in_what_the_first_has_left():
    first = simulate(case("dexel", [BLOCK], path=[[-26e-3, 0.0], [60e-3, 0.0]]))
    again = first.case.patch({"simulation.path": [[10e-3, 8e-3], [60e-3, 8e-3]], "stock": None})
    second = simulate(again, workpiece=first)
    assert said(second)
    assert second.power.max() < 1.05 * steady_forces().power.max()


def test_stock_within_the_tool_is_refused():
    inside = {"x": [-2e-3, 2e-3], "y": [-2e-3, 2e-3], "z": [0.0, 5e-3]}
    with pytest.raises(InputError, match="all of the stock lies within the tool"):
        simulate(case("dexel", [inside]))
