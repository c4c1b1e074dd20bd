"""Range of the command line, FROM..TO:COUNT, and the same words of what is wrong with its count."""

from __future__ import annotations

from chatter.description.errors import InputError
from chatter.description.formatting import formatted
from chatter.description.ranges import without_count


def counted_range(where: str, span: str, count: int, most: int) -> tuple[str, int]:
    """Ends of a range, "FROM..TO", and the number of its values.

    `where` is the option and the path for messages; `count`, that of --count, is for a range that
    gives none.
    InputError if the number is no whole number from 2 to `most`.
    """
    ends, own = without_count(span)
    _, colon, given = ends.rpartition(":")
    if own is None and colon:
        raise InputError(
            f"{where}: {formatted(given.strip())} is no count; behind the colon of FROM..TO:COUNT "
            f"stands a whole number, 2 to {most}"
        )
    number = count if own is None else own
    if not 2 <= number <= most:
        if own is None:
            raise InputError(f"--count {number}: a number from 2 to {most} is required")
        raise InputError(f"{where}: a count of {number} is given; 2 to {most} is required")
    return ends, number
