"""Natural modes of a case, to which residuals are related."""

from collections.abc import Sequence

from chatter.compile.machine_cut import machine_cut
from chatter.compile.structure import structure_of
from chatter.description.case import Case
from dynamics.modal.modes import Mode


def natural_modes(case: Case) -> Sequence[Mode]:
    """Modes at the tool point; none of a rigid tool, of a machine those with its loops open."""
    if case.structure is None:
        return ()
    return machine_cut(case).modes() if case.on_machine else structure_of(case).modes
