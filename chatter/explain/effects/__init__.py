"""Effects that a model may lack, each a patch of the case.

An effect joins by one entry in the list of its kind of measurement.
"""

from chatter.explain.effects.axis import AXIS_EFFECTS
from chatter.explain.effects.milling import MILLING_EFFECTS
from chatter.explain.kinds.kind import Effect
from chatter.explain.measurement import Measurement

#: every effect, in the order in which equals are named
EFFECTS: tuple[Effect, ...] = (*MILLING_EFFECTS, *AXIS_EFFECTS)


def candidates(measurement: Measurement) -> list[Effect]:
    """Effects that may be missing in a measurement."""
    return [
        effect
        for effect in EFFECTS
        if measurement.kind in effect.kinds and effect.applies(measurement)
    ]


def place_of(effect: Effect) -> int:
    """Place of an effect in the list."""
    return EFFECTS.index(effect)
