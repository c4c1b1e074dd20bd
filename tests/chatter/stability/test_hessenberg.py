"""Eigenvalues of Hessenberg matrices against LAPACK and exact ones."""

import numpy as np
import pytest
from numba import njit
from scipy.linalg import hessenberg

from chatter.stability import hessenberg as compiled


@njit
def hessenberg_eigenvalues(h):
    return compiled.hessenberg_eigenvalues(h)


@njit
def hessenberg_vector(h, value):
    return compiled.hessenberg_vector(h, value)


def worst_distance(values, expected):
    """Largest distance of a value to the nearest expected one, both ways."""
    distance = np.abs(values[:, None] - expected[None, :])
    return max(distance.min(axis=0).max(), distance.min(axis=1).max())


def test_random_matrices_against_lapack():
    rng = np.random.default_rng(1)
    for n in (1, 2, 3, 4, 7, 12, 30, 60):
        for _ in range(20):
            h = hessenberg(rng.normal(size=(n, n)))
            expected = np.linalg.eigvals(h)
            got = hessenberg_eigenvalues(h.copy())
            assert worst_distance(got, expected) < 1e-11 * n * np.abs(h).max()


def test_cyclic_permutation_has_the_roots_of_unity():
    # no plain shift converges on it: the exceptional ones must come in
    for n in (3, 4, 8, 15):
        h = np.zeros((n, n))
        h[np.arange(1, n), np.arange(n - 1)] = 1.0
        h[0, -1] = 1.0
        expected = np.exp(2j * np.pi * np.arange(n) / n)
        assert worst_distance(hessenberg_eigenvalues(h), expected) < 1e-10


def test_defective_and_zero_matrices():
    block = np.diag(np.full(5, 0.7)) + np.diag(np.ones(4), 1)
    assert hessenberg_eigenvalues(block) == pytest.approx(np.full(5, 0.7 + 0j))
    assert hessenberg_eigenvalues(np.zeros((4, 4))) == pytest.approx(np.zeros(4))


def test_vector_solves_the_eigenproblem():
    rng = np.random.default_rng(2)
    for n in (2, 5, 20):
        h = hessenberg(rng.normal(size=(n, n)))
        for value in hessenberg_eigenvalues(h.copy()):
            x = hessenberg_vector(h, complex(value))
            assert np.linalg.norm(x) == pytest.approx(1.0)
            assert np.linalg.norm(h @ x - value * x) < 1e-10 * np.abs(h).max()
