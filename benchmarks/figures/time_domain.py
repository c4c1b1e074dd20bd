"""Cost of a step of the time domain."""

import io
from contextlib import redirect_stdout
from functools import partial

from benchmarks.coupled import measured
from benchmarks.figures.figure import Figure, Reached
from benchmarks.one_core import floating_point_peak, timed
from benchmarks.time_domain import counted_operations, delayed_case, engaged_share
from chatter.simulation.setup import set_up
from chatter.simulation.simulate import run_setup

_NS = 1e9


def _delayed(law: str) -> Reached:
    """Of a tooth, slice and step in the slot, the costliest of `benchmarks.time_domain`."""
    case = delayed_case("slot", 1.0, law)
    setup = set_up(case)
    number = setup.resolution.steps * setup.slices.angle.size
    each = timed(lambda: run_setup(set_up(case))).shortest * _NS / number
    bound = counted_operations(law) / floating_point_peak() * _NS * engaged_share(setup)
    return Reached(each, f"operations at the peak: {bound:.2g} ns, {100 * bound / each:.0f} %")


def _machine() -> Reached:
    with redirect_stdout(io.StringIO()):
        found = measured("delay")
    return Reached(found["times real time"], f"median of the runs {found['median']:.1f}")


FIGURES = (
    Figure("chip linear", "tooth, slice and step, linear law, slot", 8.0, "ns",
           partial(_delayed, "linear")),
    Figure("chip exponential", "the same, exponential law", 15.0, "ns",
           partial(_delayed, "exponential")),
    Figure("machine", "face mill on its machine, delayed chip", 15.0, "x real time", _machine,
           more_is_better=True),
)  # fmt: skip
