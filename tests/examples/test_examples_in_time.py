"""The shipped examples of the time domain: one number each that geometry or theory gives."""

import numpy as np
import pytest

import chatter
from chatter.io.shipped_examples import example


def load(name):
    return chatter.load(example(name).folder / "case.toml")


def test_stepped_stock():
    result = chatter.simulate(load("stepped-stock").patch({"simulation.revolutions": 95}))
    place = result.setup.path.position_at(result.time)[0]
    # a radius of 6 mm in front of the block, whose side is at x = 8 mm
    assert np.all(result.force[place < 1.99e-3] == 0.0)
    # on the step about twice the depth is cut at the same engagement, in whole layers
    height = result.setup.slices.height
    base, step = (
        result.torque[(place > low) & (place < high)].mean()
        for low, high in ((9.0e-3, 12.0e-3), (22.5e-3, 25.5e-3))
    )
    deeper = len(height) / np.sum(height < 2e-3)
    assert deeper == pytest.approx(2.0, rel=0.03)
    assert step / base == pytest.approx(deeper, rel=0.01)


def test_chattering_cut():
    case = load("chattering-cut")
    limit = chatter.check(case.patch({"tool.runout": None})).critical_depth
    shallow, deep = (
        chatter.simulate(case.patch({"cut.axial_depth": f"{depth * 1e3} mm"})).detection
        for depth in (0.75 * limit, 1.4 * limit)
    )
    assert shallow.stable
    assert not deep.stable
    # runout raises the limit by a few per cent: the frequency is that without it
    beyond = {"tool.runout": None, "cut.axial_depth": f"{1.02e3 * limit} mm"}
    lines = chatter.check(case.patch(beyond))
    assert deep.chatter_frequency == pytest.approx(lines.chatter_frequency, rel=0.02)
