"""Simulated cuts against an independent simulator and against measurements with known truth."""

import dataclasses

import numpy as np
import pytest

from chatter import Case
from chatter.simulation.simulate import simulate
from tests.places import DATA
from tests.validation.reference import time_domain_check as sets
from tests.validation.reference.time_domain import nrmse, to_case_dict
from tests.validation.reference.time_domain_store import REVOLUTIONS, SIGNALS, load, sample_times

MEASUREMENTS = DATA / "whole-measurements"
CUTS = load()


def simulated(cut, revolutions):
    document = to_case_dict(cut)
    document["simulation"] = {"revolutions": revolutions}
    return simulate(Case.from_dict(document))


def signals_at(found, times):
    """Fx, Fy, Fz, x, y (n, 5) at times, straight between the rows."""
    table = np.hstack([found.force, found.displacement[:, :2]])
    return np.stack([np.interp(times, found.time, column) for column in table.T], axis=1)


def away_from_jumps(cut, found, times):
    """Samples that are not within two rows of a jump in the force on a straight edge.

    Such an edge enters, leaves or loses the work at once; the instant is known to a step at best.
    """
    if any(cut.helix):
        return np.ones(times.size, dtype=bool)
    force = found.force[:, 2]
    jump = np.abs(np.diff(force)) > 0.05 * np.ptp(force)
    near = np.convolve(jump, np.ones(5), mode="same") > 0
    row = np.searchsorted(found.time, times, side="right") - 1
    return ~near[np.minimum(row, near.size - 1)]


@pytest.mark.parametrize("number", range(len(CUTS)))
def test_random_cut_with_its_transient(number):
    """Whole run from the first contact, at default settings, within 1 %."""
    cut, wanted = CUTS[number]
    found = simulated(cut, REVOLUTIONS)
    times = sample_times(cut)
    got = signals_at(found, times)
    kept = away_from_jumps(cut, found, times)
    assert kept.mean() > 0.9
    moving = np.abs(wanted).max(axis=0) > 1e-9
    assert moving[:3].all()
    errors = {
        name: nrmse(got[kept, i], wanted[kept, i]) for i, name in enumerate(SIGNALS) if moving[i]
    }
    assert max(errors.values()) < 0.01, errors


def test_the_random_cuts_are_of_all_kinds():
    cuts = [cut for cut, _ in CUTS]
    assert {cut.mode for cut in cuts} == {"up", "down", "slot"}
    assert any(cut.exponent for cut in cuts)
    assert any(cut.damping_coefficient and cut.damping_friction for cut in cuts)
    assert any(cut.runout_offset for cut in cuts)
    assert any(np.ptp(cut.pitch) > 1e-3 for cut in cuts)
    assert any(not any(cut.helix) for cut in cuts)
    assert any(mode.side == "workpiece" for cut in cuts for mode in cut.modes)


def with_what_the_truth_leaves_out(name, cut):
    """The truth gives neither the friction of process damping nor the reference thickness."""
    if name == "set-103":
        return dataclasses.replace(cut, damping_friction=0.3)
    if name == "set-104":
        return dataclasses.replace(cut, h0=1e-4)
    return cut


@pytest.mark.parametrize("name", ["set-101", "set-102", "set-103", "set-104", "set-107"])
def test_measurements_are_met_to_their_noise(name):
    cuts, tables, truth = sets.load(MEASUREMENTS / name)
    noise = np.array(truth["noise"])
    residual = []
    for cut, table in zip(cuts, tables, strict=True):
        times = np.arange(len(table)) / 12800.0
        whole = with_what_the_truth_leaves_out(name, cut)
        found = simulated(whole, times[-1] / cut.period + 0.1)
        got = signals_at(found, times)[:, [0, 1, 3, 4]]
        got[:, 2:] *= 1e6
        residual.append([nrmse(got[:, i], table[:, 2 + i]) for i in range(4)])
    assert np.all(np.mean(residual, axis=0) < 1.05 * noise + 1e-3)
