"""A contact of the machine file and a cut whose case has none."""

import pytest

from chatter.compile.structure import structure_of
from chatter.simulation.setup import set_up
from tests.chatter.simulation.on_machine.coupled_machines import cut_case, written
from tests.chatter.simulation.on_machine.test_balance_of_forces import machine

CONTACT = {"stiffness": 2.5e6, "damping": 3e3}


@pytest.mark.parametrize(
    ("of_machine", "of_case", "told"),
    [(CONTACT, None, True), (CONTACT, CONTACT, False), (None, None, False)],
)
def test_a_cut_says_that_the_contact_of_the_machine_is_not_in_it(
    tmp_path, of_machine, of_case, told
):
    whole = machine() | ({"contact": of_machine} if of_machine else {})
    path = written(tmp_path, whole)
    case = cut_case({"machine": str(path)})
    if of_case:
        case = case.patch({f"contact.{key}": value for key, value in of_case.items()})
    words = "acts in FRFs in the cut; this cut has none"
    assert any(words in note for note in set_up(case).notes) == told
    assert any(words in note for note in structure_of(case).notes) == told
