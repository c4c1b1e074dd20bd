"""Linear law whose coefficients follow from orthogonal cutting data and the helix of the edge."""

from __future__ import annotations

import math

from cutting.force.law import EDGE_KEYS, ForceLawEntry
from cutting.force.linear import LinearLaw, LinearTable
from cutting.keys import Key
from cutting.material.oblique import oblique_cutting_coefficients

_RIGHT_ANGLE = 0.5 * math.pi

ORTHOGONAL_KEYS = (
    Key("shear_stress", "pressure", "shear yield stress", needed=True, above=0.0),
    Key(
        "friction_angle",
        "angle",
        "mean, on the rake",
        needed=True,
        at_least=0.0,
        below=_RIGHT_ANGLE,
    ),
    Key("shear_angle", "angle", "orthogonal", needed=True, above=0.0, below=_RIGHT_ANGLE),
    Key("rake_angle", "angle", "normal", needed=True, above=-_RIGHT_ANGLE, below=_RIGHT_ANGLE),
)


def _of_keys(
    inclination: float,
    shear_stress: float,
    friction_angle: float,
    shear_angle: float,
    rake_angle: float,
    **edge: float,
) -> LinearLaw:
    cutting = oblique_cutting_coefficients(
        shear_stress, friction_angle, shear_angle, rake_angle, inclination
    )
    return LinearLaw(cutting, tuple(edge[key.name] for key in EDGE_KEYS))


OBLIQUE = ForceLawEntry(
    name="oblique",
    label="oblique transformation",
    help="linear law, Kc from orthogonal cutting data (Budak, Altintas and Armarego 1996)",
    keys=(*ORTHOGONAL_KEYS, *EDGE_KEYS),
    spec=LinearLaw,
    table=LinearTable,
    make=_of_keys,
)
