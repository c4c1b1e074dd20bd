"""Forced vibration of the steady cut: against the simulation, and where it is told."""

import math
import re

import numpy as np
import pytest

import chatter
from chatter.description.case import Case
from chatter.stability.forced_vibration import forced_vibration, notes_on_steady_cut
from chatter.stability.methods.time_domain.critical_depths import growths
from chatter.stability.model import milling_model
from chatter.stability.registry import METHODS

RPM = math.pi / 30.0


def cut_of(tool=None, cut=None, **sections):
    """docs/methods.md, where the linear limits and the simulation part."""
    return Case.from_dict(
        {
            "tool": {
                "teeth": 3, "diameter": 10e-3, "pitch": ["110 deg", "120 deg", "130 deg"],
                **(tool or {}),
            },
            "material": {"Ktc": 767.01e6, "Krc": 168.8e6},
            "cut": {
                "mode": "up", "spindle_speed": 11000 * RPM, "feed_per_tooth": 6e-5,
                "axial_depth": 2.2e-3, "radial_depth": 3e-3, **(cut or {}),
            },
            "structure": {
                "mode": [
                    {"frequency": 1400, "damping": 0.03, "stiffness": 9e6, "direction": [1, 0, 0]},
                    {"frequency": 1500, "damping": 0.03, "stiffness": 8e6, "direction": [0, 1, 0]},
                ]
            },
            **sections,
        }
    )  # fmt: skip


def vibration_of(case):
    model = milling_model(case)
    return forced_vibration(model, case.cut.spindle_speed, case.cut.axial_depth)


def told(notes):
    return [note for note in notes if "teeth lose contact" in note]


def test_the_example_of_the_docs_is_told_and_its_numbers_are_those():
    case = cut_of()
    found = chatter.check(case)
    model = milling_model(case)
    (simulated,) = growths(
        case, model.structure.modes, np.array([case.cut.spindle_speed]), np.array([2.2e-3])
    )
    assert found.spectral_radius == pytest.approx(1.10, abs=0.01)
    assert simulated.radius == pytest.approx(0.838, abs=0.01)
    assert len(told(found.notes)) == 1
    assert "14%" in told(found.notes)[0]
    assert not told(notes_on_steady_cut(model, METHODS["time-domain"]))


@pytest.mark.nightly
def test_lobes_of_linear_methods_tell_it_and_those_in_time_do_not():
    short = cut_of().patch(
        {"lobes": {"speeds": {"from": "10900 rpm", "to": "11100 rpm", "count": 3}}}
    )
    assert told(chatter.lobes(short).notes) == told(chatter.check(cut_of()).notes)
    assert not told(chatter.lobes(short, "time-domain").notes)


def test_a_shallower_cut_where_both_agree_is_not_told():
    case = cut_of(cut={"axial_depth": 1.5e-3})
    found = chatter.check(case)
    model = milling_model(case)
    (simulated,) = growths(
        case, model.structure.modes, np.array([case.cut.spindle_speed]), np.array([1.5e-3])
    )
    assert found.spectral_radius == pytest.approx(simulated.radius, rel=0.04)
    assert not told(found.notes)


@pytest.mark.parametrize("given", [{}, {"helix": "40 deg"}, {"kind": "ball", "helix": "25 deg"}])
def test_even_teeth_never_are(given):
    """All meet the wave in phase: the chip is that of a rigid tool."""
    case = cut_of()
    data = case.model_dump(exclude_none=True, by_alias=True)
    case = Case.from_dict({**data, "tool": {"teeth": 3, "diameter": 10e-3, **given}})
    assert vibration_of(case) is None
    assert not told(chatter.check(case).notes)


@pytest.mark.parametrize(("rpm", "parts"), [(5000, False), (8000, True), (10000, False)])
def test_on_the_benchmark_of_unequal_pitch_where_the_simulation_parts(rpm, parts):
    """validation 4 at the limits published there: 70 and 110 degrees."""
    modes = [
        (441.64, 0.028722, 11.125, [1, 0, 0]), (563.6, 0.055801, 1.4986, [1, 0, 0]),
        (778.56, 0.058996, 13.063, [1, 0, 0]), (516.21, 0.025004, 1.199, [0, 1, 0]),
    ]  # fmt: skip
    keys = ("frequency", "damping", "mass", "direction")
    depth = {5000: 6.1649e-3, 8000: 4.9829e-3, 10000: 2.5674e-3}[rpm]
    case = Case.from_dict(
        {
            "tool": {
                "teeth": 4, "diameter": 19.05e-3,
                "pitch": ["70 deg", "110 deg", "70 deg", "110 deg"],
            },
            "material": {"Ktc": 697e6, "Krc": 255.8e6},
            "cut": {
                "mode": "down", "spindle_speed": rpm * RPM, "feed_per_tooth": 1e-4,
                "axial_depth": depth, "radial_depth": 0.5 * 19.05e-3,
            },
            "structure": {"mode": [dict(zip(keys, mode, strict=True)) for mode in modes]},
        }
    )  # fmt: skip
    model = milling_model(case)
    (simulated,) = growths(case, model.structure.modes, np.array([rpm * RPM]), np.array([depth]))
    assert (abs(simulated.radius - 1.0) > 0.1) == parts
    assert bool(notes_on_steady_cut(model, METHODS["collocation"])) == parts


@pytest.mark.parametrize("depth_mm", [0.6, 1.2])
def test_the_amplitude_is_that_of_a_simulated_steady_cut(depth_mm):
    case = cut_of(
        {"helix": "20 deg"},
        {"axial_depth": depth_mm * 1e-3},
        simulation={"revolutions": 60, "chip": "delay"},
    )
    found = vibration_of(case)
    result = chatter.simulate(case)
    last = result.time > result.time[-1] - 2.0 * 60.0 / 11000.0
    motion = result.displacement[last][:, :2]
    amplitude = np.linalg.norm(motion - motion.mean(axis=0), axis=1).max()
    # both have the mean over a turn taken off; the simulation also moves out of the width of cut
    assert found.amplitude == pytest.approx(amplitude, rel=0.05)


def test_it_grows_with_the_feed_and_the_share_missed_does_not():
    """Linear in the feed, where no edge force stands beside it."""
    small, large = vibration_of(cut_of()), vibration_of(cut_of(cut={"feed_per_tooth": 1.8e-4}))
    assert large.amplitude == pytest.approx(3.0 * small.amplitude, rel=1e-9)
    assert large.chip_change == pytest.approx(3.0 * small.chip_change, rel=1e-9)
    assert large.loss_of_contact == pytest.approx(small.loss_of_contact, abs=1e-9)


def test_a_thick_chip_is_told_in_millimetres():
    """h = f_z sin(phi) of the widest pitch, 130 deg of 120, at the exit cos(phi) = 1 - 3/5."""
    chip = 0.3 * 130.0 / 120.0 * math.sqrt(1.0 - 0.4**2)
    (note,) = told(chatter.check(cut_of(cut={"feed_per_tooth": 0.3e-3})).notes)
    shown = re.search(r"changes the chip of ([0-9.]+) mm by up to [0-9.]+ mm:", note)
    assert float(shown[1]) == pytest.approx(chip, rel=0.02)
    assert " um" not in note


def test_one_tooth_that_alone_cuts_keeps_its_chip():
    """Two teeth, one set back beyond the feed: the other meets its own wave in phase."""
    tool = {"pitch": ["180 deg", "180 deg"], "teeth": 2, "radial_error": ["0 um", "-1 mm"]}
    assert vibration_of(cut_of(tool)) is None
