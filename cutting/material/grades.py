"""Designations of one grade in several standards, so that a search takes the one on the drawing.

Steels: numbers of EN 10027-2 and names of EN 10025, 10083, 10084, 10087, 10088 and ISO 4957 beside
AISI, UNS (ASTM E527) and JIS G4051, G4053, G4303, G4403, G4404; grey and nodular iron: EN 1561,
EN 1563, DIN 1691, DIN 1693 and JIS G5501, G5502 beside ASTM A48 and A536; aluminium: EN 573-3,
EN 1706 and DIN 17007 beside the Aluminum Association; copper: EN 12163 and DIN 17660; nickel and
titanium: DIN 17007 and UNS. Standards differ in the limits of their analyses, so that designations
of a line are the nearest to each other, not one alloy.
"""

import re

_STEEL = (
    ("structural steel", "S235", "S235JR", "St37-2", "1.0038", "SS400"),
    ("S275", "S275JR", "St44-2", "1.0044"),
    ("mild steel", "S355", "S355J2", "S355JR", "St52-3", "1.0577", "1.0045"),
    ("AISI 12L14", "11SMnPb30", "9SMnPb28", "1.0718", "G12144", "SUM24L"),
    ("AISI 1213", "11SMn30", "9SMn28", "1.0715", "G12130", "SUM22"),
    ("AISI 1015", "C15", "C15E", "1.0401", "1.1141", "G10150", "S15C"),
    ("AISI 1020", "C22", "C22E", "1.0402", "1.1151", "G10200", "S20C"),
    ("AISI 1035", "C35", "C35E", "1.0501", "1.1181", "G10350", "S35C"),
    ("AISI 1045", "C45", "C45E", "Ck45", "1.0503", "1.1191", "G10450", "S45C"),
    ("AISI 1050", "C50", "C50E", "1.0540", "1.1206", "G10500", "S50C"),
    ("AISI 1055", "C55", "C55E", "1.0535", "1.1203", "G10550", "S55C"),
    ("AISI 1060", "C60", "C60E", "1.0601", "1.1221", "G10600", "S58C"),
    ("AISI 4130", "25CrMo4", "1.7218", "G41300", "SCM430"),
    ("AISI 4140", "42CrMo4", "1.7225", "G41400", "SCM440"),
    ("AISI 4340", "34CrNiMo6", "1.6582", "G43400", "SNCM439"),
    ("AISI 8620", "21NiCrMo2", "20NiCrMo2-2", "1.6523", "G86200", "SNCM220"),
    ("AISI 5115", "16MnCr5", "1.7131", "G51150"),
    ("AISI 5120", "20MnCr5", "1.7147", "G51200", "SMnC420"),
    ("AISI 5140", "41Cr4", "1.7035", "G51400", "SCr440"),
    ("AISI 6150", "51CrV4", "50CrV4", "1.8159", "G61500", "SUP10"),
    ("AISI 52100", "100Cr6", "1.3505", "G52986", "SUJ2"),
    ("AISI O1", "100MnCrW4", "95MnWCr5", "1.2510", "1.2825", "T31501", "SKS3"),
    ("AISI L6", "55NiCrMoV7", "56NiCrMoV7", "1.2713", "1.2714", "T61206", "SKT4"),
    ("AISI P20", "40CrMnMo7", "35CrMo7", "40CrMnMoS8-6", "1.2311", "1.2312", "T51620"),
    ("P20+Ni", "40CrMnNiMo8-6-4", "1.2738"),
    ("AISI H11", "X38CrMoV5-1", "X37CrMoV5-1", "1.2343", "T20811", "SKD6"),
    ("AISI H13", "X40CrMoV5-1", "1.2344", "T20813", "SKD61"),
    ("AISI A2", "X100CrMoV5", "X100CrMoV5-1", "1.2363", "T30102", "SKD12"),
    ("AISI D2", "X153CrMoV12", "X155CrVMo12-1", "1.2379", "T30402", "SKD11"),
    ("AISI D3", "X210Cr12", "1.2080", "T30403", "SKD1"),
    ("AISI M2", "HS6-5-2", "S6-5-2", "1.3343", "T11302", "SKH51"),
    ("AISI T1", "HS18-0-1", "S18-0-1", "1.3355", "T12001", "SKH2"),
)
_STAINLESS_STEEL = (
    ("AISI 403", "X6Cr13", "1.4000", "S40300"),
    ("AISI 405", "X6CrAl13", "1.4002", "S40500"),
    ("AISI 410", "X12Cr13", "1.4006", "S41000", "SUS410"),
    ("AISI 416", "X12CrS13", "1.4005", "S41600", "SUS416"),
    ("AISI 430", "X6Cr17", "1.4016", "S43000", "SUS430"),
    ("AISI 420", "X20Cr13", "1.4021", "S42000", "SUS420J1"),
    ("X40Cr14", "X42Cr13", "1.2083"),
    ("X38CrMo16", "X36CrMo17", "1.2316"),
    ("AISI 431", "X17CrNi16-2", "1.4057", "S43100", "SUS431"),
    ("AISI 440 C", "X105CrMo17", "1.4125", "S44004", "SUS440C"),
    ("17-4PH", "AISI 630", "X5CrNiCuNb16-4", "1.4542", "S17400", "SUS630"),
    ("AISI 303", "X8CrNiS18-9", "X10CrNiS18-9", "1.4305", "S30300", "SUS303"),
    ("AISI 304", "X5CrNi18-10", "1.4301", "S30400", "SUS304", "V2A"),
    ("AISI 304 L", "X2CrNi19-11", "X2CrNi18-9", "1.4306", "1.4307", "S30403", "SUS304L"),
    ("AISI 316", "X5CrNiMo17-12-2", "1.4401", "S31600", "SUS316", "V4A"),
    ("AISI 316 L", "X2CrNiMo17-12-2", "X2CrNiMo18-14-3", "1.4404", "1.4435", "S31603", "SUS316L"),
    ("AISI 316 Ti", "X6CrNiMoTi17-12-2", "1.4571", "S31635", "SUS316Ti"),
    ("AISI 317", "X3CrNiMo18-12-3", "1.4449", "S31700", "SUS317"),
    ("AISI 321", "X6CrNiTi18-10", "1.4541", "S32100", "SUS321"),
    ("duplex 2205", "2205", "X2CrNiMoN22-5-3", "1.4462", "S31803", "S32205"),
)
_CAST_IRON = (
    ("Class 20 B", "EN-GJL-100", "GJL-100", "GG10", "0.6010", "FC100"),
    ("Class 25 B", "EN-GJL-150", "GJL-150", "GG15", "0.6015", "FC150"),
    ("Class 30 B", "EN-GJL-200", "GJL-200", "GG20", "0.6020", "FC200"),
    ("Class 40 B", "EN-GJL-250", "GJL-250", "GG25", "0.6025", "FC250"),
    ("Class 45 B", "EN-GJL-300", "GJL-300", "GG30", "0.6030", "FC300"),
    ("Class 50 B", "EN-GJL-350", "GJL-350", "GG35", "0.6035", "FC350"),
    ("Grade 60-40-18", "EN-GJS-400-18", "GJS-400-18", "EN-GJS-400-15", "GJS-400-15", "GGG40",
     "0.7040", "0.7043", "FCD400"),
    ("Grade 65-45-12", "EN-GJS-450-10", "GJS-450-10", "FCD450"),
    ("EN-GJS-500-7", "GJS-500-7", "GGG50", "0.7050", "FCD500"),
    ("Grade 80-55-06", "EN-GJS-600-3", "GJS-600-3", "GGG60", "0.7060", "FCD600"),
    ("Grade 100-70-03", "EN-GJS-700-2", "GJS-700-2", "GGG70", "0.7070", "FCD700"),
    ("GTW-35-04", "EN-GJMW-350-4", "0.8035"),
    ("GTS-55-04", "EN-GJMB-550-4", "0.8155"),
    ("GTS-65-02", "EN-GJMB-650-2", "0.8165"),
)  # fmt: skip
_LIGHT_METAL = (
    ("AlMg 1", "EN AW-5005", "AW-5005", "5005", "A95005"),
    ("AlMg 3", "EN AW-5754", "AW-5754", "5754", "3.3535", "A95754"),
    ("AlMg4.5Mn", "AlMg4.5Mn0.7", "EN AW-5083", "AW-5083", "5083", "3.3547", "A95083"),
    ("AlCuMg 1", "EN AW-2017A", "AW-2017A", "2017A", "3.1325"),
    ("AlMgSi 1", "EN AW-6082", "AW-6082", "6082", "AlSi1MgMn", "3.2315", "A96082"),
    ("6061", "EN AW-6061", "AW-6061", "AlMg1SiCu", "3.3211", "A96061", "A6061"),
    ("7075", "EN AW-7075", "AW-7075", "AlZnMgCu1.5", "AlZn5.5MgCu", "3.4365", "A97075", "A7075"),
    ("2014-T6", "EN AW-2014", "AW-2014", "2014", "AlCuSiMn", "3.1255", "A92014"),
    ("2024-T4", "EN AW-2024", "AW-2024", "2024", "AlCuMg2", "AlCu4Mg1", "3.1355", "A92024"),
    ("G-AlSi 12", "AlSi12", "EN AC-44200", "AC-44200", "3.2581"),
    ("G-AlSi 7 Mg", "AlSi7Mg", "AlSi7Mg0.3", "EN AC-42100", "AC-42100", "A356", "3.2371"),
    ("G-AlSi 10 Mg", "AlSi10Mg", "EN AC-43000", "AC-43000", "3.2381"),
    ("AlSi17Cu4Mg", "A390", "EN AC-48100", "AC-48100"),
    ("Ti Grade 2", "Ti2", "3.7035", "R50400"),
    ("Ti-6Al-4V", "Ti6Al4V", "TiAl6V4", "Ti64", "TC4", "Grade 5", "3.7164", "3.7165", "R56400"),
)
_COPPER = (
    ("CuZn39Pb3", "CW614N", "2.0401", "Ms58", "C38500"),
    ("CuZn37", "CW508L", "2.0321", "Ms63", "C27200"),
    ("Cu-ETP", "CW004A", "E-Cu58", "2.0065", "C11000"),
)
_HEAT_RESISTANT = (
    ("Incoloy 800", "X10NiCrAlTi32-21", "1.4876", "N08800"),
    ("A286", "X6NiCrTiMoVB25-15-2", "1.4980", "S66286"),
    ("Inconel 600", "IN600", "Alloy 600", "NiCr15Fe", "2.4816", "N06600"),
    ("Inconel 625", "IN625", "Alloy 625", "NiCr22Mo9Nb", "2.4856", "N06625"),
    ("Hastelloy C-276", "NiMo16Cr15W", "2.4819", "N10276"),
    ("Inconel 718", "IN718", "Alloy 718", "NiCr19NbMo", "NiCr19Fe19Nb5Mo3", "2.4668", "N07718"),
    ("Nimonic 80A", "NiCr20TiAl", "2.4631", "2.4952", "N07080"),
    ("Waspaloy", "NiCr19Co14Mo4Ti", "2.4654", "N07001"),
)

#: lines of designations of one grade
EQUIVALENT_GRADES = (
    *(*_STEEL, *_STAINLESS_STEEL, *_CAST_IRON),
    *(*_LIGHT_METAL, *_COPPER, *_HEAT_RESISTANT),
)
#: names of standards that people write before a grade
_STANDARDS = re.compile(r"^(aisi|sae|uns|jis|din|wnr)(?=.)")


def bare(grade: str) -> str:
    """Letters and digits of a grade: catalogues write them with spaces, dots and dashes."""
    return _STANDARDS.sub("", "".join(letter for letter in grade.lower() if letter.isalnum()))


def designations(grade: str) -> frozenset[str]:
    """Return a grade and all that other standards call it, `bare`."""
    wanted = bare(grade)
    found = {wanted}
    for line in EQUIVALENT_GRADES:
        names = {bare(name) for name in line}
        if wanted in names:
            found |= names
    return frozenset(found)
