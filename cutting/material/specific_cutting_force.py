"""Rows of the exponential law: specific cutting forces kc1.1 and mc by group of VDI 3323.

Kienzle, O., 1952, VDI-Z 94:299: Fc = kc1.1 b h^(1 - mc), h and b in mm; as a force law Ktc = kc1.1
at h0 = 1 mm with the exponent 1 - mc. A catalogue gives the cutting force alone.
"""

import math

from cutting.material.row import MaterialRow

#: direction of the force on the edge, from the radius: that of the row "steel (Cornelius)"
FORCE_ANGLE = math.radians(68.0)
RADIAL_RATIO = 1.0 / math.tan(FORCE_ANGLE)
ASSUMPTION = (
    f"the catalogue gives the tangential force alone; radial force {RADIAL_RATIO:.3f} of it is an "
    "assumption (force angle of 68 degrees, Cornelius et al., steel), axial force 0; the tests of "
    "this table have 0.16 to 0.60"
)
_VALIDITY = "power of milling, turning and boring with carbide inserts; rake and wear not given"
_2022 = (
    "ISCAR, Boring Systems 2022, user guide p. 111, material groups of ISO 513 and VDI 3323; "
    "Kc = Kc1 h^-mc as in Milling Inserts 2022, p. 230"
)
_2017 = "ISCAR, Turning Tools 2017, p. 558, material groups of ISO 513 and VDI 3323"

_NON_ALLOY = "non-alloy and cast steel"
_LOW_ALLOY = "low-alloy and cast steel"
_HIGH_ALLOY = "high-alloyed and tool steel"

#: group, ISO letter, name, condition, kc1.1 in MPa, mc, grades that tables of VDI 3323 name or that
#: their analysis puts there: low-alloy steels have no element of 5 % and more (EN 10027-1), and the
#: condition is that of delivery (annealed; mould steel P20 at 300 HB)
_GROUPS: tuple[tuple[int, str, str, str, float, float, tuple[str, ...]], ...] = (
    (1, "P", f"{_NON_ALLOY}, below 0.25 % C", "annealed, 420 MPa, 125 HB", 1350, 0.21,
     ("structural steel", "mild steel", "AISI 1015", "AISI 1018", "AISI 1020", "C15 1.0401",
      "S275", "AISI 1213", "AISI 12L14")),
    (2, "P", f"{_NON_ALLOY}, 0.25 to 0.55 % C", "annealed, 650 MPa, 190 HB", 1500, 0.22,
     ("AISI 1045", "AISI 1035", "AISI 1050", "C45 1.0503", "Ck45 1.1191")),
    (3, "P", f"{_NON_ALLOY}, 0.25 to 0.55 % C, hardened",
     "quenched and tempered, 850 MPa, 250 HB", 1675, 0.24,
     ("AISI 1045", "AISI 1035", "AISI 1050", "C45 1.0503", "Ck45 1.1191")),
    (4, "P", f"{_NON_ALLOY}, above 0.55 % C", "annealed, 750 MPa, 220 HB", 1700, 0.24,
     ("AISI 1055", "AISI 1060")),
    (5, "P", f"{_NON_ALLOY}, above 0.55 % C, hardened",
     "quenched and tempered, 1000 MPa, 300 HB", 1900, 0.24, ("AISI 1055", "AISI 1060")),
    (6, "P", _LOW_ALLOY, "annealed, 600 MPa, 200 HB", 1775, 0.24,
     ("AISI 5115", "AISI 5120", "AISI 5140", "AISI 6150", "AISI 52100", "AISI O1", "AISI L6")),
    (7, "P", f"{_LOW_ALLOY}, hardened to 275 HB", "quenched and tempered, 930 MPa, 275 HB",
     1675, 0.24, ("AISI 4130", "AISI 4140", "AISI 4340", "AISI 8620", "42CrMo4")),
    (8, "P", f"{_LOW_ALLOY}, hardened to 300 HB", "quenched and tempered, 1000 MPa, 300 HB",
     1725, 0.24, ("AISI 4130", "AISI 4140", "AISI 4340", "AISI 8620", "42CrMo4", "AISI P20",
     "P20+Ni")),
    (9, "P", f"{_LOW_ALLOY}, hardened to 350 HB", "quenched and tempered, 1200 MPa, 350 HB",
     1800, 0.24, ("AISI 4130", "AISI 4140", "AISI 4340", "42CrMo4")),
    (10, "P", f"{_HIGH_ALLOY}, annealed", "annealed, 680 MPa, 200 HB", 2450, 0.23,
     ("AISI M2", "AISI T1", "AISI H11", "AISI H13", "AISI A2", "AISI D2", "AISI D3")),
    (11, "P", f"{_HIGH_ALLOY}, hardened", "quenched and tempered, 1100 MPa, 325 HB", 2500, 0.23,
     ("AISI M2", "AISI T1", "AISI H11", "AISI H13", "AISI A2", "AISI D2", "AISI D3")),
    (12, "P", "stainless steel, ferritic and martensitic", "680 MPa, 200 HB", 1875, 0.21,
     ("AISI 403", "AISI 405", "AISI 410", "AISI 416", "AISI 430")),
    (13, "P", "stainless steel, martensitic", "820 MPa, 240 HB", 1875, 0.21,
     ("AISI 420", "AISI 431", "AISI 440 C", "X40Cr14", "X38CrMo16", "17-4PH")),
    (14, "M", "stainless steel, austenitic and duplex", "600 MPa, 180 HB", 2150, 0.20,
     ("AISI 304", "AISI 304 L", "AISI 316", "AISI 316 L", "AISI 317", "AISI 303", "AISI 316 Ti",
      "AISI 321", "duplex 2205")),
    (15, "K", "grey cast iron, ferritic and pearlitic", "180 HB", 1150, 0.20,
     ("Class 20 B", "Class 25 B")),
    (16, "K", "grey cast iron, pearlitic and martensitic", "260 HB", 1350, 0.28,
     ("Class 30 B", "Class 40 B", "Class 45 B", "Class 50 B")),
    (17, "K", "nodular cast iron, ferritic", "160 HB", 1225, 0.25,
     ("Grade 60-40-18", "Grade 65-45-12", "EN-GJS-500-7", "GGG")),
    (18, "K", "nodular cast iron, pearlitic", "250 HB", 1350, 0.28,
     ("Grade 80-55-06", "Grade 100-70-03", "Grade 120-90-02", "EN-GJS-500-7", "GGG")),
    (19, "K", "malleable cast iron, ferritic", "130 HB", 1225, 0.25,
     ("Grade 22010", "Grade 32510")),
    (20, "K", "malleable cast iron, pearlitic", "230 HB", 1420, 0.30,
     ("GTW-35-04", "GTS-55-04", "GTS-65-02")),
    (21, "N", "wrought aluminium alloy, not hardenable", "60 HB", 700, 0.25,
     ("AlMg 1", "AlMg 3", "AlMg4.5Mn")),
    (22, "N", "wrought aluminium alloy, hardened", "100 HB", 800, 0.25,
     ("AlCuMg 1", "AlMgSi 1", "6061", "7075", "2014-T6", "2024-T4")),
    (23, "N", "cast aluminium alloy, up to 12 % Si, not hardenable", "75 HB", 700, 0.25,
     ("G-AlSi 12",)),
    (24, "N", "cast aluminium alloy, up to 12 % Si, hardened", "90 HB", 700, 0.25,
     ("G-AlSi 10 Mg", "G-AlSi 7 Mg")),
    (25, "N", "cast aluminium alloy, above 12 % Si", "130 HB", 750, 0.25,
     ("high silicon", "AlSi17Cu4Mg")),
    (26, "N", "copper alloy, free cutting, above 1 % Pb", "110 HB", 700, 0.27, ("CuZn39Pb3",)),
    (27, "N", "brass", "90 HB", 700, 0.27, ("copper alloy", "CuZn37")),
    (28, "N", "electrolytic copper", "100 HB", 700, 0.27, ("Cu-ETP",)),
    (31, "S", "iron-based heat-resistant alloy, annealed", "200 HB", 2600, 0.24,
     ("Incoloy 800",)),
    (32, "S", "iron-based heat-resistant alloy, hardened", "280 HB", 3100, 0.24, ("A286",)),
    (33, "S", "nickel or cobalt alloy, annealed", "250 HB", 3300, 0.24,
     ("Inconel", "Inconel 600", "Inconel 625", "Hastelloy C-276")),
    (34, "S", "nickel or cobalt alloy, hardened", "350 HB", 3300, 0.24,
     ("Inconel 718", "Nimonic 80A", "Waspaloy")),
    (35, "S", "nickel or cobalt alloy, cast", "320 HB", 3300, 0.24, ()),
    (36, "S", "titanium, pure", "400 MPa", 1160, 0.24, ("Ti Grade 2",)),
    (37, "S", "titanium, alpha and beta alloy, hardened", "1050 MPa", 1245, 0.24,
     ("Ti-6Al-4V", "Ti6Al4V", "TiAl6V4", "Grade 5")),
)  # fmt: skip

