"""Effects that a model may lack: where a new one joins.

Installed packages add theirs by an entry point of the group ``chatter.effects``.
"""

from chatter.description.registry import Registry
from chatter.explain.effects.axis import (
    Asymmetry,
    Cogging,
    CoulombFriction,
    Offset,
    Presliding,
    QuadraticDrag,
    Stribeck,
    WarmUp,
)
from chatter.explain.effects.backlash import Backlash
from chatter.explain.effects.cutting_force import ChipExponent, EdgeForce, ProcessDamping
from chatter.explain.effects.dynamometer import Dynamometer
from chatter.explain.effects.effect import Effect
from chatter.explain.effects.machine import (
    ControlDelay,
    ControlGain,
    DeclaredFriction,
    JointStiffness,
)
from chatter.explain.effects.machine_friction import AxisFriction
from chatter.explain.effects.missing_mode import MissingMode
from chatter.explain.effects.structure import Contact, ModeShift, SlideFriction
from chatter.explain.effects.tool import Pitch, Runout, Wear
from chatter.explain.measurement import Measurement

#: in the order in which equals are named
EFFECTS: Registry[Effect] = Registry(
    group="chatter.effects",
    what="effect",
    built_in=(
        Runout(),
        EdgeForce(),
        ProcessDamping(),
        ChipExponent(),
        MissingMode(),
        ModeShift(),
        Pitch(),
        Wear(),
        Contact(),
        Dynamometer(),
        SlideFriction(),
        CoulombFriction(lower=0.0),
        Stribeck(),
        Presliding(),
        Asymmetry(),
        Offset(),
        QuadraticDrag(lower=0.0),
        Cogging(),
        Backlash(),
        WarmUp(),
        AxisFriction(),
        DeclaredFriction(),
        JointStiffness(),
        ControlGain(),
        ControlDelay(),
    ),
)


def candidates(measurement: Measurement) -> list[Effect]:
    """Effects, each in all its variants, that may be missing in a measurement."""
    return [
        variant
        for effect in EFFECTS
        for variant in effect.variants
        if _shows(variant, measurement) and variant.applies(measurement.of_kinds(variant.kinds))
    ]


def other_variants(effect: Effect, measurement: Measurement) -> list[Effect]:
    """Variants of an effect, but for itself, that may be missing in a measurement."""
    return [
        one
        for one in candidates(measurement)
        if one.name == effect.name and not _is_same_form(one, effect)
    ]


def richer_forms(effect: Effect, measurement: Measurement) -> list[Effect]:
    """Forms of an effect with more parameters that may be missing in a measurement."""
    return [
        one
        for one in effect.richer
        if type(one) is not type(effect) and one.applies(measurement.of_kinds(one.kinds))
    ]


def _is_same_form(one: Effect, other: Effect) -> bool:
    """Whether two effects are the same member of a family."""
    return type(one) is type(other) and vars(one) == vars(other)


def _shows(effect: Effect, measurement: Measurement) -> bool:
    """Whether an effect shows in a measurement of any of its kinds."""
    return any(kind in effect.kinds for kind in measurement.kinds)


def rank(effect: Effect) -> int:
    """Place of an effect in the list; what is not in it comes last."""
    names = EFFECTS.names()
    return names.index(effect.name) if effect.name in names else len(names)
