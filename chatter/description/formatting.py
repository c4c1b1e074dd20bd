"""Values as messages show them: short, printable, as they stand in a case file."""

import math
from typing import Any

_LONGEST = 60
#: significant digits that a double has for certain
_MOST_DIGITS = 15


def formatted(value: Any) -> str:
    """Show a value as it stands in a case file, shortened and in printable characters."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f'"{printable(value)}"'
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, (list, tuple)):
        return printable(f"[{', '.join(formatted(entry) for entry in value[:10])}]")
    try:
        return printable(str(value))
    except ValueError:
        # Python refuses to write integers of thousands of digits
        return "a number of thousands of digits"


def printable(text: str, longest: int = _LONGEST) -> str:
    """Return text without control characters and cut to what fits a message."""
    clean = "".join(part if part.isprintable() else "?" for part in text[: longest + 1])
    return clean if len(clean) <= longest else clean[:longest] + "..."


def rounded_down(value: float, digits: int = 3) -> str:
    """Positive number to so many significant digits, none of which makes it larger."""
    unit = 10.0 ** (math.floor(math.log10(value)) - digits + 1)
    return f"{math.floor(value / unit * (1.0 + 1e-12)) * unit:.{digits}g}"


def to_digits(value: float, digits: int = 2) -> str:
    """Number to so many significant digits, without an exponent where people write none: 140."""
    short = f"{value:.{digits}g}"
    return f"{float(short):.6g}" if 1.0 <= abs(float(short)) < 1e6 else short


def distinct_from(value: float, beside: float, digits: int = 4) -> str:
    """Number to so many significant digits, to more where it would read as the one beside it."""
    for more in range(digits, _MOST_DIGITS):
        if f"{value:.{more}g}" != f"{beside:.{more}g}":
            return f"{value:.{more}g}"
    return f"{value:.{digits}g}"


def signed(value: float, digits: int = 2) -> str:
    """Number as `to_digits` has it, with its sign."""
    return ("-" if value < 0.0 else "+") + to_digits(abs(value), digits)
