"""First use: what the second process compiles is what cases call."""

import numba
import numpy as np
import pytest

from chatter.description.case import load
from chatter.stability.methods.collocation import first_use
from chatter.stability.methods.collocation.coupling_assembly import coupling_assemblies
from chatter.stability.methods.collocation.element_assembly import operator_arrays
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.model import milling_model
from tests.places import EXAMPLES


@pytest.mark.parametrize("name", ["two-degrees-of-freedom", "helix-islands", "two-insert-cutter"])
def test_second_process_compiles_for_the_types_of_a_case(name):
    case = load(EXAMPLES / name / "case.toml")
    cut = element_cut(milling_model(case), case.cut.axial_depth)
    speed, depth = np.array([case.cut.spindle_speed]), np.array([case.cut.axial_depth])
    plans = coupling_assemblies(cut, speed, depth)
    called = operator_arrays(cut), plans, speed, np.zeros(1, dtype=np.bool_)
    compiled = first_use.arguments_of_operator()
    assert [numba.typeof(a) for a in compiled] == [numba.typeof(a) for a in called]


def test_second_process_succeeds():
    assert first_use._start().wait() == 0
