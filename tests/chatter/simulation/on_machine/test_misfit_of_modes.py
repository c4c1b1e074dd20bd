"""What the fit of real modes to a machine makes of its limit is said with the limit."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from chatter.compile.structure import GivenModes
from chatter.stability.misfit_of_modes import neglected_misfit_of_modes
from chatter.stability.model import milling_model
from chatter.stability.registry import METHODS
from dynamics.modal.modes import Mode
from tests.chatter.simulation.on_machine.coupled_machines import cut_case, written
from tests.chatter.simulation.on_machine.test_programs_on_machine import two_axes

MODES = (Mode(180.0, 0.05, 40.0, (0.0, 1.0, 0.0)), Mode(240.0, 0.05, 60.0, (1.0, 0.0, 0.0)))


@dataclass(frozen=True)
class MissedBy:
    """Structure whose modes have all of its receptance but for a factor."""

    factor: float
    modes: tuple[Mode, ...] = MODES

    @property
    def directions(self):
        return np.eye(3)

    def receptance(self):
        lines, values = GivenModes(self.modes).receptance()
        return lines, values / self.factor


@pytest.fixture
def model(tmp_path):
    structure = {"machine": str(written(tmp_path, two_axes())), "feed": [1.0, 0.0, 0.0]}
    return milling_model(cut_case(structure))


def effect(model, factor, method="collocation"):
    chosen = next(one for one in METHODS if one.name == method)
    return neglected_misfit_of_modes(replace(model, structure=MissedBy(factor)), chosen)


def test_a_receptance_that_is_half_bears_twice_the_depth(model):
    """Zeroth-order limits go by the inverse of the receptance."""
    for factor, lowest, highest in ((1.25, 1.0, 1.25), (0.8, 0.8, 1.0)):
        (found,) = effect(model, factor)
        assert found.lowest == pytest.approx(lowest, rel=1e-9)
        assert found.highest == pytest.approx(highest, rel=1e-9)
        assert "the receptance of the machine itself" in found.note


def test_modes_that_fit_are_not_spoken_of(model):
    assert effect(model, 1.0) == ()
    assert effect(model, 1.02) == ()


def test_methods_that_take_the_receptance_miss_nothing(model):
    assert effect(model, 1.25, "zero-order") == ()
    assert effect(model, 1.25, "time-domain") == ()
