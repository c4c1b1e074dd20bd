"""Building blocks of the modal identification against what is known of them."""

from __future__ import annotations

import numpy as np
import pytest

from dynamics.identification.band import usable_bands
from dynamics.identification.polynomial import polynomial_basis, polyreference_poles
from dynamics.identification.prepare import noise_level
from dynamics.identification.refinement import fit_residues, refine
from dynamics.identification.residues import ALL_TERMS, Records, mode_shapes_in_frequency
from dynamics.identification.stabilisation import stabilisation_diagram, stable_poles
from dynamics.identification.tall import factorise, gram, product

LINES = np.arange(5.0, 1000.0, 1.0)
FREQUENCY = np.array([120.0, 340.0, 700.0])
DAMPING = np.array([0.02, 0.01, 0.03])


def accelerance(residues):
    s = 2j * np.pi * LINES
    shapes = mode_shapes_in_frequency(s, 2.0 * np.pi * FREQUENCY, DAMPING, 2)
    return shapes.unit @ residues


def test_polynomials_are_orthonormal_and_satisfy_their_recursion():
    z = np.exp(1j * np.linspace(0.4, 0.9, 300))  # a small arc: powers of z are all but dependent
    start = np.linspace(1.0, 2.0, 300)
    basis, hessenberg = polynomial_basis(z, start / np.linalg.norm(start), 40)
    gram = (basis.conj().T @ basis).real
    assert gram == pytest.approx(np.eye(41), abs=1e-12)
    assert np.max(np.abs(z[:, None] * basis[:, :-1] - basis @ hessenberg)) < 1e-12


@pytest.mark.parametrize("references", [1, 2])
def test_poles_of_a_noise_free_structure_are_exact(references):
    rng = np.random.default_rng(1)
    shapes = rng.standard_normal((3, 4))
    values = np.stack(
        [
            np.stack([accelerance(shapes[:, o] * shapes[:, i]) for i in range(references)], axis=1)
            for o in range(4)
        ],
        axis=1,
    )
    orders = polyreference_poles(LINES, values, np.ones(LINES.size), [8, 10, 12, 14, 16])
    diagram = stabilisation_diagram(orders, LINES[0], LINES[-1])
    frequency, damping = stable_poles(diagram)
    for f, z in zip(FREQUENCY, DAMPING, strict=True):
        nearest = int(np.argmin(np.abs(frequency - f)))
        assert frequency[nearest] == pytest.approx(f, rel=1e-4)
        assert damping[nearest] == pytest.approx(z, rel=1e-2)


def test_derivatives_of_the_shapes():
    s = 2j * np.pi * LINES
    step = 1e-6
    w = 2.0 * np.pi * FREQUENCY
    centre = mode_shapes_in_frequency(s, w, DAMPING, 2)
    up = mode_shapes_in_frequency(s, w * np.exp(step), DAMPING, 2).unit
    down = mode_shapes_in_frequency(s, w * np.exp(-step), DAMPING, 2).unit
    assert (up - down) / (2 * step) == pytest.approx(centre.by_frequency, rel=1e-5, abs=1e-4)
    up = mode_shapes_in_frequency(s, w, DAMPING * np.exp(step), 2).unit
    down = mode_shapes_in_frequency(s, w, DAMPING * np.exp(-step), 2).unit
    assert (up - down) / (2 * step) == pytest.approx(centre.by_damping, rel=1e-5, abs=1e-4)


def test_refinement_moves_wrong_poles_to_the_true_ones():
    values = accelerance(np.array([1.0, -2.0, 0.5]))[:, None]
    records = Records(LINES, values, np.full(values.shape, 1e-6), 2)
    start = fit_residues(records, 2.0 * np.pi * FREQUENCY * 1.01, 1.5 * DAMPING, ALL_TERMS)
    model = refine(records, start)
    assert model.chi_square < 1e-6 * start.chi_square
    assert model.poles_in_hertz[0] == pytest.approx(FREQUENCY, rel=1e-9)
    assert model.damping == pytest.approx(DAMPING, rel=1e-7)
    assert model.coefficients[:3, 0] == pytest.approx([1.0, -2.0, 0.5], rel=1e-6)


def test_gradient_of_the_refinement():
    """Variable projection: the gradient is that of the chi-square with residues refitted."""
    rng = np.random.default_rng(2)
    values = accelerance(np.array([1.0, -2.0, 0.5]))[:, None]
    values = values + rng.standard_normal(values.shape) + 1j * rng.standard_normal(values.shape)
    records = Records(LINES, values, np.ones(values.shape), 2)
    point = np.concatenate([np.log(2 * np.pi * FREQUENCY), np.log(1.1 * DAMPING)])

    def model(p):
        return fit_residues(records, np.exp(p[:3]), np.exp(p[3:]), ALL_TERMS)

    for i in range(6):
        step = 1e-5 * np.eye(6)[i]
        slope = (model(point + step).chi_square - model(point - step).chi_square) / 2e-5
        assert slope == pytest.approx(2.0 * model(point).gradient[i], rel=1e-3, abs=1e-2)


