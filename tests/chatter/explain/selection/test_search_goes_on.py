"""A search that was ended in its middle takes the same way again and ends with the same numbers."""

import errno

import numpy as np
import pytest

from chatter import RunError
from chatter.explain.prediction import Predictions, kept_predictions
from chatter.explain.selection.search import search
from tests.chatter.explain.selection.test_search import (
    Sums,
    measured,
    three_effects,  # noqa: F401  # the effects that are looked for
    unlike_shapes,
)


class Counted(Sums):
    """Sums that end the search after so many predictions."""

    def __init__(self, most=10**9):
        self.count, self.most = 0, most

    def predict(self, case, run):
        if self.count == self.most:
            raise KeyboardInterrupt
        self.count += 1
        return super().predict(case, run)


def searched(measurement, kind, folder):
    """Search with predictions kept in a folder, and its last fit."""
    predictions = Predictions(kind, kept_predictions(folder, "test", measurement))
    with predictions.kept.going_on():
        return search(measurement, predictions, lambda *_: None).final


def test_a_search_goes_on_where_it_was_ended(tmp_path):
    measurement = measured(unlike_shapes, (1.0, 0.0, 1.0))
    whole = Counted()
    wanted = searched(measurement, whole, None)
    for share in (0.3, 0.8):
        folder = tmp_path / str(share)
        ended = Counted(int(share * whole.count))
        with pytest.raises(RunError, match="interrupted"):
            searched(measurement, ended, folder)
        rest = Counted()
        found = searched(measurement, rest, folder)
        assert rest.count == whole.count - ended.count
        np.testing.assert_array_equal(found.values, wanted.values)
        np.testing.assert_array_equal(found.residuals, wanted.residuals)
        np.testing.assert_array_equal(found.covariance, wanted.covariance)


def test_another_tolerance_or_other_signals_begin_anew(tmp_path):
    measurement = measured(unlike_shapes, (1.0, 0.0, 0.0))
    searched(measurement, Counted(), tmp_path)
    others = measured(lambda random: unlike_shapes(random) * 1.01, (1.0, 0.0, 0.0))
    assert kept_predictions(tmp_path, "test", measurement).count > 0
    assert kept_predictions(tmp_path, "test", others).count == 0


def test_a_disk_that_is_full_ends_the_search_and_makes_no_case_impossible(tmp_path, monkeypatch):
    def refuse(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("chatter.studies.kept_arrays._appended", refuse)
    measurement = measured(unlike_shapes, (1.0, 0.0, 0.0))
    with pytest.raises(OSError, match="cannot be kept: No space left on device"):
        searched(measurement, Counted(), tmp_path)
