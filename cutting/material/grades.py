"""Designations of one grade in several standards, so that a search takes the one on the drawing.

Steels: numbers of EN 10027-2 and names of EN 10025, 10083, 10084, 10088 and ISO 4957 beside AISI;
nodular iron: EN 1563 and DIN 1693 beside ASTM A536; aluminium: EN 573-3 and DIN 17007 beside the
Aluminum Association; nickel and titanium: DIN 17007 and UNS. Standards differ in the limits of
their analyses, so that designations of a line are the nearest to each other, not one alloy.
"""

_STEEL = (
    ("structural steel", "S235", "S235JR", "St37-2", "1.0038"),
    ("mild steel", "S355", "S355J2", "St52-3", "1.0577"),
    ("AISI 1015", "C15", "C15E", "1.0401", "1.1141"),
    ("AISI 1020", "C22", "C22E", "1.0402", "1.1151"),
    ("AISI 1035", "C35", "C35E", "1.0501", "1.1181"),
    ("AISI 1045", "C45", "C45E", "Ck45", "1.0503", "1.1191"),
    ("AISI 1050", "C50", "C50E", "1.0540", "1.1206"),
    ("AISI 1055", "C55", "C55E", "1.0535", "1.1203"),
    ("AISI 1060", "C60", "C60E", "1.0601", "1.1221"),
    ("AISI 4130", "25CrMo4", "1.7218"),
    ("AISI 4140", "42CrMo4", "1.7225"),
    ("AISI 4340", "34CrNiMo6", "1.6582"),
    ("AISI 8620", "21NiCrMo2", "20NiCrMo2-2", "1.6523"),
    ("AISI M2", "HS6-5-2", "1.3343"),
    ("AISI T1", "HS18-0-1", "1.3355"),
)
_STAINLESS_STEEL = (
    ("AISI 403", "X6Cr13", "1.4000"),
    ("AISI 405", "X6CrAl13", "1.4002"),
    ("AISI 410", "X12Cr13", "1.4006"),
    ("AISI 416", "X12CrS13", "1.4005"),
    ("AISI 430", "X6Cr17", "1.4016"),
    ("AISI 420", "X20Cr13", "1.4021"),
    ("AISI 431", "X17CrNi16-2", "1.4057"),
    ("AISI 440 C", "X105CrMo17", "1.4125"),
    ("AISI 304", "X5CrNi18-10", "1.4301"),
    ("AISI 304 L", "X2CrNi19-11", "X2CrNi18-9", "1.4306", "1.4307"),
    ("AISI 316", "X5CrNiMo17-12-2", "1.4401"),
    ("AISI 316 L", "X2CrNiMo17-12-2", "X2CrNiMo18-14-3", "1.4404", "1.4435"),
    ("AISI 317", "X3CrNiMo18-12-3", "1.4449"),
)
_CAST_IRON = (
    ("Grade 60-40-18", "EN-GJS-400-18", "GJS-400-18", "GGG40", "GGG-40"),
    ("Grade 65-45-12", "EN-GJS-450-10", "GJS-450-10"),
    ("Grade 80-55-06", "EN-GJS-600-3", "GJS-600-3", "GGG60", "GGG-60"),
    ("Grade 100-70-03", "EN-GJS-700-2", "GJS-700-2", "GGG70", "GGG-70"),
    ("GTW-35-04", "EN-GJMW-350-4"),
    ("GTS-55-04", "EN-GJMB-550-4"),
    ("GTS-65-02", "EN-GJMB-650-2"),
)
_LIGHT_METAL = (
    ("AlMg 1", "EN AW-5005", "AW-5005", "5005"),
    ("AlCuMg 1", "EN AW-2017A", "AW-2017A", "2017A", "3.1325"),
    ("AlMgSi 1", "EN AW-6082", "AW-6082", "6082", "3.2315"),
    ("6061", "EN AW-6061", "AW-6061", "AlMg1SiCu", "3.3211"),
    ("7075", "EN AW-7075", "AW-7075", "AlZnMgCu1.5", "AlZn5.5MgCu", "3.4365"),
    ("2014-T6", "EN AW-2014", "AW-2014", "2014", "AlCuSiMn", "3.1255"),
    ("2024-T4", "EN AW-2024", "AW-2024", "2024", "AlCuMg2", "AlCu4Mg1", "3.1355"),
    ("G-AlSi 10 Mg", "AlSi10Mg", "EN AC-43000", "AC-43000", "3.2381"),
    ("Ti-6Al-4V", "Ti6Al4V", "TiAl6V4", "Grade 5", "3.7165", "R56400"),
)
_NICKEL = (
    ("Inconel 718", "IN718", "Alloy 718", "NiCr19NbMo", "NiCr19Fe19Nb5Mo3", "2.4668", "N07718"),
)

#: lines of designations of one grade
EQUIVALENT_GRADES = (*_STEEL, *_STAINLESS_STEEL, *_CAST_IRON, *_LIGHT_METAL, *_NICKEL)


def bare(grade: str) -> str:
    """Letters and digits of a grade: catalogues write them with spaces, dots and dashes."""
    return "".join(letter for letter in grade.lower() if letter.isalnum()).removeprefix("aisi")


def designations(grade: str) -> frozenset[str]:
    """Return a grade and all that other standards call it, `bare`."""
    wanted = bare(grade)
    found = {wanted}
    for line in EQUIVALENT_GRADES:
        names = {bare(name) for name in line}
        if wanted in names:
            found |= names
    return frozenset(found)
