"""Steps drawn from a fit for the models that are left possible."""

import numpy as np

from chatter.explain.next_measurement import alternatives


def test_parameter_without_variance_stays_and_the_others_keep_their_correlation(monkeypatch):
    monkeypatch.setattr(alternatives, "_DRAWS", 4000)
    spread = np.array([2.0, 0.0, 3.0])
    # the pseudo-inverse leaves crumbs beside a variance of zero
    covariance = np.array([[4.0, 1e-20, -4.8], [1e-20, 0.0, 1e-20], [-4.8, 1e-20, 9.0]])
    steps = alternatives._standard_steps(covariance, spread, spread > 1e-9)
    assert np.all(steps[:, 1] == 0.0)
    assert np.allclose(steps.std(axis=0)[[0, 2]], 1.0, atol=0.05)
    assert abs(np.corrcoef(steps[:, 0], steps[:, 2])[0, 1] + 0.8) < 0.03


def test_fit_that_sees_nothing_stays_where_it_is():
    nothing = np.zeros(2)
    steps = alternatives._standard_steps(np.zeros((2, 2)), nothing, nothing > 0.0)
    assert np.array_equal(steps, np.zeros((4, 2)))
