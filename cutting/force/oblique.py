"""Linear law whose coefficients follow from orthogonal cutting data and the helix of the edge."""

import math

from cutting.force.law import EDGE_KEYS, ForceLawEntry
from cutting.force.linear import LinearLaw, LinearTable
from cutting.keys import Key

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


def oblique_cutting_coefficients(
    shear_stress: float,
    friction_angle: float,
    shear_angle: float,
    normal_rake: float,
    inclination: float,
) -> tuple[float, float, float]:
    """Cutting coefficients of an oblique edge from orthogonal cutting data.

    Parameters
    ----------
    shear_stress : float
        Shear yield stress, Pa.
    friction_angle, shear_angle : float
        Mean friction angle beta_a and (orthogonal) shear angle phi_c, rad.
    normal_rake, inclination : float
        Normal rake and inclination (helix) angle, rad.

    Returns
    -------
    (3,) tuple of float
        K_tc, K_rc, K_ac, N/m^2.

    Notes
    -----
    Budak, Altintas, Armarego 1996, eqs. 10 to 12, with Stabler's rule (chip flow angle equals
    the inclination) and the orthogonal shear angle taken as the normal shear angle.
    """
    i = inclination
    chip_flow = i
    normal_friction = math.atan(math.tan(friction_angle) * math.cos(chip_flow))
    lean = normal_friction - normal_rake
    denominator = math.sqrt(
        math.cos(shear_angle + lean) ** 2
        + math.tan(chip_flow) ** 2 * math.sin(normal_friction) ** 2
    )
    scale = shear_stress / math.sin(shear_angle) / denominator
    skew = math.tan(chip_flow) * math.sin(normal_friction)
    return (
        scale * (math.cos(lean) + math.tan(i) * skew),
        scale * math.sin(lean) / math.cos(i),
        scale * (math.cos(lean) * math.tan(i) - skew),
    )
