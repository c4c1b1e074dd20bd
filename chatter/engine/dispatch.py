"""Law groups: what acts at the tool point, dispatched by the type of its table.

Every group answers two calls: `act` adds its force at the predicted motion, `settle` takes the
corrected motion into its memory. A law joins by its table and kernels in `cutting` or `dynamics`
and one entry in each of the two lists; a law that is absent from a case costs nothing.
"""

from __future__ import annotations

from numba import types
from numba.extending import overload

from cutting.chip.delayed_chip import DelayedCut, delayed_commit, delayed_forces
from cutting.chip.discrete_chip import DiscreteCut, discrete_commit, discrete_forces
from cutting.compiled import INLINED
from cutting.process_damping.contact import ToolContact, contact_commit, contact_forces

#: table -> kernel that adds its force
ACTING = {
    DelayedCut: delayed_forces,
    DiscreteCut: discrete_forces,
    ToolContact: contact_forces,
}
#: table -> kernel that takes in the motion of the step
SETTLING = {
    DelayedCut: delayed_commit,
    DiscreteCut: discrete_commit,
    ToolContact: contact_commit,
}


def _kernel(kernels, group):
    return kernels.get(group.instance_class) if isinstance(group, types.BaseNamedTuple) else None


def act(group, turn, point):
    """Add the force of a group at the predicted motion."""
    ACTING[type(group)](group, turn, point)


@overload(act, jit_options=INLINED)
def _act(group, turn, point):  # noqa: ARG001
    return _kernel(ACTING, group)


def settle(group, turn, point):
    """Take the corrected motion into the memory of a group."""
    SETTLING[type(group)](group, turn, point)


@overload(settle, jit_options=INLINED)
def _settle(group, turn, point):  # noqa: ARG001
    return _kernel(SETTLING, group)


def all_act(groups, turn, point):
    """Let every group act, in their order."""
    for group in groups:
        act(group, turn, point)


@overload(all_act, jit_options=INLINED)
def _all_act(groups, turn, point):  # noqa: ARG001
    if len(groups) == 1:

        def last(groups, turn, point):
            act(groups[0], turn, point)

        return last

    def rest(groups, turn, point):
        act(groups[0], turn, point)
        all_act(groups[1:], turn, point)

    return rest


def all_settle(groups, turn, point):
    """Let every group settle, in their order."""
    for group in groups:
        settle(group, turn, point)


@overload(all_settle, jit_options=INLINED)
def _all_settle(groups, turn, point):  # noqa: ARG001
    if len(groups) == 1:

        def last(groups, turn, point):
            settle(groups[0], turn, point)

        return last

    def rest(groups, turn, point):
        settle(groups[0], turn, point)
        all_settle(groups[1:], turn, point)

    return rest
