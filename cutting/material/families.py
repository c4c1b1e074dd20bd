"""Family of a grade that no row names, read from its designation, and the nearest rows.

Numbers: EN 10027-2 (steels), DIN 17007 (cast iron 0.6 to 0.8, copper and nickel 2.x, light metals
3.x); names: AISI and SAE, EN 573-3, EN 1560, EN 1412, EN 10027-1.
"""

import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Family:
    """Materials that are cut alike."""

    name: str  # with its article
    groups: tuple[int, ...]  # of VDI 3323; none where the table has no such row


_PLAIN = Family("a non-alloy steel", (1, 2, 3, 4, 5))
_ALLOY = Family("an alloy steel", (6, 7, 8, 9))
_TOOL = Family("a tool steel", (6, 8, 10, 11))
_STAINLESS = Family("a stainless steel", (12, 13, 14))
_HEAT_RESISTANT = Family("a heat-resistant steel", (14, 31, 32))
_GREY = Family("a grey cast iron", (15, 16))
_NODULAR = Family("a nodular cast iron", (17, 18))
_MALLEABLE = Family("a malleable cast iron", (19, 20))
_ALUMINIUM = Family("an aluminium alloy", (21, 22, 23, 24, 25))
_COPPER = Family("copper or a copper alloy", (26, 27, 28))
_NICKEL = Family("a nickel or cobalt alloy", (33, 34, 35))
_TITANIUM = Family("titanium or an alloy of it", (36, 37))
_MAGNESIUM = Family("a magnesium alloy", ())
_NO_METAL = Family("no metal", ())

#: pattern of a whole designation, lower case and without spaces -> family; the first that fits
_PATTERNS: tuple[tuple[str, Family], ...] = (
    (r"1\.[01]\d{3}", _PLAIN),
    (r"1\.(2[0-8]|3[23])\d\d", _TOOL),
    (r"1\.4[0-5]\d\d", _STAINLESS),
    (r"1\.4[6-9]\d\d", _HEAT_RESISTANT),
    (r"1\.[35-8]\d{3}", _ALLOY),
    (r"0\.6\d{3}|(en-?)?gjl.*|gg-?\d\d", _GREY),
    (r"0\.7\d{3}|(en-?)?gjs.*|ggg.*", _NODULAR),
    (r"0\.8\d{3}|(en-?)?gjm.*|gt[sw].*", _MALLEABLE),
    (r"2\.[01]\d{3}|cu[a-z].*|cw\d{3}[a-z]|ms\d\d|bronze|ampco.*|c[1-7]\d{4}", _COPPER),
    (r"2\.4\d{3}|ni[a-z].*|(inconel|incoloy|hastelloy|nimonic|monel|haynes|ren|udimet).*", _NICKEL),
    (r"n\d{5}|stellite.*", _NICKEL),
    (r"3\.[0-4]\d{3}|(en)?-?a[wc]-?\d{4,5}.*|g?-?al[a-z]*\d.*|al[a-z].*|a9\d{4}", _ALUMINIUM),
    (r"3\.5\d{3}|mg[a-z].*|az\d\d.*|magnesium", _MAGNESIUM),
    (r"3\.7\d{3}|ti-?\d.*|ti[a-z]{1,2}\d.*|r5\d{4}", _TITANIUM),
    (r"(aisi|sae)?1[0-5]\d\d|c[kmfq]?\d\d[er]?|s\d{3}.{0,6}|st\d\d.*|g1[0-5]\d{3}|s\d\dc", _PLAIN),
    (r"(aisi|sae)?(41|43|51|61|86|87|9[234])\d\d|g[4-9]\d{4}|(scm|scr|snc)\w*\d+", _ALLOY),
    (r"[2357]\d{3}(-t\d+)?|50\d\d|5[2-9]\d\d|6[02-9]\d\d(-t\d+)?", _ALUMINIUM),
    (r"(aisi|sus)?[2-4]\d\d[a-z]{0,2}|s[2-4]\d{4}|\d\d-\dph", _STAINLESS),
    (r"(aisi)?(h|p|t|m)\d\d?|(aisi)?[adosw]\d|skd\d+|skh\d+|sks\d+|hs\d.*|t[1-7]\d{4}", _TOOL),
    (r"x\d+cr.*", Family("a stainless or high-alloyed steel", (10, 11, 12, 13, 14))),
    (r"\d\d?\d?(cr|mn|ni|mo|si|v)[a-z]*\d?.*", _ALLOY),
    (r"(hardox|toolox|weldox|strenx).*", _ALLOY),
    (r"pom.*|peek|pa6*|pmma|abs|pvc|ptfe|p[epc]|delrin|acrylic|nylon|plastics?", _NO_METAL),
    (r"[cg]f(rp|k)|gfrp|wood|mdf|plywood|graphite|ceramics?|glass", _NO_METAL),
)  # fmt: skip


def family_of(grade: str) -> Family | None:
    """Family that the designation of a grade tells; None where it tells none."""
    text = "".join(grade.lower().split())
    fits = (family for pattern, family in _PATTERNS if re.fullmatch(pattern, text))
    return next(fits, None)