@pytest.mark.parametrize("level", [1e-3, 1e-1, 3.0])
def test_noise_is_estimated_beside_resonances(level):
    rng = np.random.default_rng(4)
    random = rng.standard_normal(LINES.size) + 1j * rng.standard_normal(LINES.size)
    values = accelerance(np.array([1.0, 2.0, 0.5])) + level * random / np.sqrt(2.0)
    estimated = noise_level(LINES, values)
    assert np.median(estimated) == pytest.approx(level, rel=0.15)
    assert np.max(estimated) < 1.7 * level
    assert np.min(estimated) > 0.5 * level


def test_band_ends_where_the_signal_sinks_into_noise():
    clean = accelerance(np.array([1.0, 1.0, 1.0]))
    noise = np.where(LINES > 850.0, 30.0, 0.01) * np.ones(LINES.size)
    rng = np.random.default_rng(5)
    random = rng.standard_normal(LINES.size) + 1j * rng.standard_normal(LINES.size)
    values = (clean + noise * random / np.sqrt(2.0)) / (2j * np.pi * LINES) ** 2
    sigma = noise / (2.0 * np.pi * LINES) ** 2
    searched, band = usable_bands(LINES, values[:, None], sigma[:, None], 2)
    assert band.highest == pytest.approx(850.0, abs=15.0)
    assert searched.lowest <= band.lowest < FREQUENCY[0]
    assert "above: noise" in band.reason


def test_band_follows_coherence():
    values = accelerance(np.array([1.0, 1.0, 1.0])) / (2j * np.pi * LINES) ** 2
    sigma = np.full(LINES.size, 1e-12)
    coherence = np.where(LINES < 60.0, 0.1, 0.99)
    _, band = usable_bands(LINES, values[:, None], sigma[:, None], 2, coherence[:, None])
    assert band.lowest == pytest.approx(60.0, abs=10.0)


@pytest.mark.parametrize("shape", [(100, 7), (1000, 7), (2500, 30)])
def test_blockwise_algebra_is_that_of_the_whole(shape):
    rng = np.random.default_rng(6)
    matrix, other = rng.standard_normal(shape), rng.standard_normal((shape[0], 3))
    basis, triangle = factorise(matrix)
    assert basis.T @ basis == pytest.approx(np.eye(shape[1]), abs=1e-12)
    assert basis @ triangle == pytest.approx(matrix, abs=1e-12)
    assert np.tril(triangle, -1) == pytest.approx(np.zeros((shape[1], shape[1])), abs=1e-14)
    assert gram(matrix, other) == pytest.approx(matrix.T @ other)
    assert product(other, triangle[:3]) == pytest.approx(other @ triangle[:3])


@pytest.mark.parametrize("apart", [0.3, 1e-3, 1e-7])
def test_residues_are_those_of_plain_least_squares(apart):
    """Two poles ever nearer to one another: normal equations must give way before they fail."""
    w = 2.0 * np.pi * np.array([300.0, 300.0 * (1.0 + apart)])
    damping = np.array([0.02, 0.02])
    s = 2j * np.pi * LINES
    noise = 1.0 + 0.3 * np.sin(LINES)
    rng = np.random.default_rng(3)
    values = (rng.normal(size=LINES.size) + 1j * rng.normal(size=LINES.size))[:, None]
    records = Records(LINES, values, noise[:, None], 0)
    model = fit_residues(records, w, damping, ())
    unit = 1.0 / (s[:, None] ** 2 + 2.0 * s[:, None] * damping * w + w**2)
    columns = np.hstack([unit, unit * s[:, None] / w]) / noise[:, None]
    scaled = np.vstack([columns.real, columns.imag])
    size = np.linalg.norm(scaled, axis=0)
    target = np.concatenate([(values[:, 0] / noise).real, (values[:, 0] / noise).imag])
    basis, _ = np.linalg.qr(scaled / size)
    left = target - basis @ (basis.T @ target)
    assert model.chi_square == pytest.approx(left @ left, rel=1e-9)
    # what the poles move lies across the columns of the residues
    step = 1e-6
    for place in range(2):
        moved = w.copy()
        moved[place] *= 1.0 + step
        back = w.copy()
        back[place] *= 1.0 - step
        slope = (
            fit_residues(records, moved, damping, ()).chi_square
            - fit_residues(records, back, damping, ()).chi_square
        ) / (4.0 * step)
        assert model.gradient[place] == pytest.approx(slope, rel=1e-3, abs=1e-2)
    assert np.all(np.linalg.eigvalsh(model.normal) > -1e-9 * np.max(np.abs(model.normal)))
