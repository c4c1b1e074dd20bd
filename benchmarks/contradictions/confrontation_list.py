"""All confrontations, one line each."""

from benchmarks.contradictions.confrontation import Confrontation
from benchmarks.contradictions.confrontations.carved_chips import CARVED_CHIPS
from benchmarks.contradictions.confrontations.energy import ENERGY
from benchmarks.contradictions.confrontations.forced_vibration import FORCED_VIBRATION
from benchmarks.contradictions.confrontations.growth import CONTACT, PLOUGHING
from benchmarks.contradictions.confrontations.limits import LIMITS, VERDICTS
from benchmarks.contradictions.confrontations.machine_responses import MACHINE_RESPONSES
from benchmarks.contradictions.confrontations.multipliers import MULTIPLIERS
from benchmarks.contradictions.confrontations.removed_volume import REMOVED_VOLUME
from benchmarks.contradictions.confrontations.resolution import RESOLUTION
from benchmarks.contradictions.confrontations.restated import RESTATED
from benchmarks.contradictions.confrontations.rigid_forces import RIGID_FORCES
from benchmarks.contradictions.confrontations.rotated import ROTATED

CONFRONTATIONS: tuple[Confrontation, ...] = (
    RIGID_FORCES,
    FORCED_VIBRATION,
    ENERGY,
    MULTIPLIERS,
    ROTATED,
    RESTATED,
    LIMITS,
    VERDICTS,
    CARVED_CHIPS,
    REMOVED_VOLUME,
    RESOLUTION,
    PLOUGHING,
    CONTACT,
    MACHINE_RESPONSES,
)


def by_name(name: str) -> Confrontation:
    """Confrontation of a name; KeyError where there is none."""
    return {one.name: one for one in CONFRONTATIONS}[name]
