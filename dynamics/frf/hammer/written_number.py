"""Numbers of findings as people write them."""


def written(value: float, digits: int = 3) -> str:
    """Number to so many significant digits, without an exponent where people write none: 2530."""
    short = f"{value:.{digits}g}"
    return f"{float(short):.6g}" if 1.0 <= abs(float(short)) < 1e6 else short
