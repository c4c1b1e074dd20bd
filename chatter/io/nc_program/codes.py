"""G and M codes that are known: what they set, and the group of which a block has one."""

from __future__ import annotations

from collections.abc import Mapping

#: number of a G code -> its group and what it sets there
G_CODES: Mapping[float, tuple[str, str]] = {
    0: ("motion", "rapid"),
    1: ("motion", "line"),
    2: ("motion", "clockwise"),
    3: ("motion", "counter-clockwise"),
    4: ("dwell", "dwell"),
    9: ("stop", "stop"),
    17: ("plane", "XY"),
    18: ("plane", "ZX"),
    19: ("plane", "YZ"),
    20: ("units", "inch"),
    21: ("units", "millimetre"),
    70: ("units", "inch"),
    71: ("units", "millimetre"),
    40: ("radius compensation", "off"),
    49: ("length compensation", "off"),
    54: ("zero offset", "first"),
    60: ("corners", "stop"),
    61: ("corners", "stop"),
    64: ("corners", "pass"),
    80: ("cycle", "off"),
    90: ("distances", "absolute"),
    91: ("distances", "incremental"),
    90.1: ("centres", "absolute"),
    91.1: ("centres", "incremental"),
    94: ("feed", "a minute"),
    95: ("feed", "a revolution"),
}
#: G codes that are often met, and why they are not taken
REFUSED_G: Mapping[float, str] = {
    28: "moves to a reference point that the program does not tell",
    30: "moves to a reference point that the program does not tell",
    41: "tool radius compensation is not taken: program the path of the tool axis",
    42: "tool radius compensation is not taken: program the path of the tool axis",
    43: "tool length compensation is not taken: program the path of the tool tip",
    53: "machine coordinates are not taken",
    92: "a shift of the zero is not taken",
    93: "inverse-time feed is not taken",
}
#: M codes that move nothing here
PASSED_M = frozenset({0, 1, 3, 4, 5, 6, 7, 8, 9})
#: M codes that end the program
END_M = frozenset({2, 30})
#: plane -> the two axes of its circles, from the first to the second counter-clockwise
PLANES: Mapping[str, tuple[int, int]] = {"XY": (0, 1), "ZX": (2, 0), "YZ": (1, 2)}
#: letters that a block may have, beside G, M and those of the plane's centre
LETTERS = frozenset("GMXYZIJKRFSTN") | {"CR"}
