"""Moves that no machine makes are refused, and an axis that stays behind is told."""

import numpy as np
import pytest

import chatter
from chatter import InputError
from chatter.simulation.virtual_tests.from_file import file_move
from chatter.simulation.virtual_tests.move import MoveResult
from tests.places import EXAMPLES


def refused(**values):
    machine = chatter.load_machine(EXAMPLES / "face-mill-chatter" / "machine.toml").patch(
        {path.replace("__", "."): value for path, value in values.items()}
    )
    (name,) = {path.split("__")[1] for path in values}
    with pytest.raises(InputError) as caught:
        file_move(machine, name, machine.move[name])
    return str(caught.value)


def test_a_spindle_has_no_travel():
    """20 mm of a spindle were 5e14 um of the tool."""
    assert "move.speed.axes: axis S turns" in refused(move__speed__axes=["S"])


def test_a_move_without_end():
    """It ended in "unable to allocate 110 TiB"."""
    told = refused(move__circle__revolutions=1e9)
    # 2 pi 0.2 mm at 5 mm/min: 15.08 s each, in steps of 50 us
    assert "1.51e+10 s, 3e+14 steps of 50 us (step); at most 1e+09" in told


def test_a_test_with_more_averages_than_the_memory_holds():
    """It ended in "unable to allocate 1.16 GiB"."""
    machine = chatter.load_machine(EXAMPLES / "machine-coupled-milling" / "machine.toml")
    long = machine.patch({"frf.boring_in_cut.averages": 200})
    with pytest.raises(InputError) as caught:
        chatter.frf(long, ["boring_in_cut"])
    # three values of 8 bytes a place, at 12 million steps of 50 us: 0.288 GB a place
    assert "frf.boring_in_cut: the run of 600.5 s records 12010000 rows of" in str(caught.value)
    assert "at most 1.5 GB are allowed: shorten it, by fewer averages" in str(caught.value)


@pytest.mark.parametrize(
    ("reached", "told"), [(19e-3, []), (1e-3, ["19 mm behind on a way of 20"])]
)
def test_an_axis_that_stays_behind(reached, told):
    time = np.linspace(0.0, 1.0, 11)
    wanted, there = 20e-3 * time[:, None], reached * time[:, None]
    effort = np.full((11, 1), -25.0)
    result = MoveResult(
        "m", ("Y",), time, wanted, there, there, there, None, effort, None, {}, False, ("N*m",)
    )
    sentences = result.left_behind()
    assert len(sentences) == len(told)
    assert all(words in text for words, text in zip(told, sentences, strict=True))
    assert all(text.startswith("axis Y does not follow") for text in sentences)
    assert all("at most 25 N m" in text for text in sentences)
