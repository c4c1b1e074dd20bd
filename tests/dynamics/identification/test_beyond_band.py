"""Modes for what lies beyond the band: static value and FRF of structures that are known."""

import numpy as np
import pytest

from dynamics.frf.container import Frf, Point
from dynamics.identification.fit import identify_modes
from dynamics.modal.modes import Mode, receptance_matrix

INSIDE = (Mode(800.0, 0.03, 0.05), Mode(900.0, 0.025, 0.07))
STATIC = sum(1.0 / mode.stiffness for mode in INSIDE)


def beyond(frequency, damping, share, direction=(1.0, 0.0, 0.0)):
    """Mode whose static compliance is a share of that of the modes inside."""
    mass = 1.0 / (share * STATIC * (2.0 * np.pi * frequency) ** 2)
    return Mode(frequency, damping, mass, direction)


def fitted(modes, lines, noise, quantity, pairs=("xx",)):
    """Modal fit of what these modes give on these lines, with noise over the peak."""
    rng = np.random.default_rng(4)
    exact = receptance_matrix(modes, lines)
    frfs = []
    for pair in pairs:
        i, j = ("xyz".index(axis) for axis in pair)
        values = exact[:, i, j] * (1.0 if quantity == "receptance" else -((2 * np.pi * lines) ** 2))
        size = noise * np.abs(values).max()
        values = values + size * (rng.normal(size=lines.size) + 1j * rng.normal(size=lines.size))
        frfs.append(Frf(lines, values, quantity, Point("1", pair[0]), Point("1", pair[1])))
    return identify_modes(frfs)


@pytest.mark.parametrize("quantity", ["receptance", "accelerance"])
@pytest.mark.parametrize("noise", [0.0, 1e-4, 1e-3])
@pytest.mark.parametrize(
    "outside",
    [
        [beyond(6000.0, 0.03, 0.09)],
        [beyond(3200.0, 0.03, 0.15)],
        [beyond(6000.0, 0.03, 0.05), beyond(9000.0, 0.02, 0.04), beyond(15000.0, 0.02, 0.04)],
    ],
)
def test_compliance_above_the_band(outside, noise, quantity):
    lines = np.arange(200.0, 2500.0, 4.0)
    truth = [*INSIDE, *outside]
    fit = fitted(truth, lines, noise, quantity)
    found = [*fit.modes, *fit.beyond.modes]
    static = receptance_matrix(found, 0.0)[0, 0, 0].real
    assert static == pytest.approx(receptance_matrix(truth, 0.0)[0, 0, 0].real, rel=0.015)
    exact = receptance_matrix(truth, lines)[:, 0, 0]
    apart = np.abs(receptance_matrix(found, lines)[:, 0, 0] - exact).max()
    assert apart < 0.01 * np.abs(exact).max()
    assert fit.beyond.misfit < 0.005


# the lines say less of a mode at 0.4 of the first of them the noisier they are
@pytest.mark.parametrize(("noise", "tolerance"), [(0.0, 1e-3), (1e-4, 0.1)])
def test_mode_below_the_band(noise, tolerance):
    lines = np.arange(100.0, 2500.0, 4.0)
    truth = [*INSIDE, beyond(40.0, 0.05, 0.5)]
    fit = fitted(truth, lines, noise, "receptance")
    assert [mode.band for mode in fit.beyond.modes] == ["below"]
    found = [*fit.modes, *fit.beyond.modes]
    static = receptance_matrix(found, 0.0)[0, 0, 0].real
    assert static == pytest.approx(1.5 * STATIC, rel=tolerance)


def test_free_body_keeps_its_mass_line():
    lines = np.arange(100.0, 2500.0, 4.0)
    truth = [*INSIDE, Mode(1e-3, 0.1, 5.0)]
    fit = fitted(truth, lines, 1e-4, "receptance")
    found = [*fit.modes, *fit.beyond.modes]
    exact = receptance_matrix(truth, lines)[:, 0, 0]
    apart = np.abs(receptance_matrix(found, lines)[:, 0, 0] - exact)
    assert apart.max() < 0.01 * np.abs(exact).max()
    # the spring that the lines do not contradict, far below the first of them
    (low,) = fit.beyond.modes
    assert low.mass == pytest.approx(5.0, rel=0.01)
    assert 10.0 < low.frequency < 67.0


def test_compliance_along_a_direction_of_its_own():
    diagonal = (np.cos(0.5), np.sin(0.5), 0.0)
    truth = [
        Mode(800.0, 0.03, 0.05, (np.cos(0.2), np.sin(0.2), 0.0)),
        Mode(900.0, 0.03, 0.05, (-np.sin(0.2), np.cos(0.2), 0.0)),
        beyond(7000.0, 0.03, 0.2, diagonal),
    ]
    lines = np.arange(200.0, 2500.0, 4.0)
    fit = fitted(truth, lines, 5e-4, "receptance", ("xx", "xy", "yx", "yy"))
    found = [*fit.modes, *fit.beyond.modes]
    exact = receptance_matrix(truth, 0.0)[0].real
    static = receptance_matrix(found, 0.0)[0].real
    assert static == pytest.approx(exact, abs=0.015 * exact.max())


def test_nothing_beyond_the_band():
    fit = fitted(INSIDE, np.arange(100.0, 2500.0, 4.0), 1e-3, "receptance")
    static = sum(1.0 / mode.stiffness for mode in fit.beyond.modes)
    assert static < 0.01 * STATIC
