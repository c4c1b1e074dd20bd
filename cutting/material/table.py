"""Published cutting coefficients by name, each with its source and what it does not stand for."""

from collections.abc import Iterable, Mapping

from cutting.material import coefficients_of_tests, specific_cutting_force
from cutting.material.row import MaterialRow

#: name in a case file -> row; coefficients hold for the tool and conditions of their source
MATERIALS: dict[str, MaterialRow] = {**coefficients_of_tests.ROWS, **specific_cutting_force.ROWS}


def found_rows(
    words: Iterable[str], rows: Mapping[str, MaterialRow] = MATERIALS
) -> dict[str, MaterialRow]:
    """Rows that have all of the words, in any case, in name, grades, condition or source.

    A grade is found under what other standards call it, too.
    """
    wanted = [word.lower() for word in words]
    # a grade that came as several words: "GG 25" is no nodular iron (GGG) of 250 HB
    together = "".join(wanted)
    of_grade = {name: row for name, row in rows.items() if row.has_grade(together)}
    if of_grade and len(wanted) > 1:
        return of_grade
    return {
        name: row
        for name, row in rows.items()
        if all(word in row.words(name) or row.has_grade(word) for word in wanted)
    }