#: the same maker five years before: other forces of titanium, and nothing says which holds
_TITANIUM_2017 = (
    (36, "titanium, pure", "400 MPa", 1700, 0.23, ("Ti Grade 2",)),
    (
        37,
        "titanium, alpha and beta alloy, hardened",
        "1050 MPa",
        2110,
        0.22,
        ("Ti-6Al-4V", "Ti6Al4V", "TiAl6V4", "Grade 5"),
    ),
)


def _kienzle(
    group: int,
    iso_group: str,
    condition: str,
    specific: float,
    mc: float,
    examples: tuple[str, ...],
    source: str,
    differs: str,
) -> MaterialRow:
    """Row of Fc = kc1.1 b h^(1 - mc): kc1.1 in MPa at h = 1 mm."""
    tangential = specific * 1e6
    values = {
        "Ktc": tangential,
        "Krc": RADIAL_RATIO * tangential,
        "Kac": 0.0,
        "h0": 1e-3,
        "exponent": round(1.0 - mc, 12),
    }
    return MaterialRow(
        "exponential",
        values,
        source,
        iso_group=iso_group,
        condition=condition,
        examples=(f"group {group}", *examples),
        validity=_VALIDITY + differs,
        assumption=ASSUMPTION,
    )


def _rows() -> dict[str, MaterialRow]:
    rows = {}
    for group, letter, name, condition, specific, mc, examples in _GROUPS:
        differs = "; 2017 edition differs" if name.startswith("titanium") else ""
        row = _kienzle(group, letter, condition, specific, mc, examples, _2022, differs)
        rows[f"{name} (VDI {group})"] = row
    for group, name, condition, specific, mc, examples in _TITANIUM_2017:
        differs = "; 2022 edition differs"
        row = _kienzle(group, "S", condition, specific, mc, examples, _2017, differs)
        rows[f"{name} (VDI {group}, 2017)"] = row
    return rows


ROWS: dict[str, MaterialRow] = _rows()
