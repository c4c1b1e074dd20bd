"""Modes with static shapes: exact statics, frequencies kept, response in the band."""

import numpy as np
import pytest
import scipy.linalg

from dynamics.reduction.modal_truncation import undamped_modes, with_static_shapes
from dynamics.structure.linear_structure import LinearStructure

HIGHEST = 160.0


def chain(free):
    """Thirty masses in a row, 0 to 640 Hz, held at one end or free."""
    size, mass, spring = 30, 2.0, 8e6
    stiffness = spring * (2.0 * np.eye(size) - np.eye(size, k=1) - np.eye(size, k=-1))
    stiffness[-1, -1] = spring
    if free:
        stiffness[0, 0] = spring
    points = {}
    for name, place in (("end", -1), ("middle", 14)):
        points[name] = np.zeros((6, size))
        points[name][0, place] = 1.0
    return LinearStructure(mass * np.eye(size), 2e-5 * stiffness, stiffness, points)


def ports(structure):
    return np.array([structure.port(name, [1, 0, 0]) for name in ("end", "middle")])


def reduced(structure):
    modes = undamped_modes(structure, HIGHEST)
    return modes, *with_static_shapes(structure, modes, ports(structure))


def test_statics_are_exact():
    structure = chain(free=False)
    modes, compact, basis = reduced(structure)
    rows, small = ports(structure), ports(structure) @ basis
    wanted = rows @ np.linalg.solve(structure.stiffness, rows.T)
    found = small @ np.linalg.solve(compact.stiffness, small.T)
    assert found == pytest.approx(wanted, rel=1e-9)
    assert ports(compact) == pytest.approx(small)
    # the modes alone miss a part
    alone = rows @ modes.shapes / (2.0 * np.pi * modes.frequency)
    assert np.abs(alone @ alone.T - wanted).max() > 1e-3 * wanted.max()


@pytest.mark.parametrize("free", [False, True])
def test_frequencies_are_kept(free):
    structure = chain(free)
    modes, compact, _ = reduced(structure)
    count = modes.frequency.size
    whole = structure.natural_frequencies(count)
    assert compact.size < 20
    assert compact.size == count + 2
    assert compact.natural_frequencies(count) == pytest.approx(whole, rel=1e-8, abs=1e-3)
    assert compact.natural_frequencies()[count] > HIGHEST


@pytest.mark.parametrize("free", [False, True])
def test_response_in_the_band(free):
    structure = chain(free)
    modes, compact, basis = reduced(structure)
    lines = np.linspace(3.0, 0.75 * HIGHEST, 40)
    wanted = structure.receptance(lines, ports(structure))
    found = compact.receptance(lines, ports(structure) @ basis)
    scale = np.max(np.abs(wanted), axis=0)
    assert np.max(np.abs(found - wanted) / scale) < 1e-3
    # better than the modes alone, by far
    only = LinearStructure(
        np.eye(modes.frequency.size),
        modes.shapes.T @ structure.damping @ modes.shapes,
        np.diag((2.0 * np.pi * modes.frequency) ** 2),
        {},
    )
    alone = only.receptance(lines, ports(structure) @ modes.shapes)
    assert np.max(np.abs(alone - wanted)) > 5.0 * np.max(np.abs(found - wanted))


def test_inertia_of_a_free_structure_is_kept():
    """Slow forces accelerate all of it: the receptance tends to -1/(m w^2)."""
    structure = chain(free=True)
    _, compact, basis = reduced(structure)
    (value,) = compact.receptance([0.5], ports(structure)[:1] @ basis).ravel()
    assert value.real == pytest.approx(-1.0 / (60.0 * np.pi**2), rel=1e-2)


def test_shapes_that_say_nothing_new_are_left_out():
    structure = chain(free=False)
    modes = undamped_modes(structure, HIGHEST)
    twice = np.vstack([ports(structure), ports(structure)])
    compact, _ = with_static_shapes(structure, modes, twice)
    assert compact.size == modes.frequency.size + 2
    every = undamped_modes(structure)
    whole, basis = with_static_shapes(structure, every, twice)
    assert whole.size == structure.size
    assert scipy.linalg.det(basis) != 0.0
