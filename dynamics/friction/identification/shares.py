"""Friction referred through a transmission, and split between its two sides."""

import math
from dataclasses import replace

from dynamics.friction.law import FrictionLaw
from dynamics.friction.laws import BY_SPEC

#: powers of force and of motion of a parameter, by its dimension
_POWERS = {
    "force": (1, 0),
    "stiffness": (1, -1),
    "damping": (1, -1),
    "inverse_length": (0, -1),
    "inverse_velocity": (0, -1),
    "velocity": (0, 1),
    "number": (0, 0),
}


def share_of(law: FrictionLaw, share: float) -> FrictionLaw:
    """Return the law with a share of its force at every motion.

    Above 0, up to 1.
    """
    if not 0.0 < share <= 1.0:
        raise ValueError(f"friction: a share must be above 0 and at most 1, not {share}")
    return _scaled(law, share, 1.0)


def referred_to_slide(law: FrictionLaw, lead: float) -> FrictionLaw:
    """Law along the slide, N, m, that is felt about the shaft, N m, rad, as the given one.

    Of the same kind. Torque = lead x force, motion = lead x angle, with the lead the motion of the
    slide for a turn of the shaft, m/rad (pitch / 2 pi); above 0.
    """
    if not 0.0 < lead < math.inf:
        raise ValueError(f"friction: lead must be above 0 m/rad, not {lead}")
    return _scaled(law, 1.0 / lead, lead)


def split_about_shaft(
    law: FrictionLaw, lead: float, rotational_share: float = 0.5
) -> tuple[FrictionLaw, FrictionLaw]:
    """Split friction found about the motor shaft into a rotational and a translational law.

    The law found and the rotational one are about the shaft, N m, rad, the translational one along
    the slide, N, m. The lead is the motion of the slide for a turn of the shaft, m/rad; above 0.
    The share of the torque from screw and bearings, between 0 and 1, the motor's torque alone
    cannot tell; an equal share is the assumption of the source: "Time domain coupled simulation of
    machine tool dynamics and cutting forces considering the influences of nonlinear friction
    characteristics and process damping", section 3.
    """
    if not 0.0 < rotational_share < 1.0:
        raise ValueError(
            f"friction: the rotational share must be between 0 and 1, not {rotational_share}"
        )
    slide = referred_to_slide(share_of(law, 1.0 - rotational_share), lead)
    return share_of(law, rotational_share), slide


def _scaled(law: FrictionLaw, force: float, motion: float) -> FrictionLaw:
    changed = {}
    for key in BY_SPEC[type(law)].keys:
        if hasattr(law, key.name):
            of_force, of_motion = _POWERS[key.dimension]
            changed[key.name] = getattr(law, key.name) * force**of_force * motion**of_motion
    return replace(law, **changed)
