"""Rows of the linear law: coefficients that were identified in cutting tests."""

from cutting.material.row import CUTTING, EDGE, MaterialRow

_REVIEW = "Chinese Journal of Mechanical Engineering 2021, 10.1186/s10033-021-00536-9, Table 5"
_CARBIDE = "milling with cemented carbide, dry"

Three = tuple[float, float, float]


def _linear(
    cutting: Three, edge: Three, source: str, iso_group: str, validity: str, *examples: str
) -> MaterialRow:
    """Row of the linear law: N/m^2 and N/m; 0 where the source gives none."""
    values = dict(zip((*CUTTING, *EDGE), (*cutting, *edge), strict=True))
    return MaterialRow(
        "linear", values, source, iso_group=iso_group, examples=examples, validity=validity
    )


ROWS: dict[str, MaterialRow] = {
    "Al6061-T6": _linear(
        (243.77e6, 113.5e6, 0.0), (7.53e3, 7.83e3, 0.0), _REVIEW, "N", _CARBIDE, "aluminium 6061"
    ),
    "Al6082-T6": _linear(
        (631e6, 99e6, 273e6), (13e3, 10e3, 2.8e3), _REVIEW, "N", _CARBIDE, "aluminium 6082"
    ),
    "Al7075-T6": _linear(
        (767.01e6, 168.8e6, 222e6),
        (27.7e3, 26.6e3, 0.7e3),
        _REVIEW,
        "N",
        _CARBIDE,
        "aluminium 7075",
    ),
    "Al7075-T6 (second source)": _linear(
        (600.46e6, 180.96e6, 0.0), (17.9e3, 20.42e3, 0.0), _REVIEW, "N", _CARBIDE, "aluminium 7075"
    ),
    "Al7075 HSS": _linear(
        (951.365e6, 262.597e6, 323.33e6),
        (11.115e3, 11.314e3, 1.105e3),
        _REVIEW,
        "N",
        "milling with high-speed steel, dry",
        "aluminium 7075",
    ),
    "Al7075 (Altintas)": _linear(
        (1319.41e6, 788.83e6, 48.75e6),
        (19.65e3, 26.77e3, 2.05e3),
        _REVIEW,
        "N",
        _CARBIDE,
        "aluminium 7075",
    ),
    "steel (80 mm face mill)": _linear(
        (1889.2e6, 806.1e6, 291.0e6),
        (63.12e3, 113.7e3, -3.1e3),
        "Franco et al., shared code of Ideko: 80 mm, two inserts, lead angle 45 degrees",
        "P",
        "face mill of 80 mm with two inserts, cutting edge angle 45 degrees",
    ),
    "aluminium (Altintas, Engin, Budak 1999)": _linear(
        (697e6, 255.8e6, 0.0), (0.0, 0.0, 0.0), "Altintas, Engin, Budak 1999", "N", ""
    ),
    "steel (Cornelius)": _linear(
        # 2160 MPa and 50 N/mm at 68 degrees
        (2002.7171e6, 809.1502e6, 0.0),
        (46.3592e3, 18.7303e3, 0.0),
        "Cornelius et al.: specific force 2160 MPa, force angle 68 degrees, edge force 50 N/mm",
        "P",
        "",
    ),
}
