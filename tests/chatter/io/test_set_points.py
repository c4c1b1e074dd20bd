"""Set points in traces of controls, whatever language, separator and unit they are written in."""

import numpy as np
import pytest

from chatter.description.errors import InputError
from chatter.io.set_points import recorded_positions

TIME = np.linspace(0.0, 0.4, 21)
X, Y = 0.02 * (1.0 - np.cos(10.0 * TIME)), 0.03 * np.sin(5.0 * TIME) ** 2


def comma(value):
    return f"{value:.9f}".replace(".", ",")


@pytest.mark.parametrize(
    ("heading", "mark", "factors", "shown"),
    [
        ("time [s],X [mm],Y [mm]", ",", (1.0, 1e3, 1e3), "{:.12g}".format),
        ("time [s],X set [in],X scale [mm],Y set [in]", ",", (1.0, 1e3 / 25.4, 5.0, 1e3 / 25.4),
         "{:.12g}".format),
        ("Zeit [ms];Lagesollwert X [mm];Lageistwert X [mm];Lagesollwert Y [mm]", ";",
         (1e3, 1e3, 999.0, 1e3), comma),
        ("t/ms\ts nominal X/mm\ts actual X/mm\tv nominal X/(mm/min)\ts diff. X/um\ts nominal Y/mm",
         "\t", (1e3, 1e3, 999.0, 7.0, 3.0, 1e3), "{:.12g}".format),
        ("temps (s);position de consigne X (um);vitesse de consigne X (mm/s);consigne Y (um)", ";",
         (1.0, 1e6, 7.0, 1e6), "{:.12g}".format),
        ("tempo/s,posizione comandata X/mm,errore X/mm,posizione comandata Y/mm", ",",
         (1.0, 1e3, 3.0, 1e3), "{:.12g}".format),
    ],
)  # fmt: skip
@pytest.mark.parametrize("encoding", ["utf-8", "cp1252", "utf-16"])
def test_set_points(tmp_path, heading, mark, factors, shown, encoding):
    values = [TIME, *[X] * (len(factors) - 2), Y]
    rows = np.column_stack([one * factor for one, factor in zip(values, factors, strict=True)])
    text = "\n".join([heading, *(mark.join(shown(cell) for cell in row) for row in rows)])
    path = tmp_path / "trace.csv"
    path.write_bytes((text + "\n").encode(encoding))
    time, found = recorded_positions(path, ("X", "Y"))
    assert time == pytest.approx(TIME, abs=1e-9)
    assert found == pytest.approx(np.column_stack([X, Y]), abs=1e-9)


@pytest.mark.parametrize(
    ("heading", "told"),
    [
        ("t,X [mm],Y [mm]", '"t" has no unit; write it in brackets, such as "t [ms]"'),
        ("t [s],X,Y [mm]", '"X" has no unit; write it in brackets, such as "X [mm]"'),
        ("t [s],X [N],Y [mm]", '"X [N]" has the unit "N"'),
        ("t [s],s actual X [mm],Y [mm]", 'no column "X" or "X set", nor one of a control'),
        ("t [s],s nominal X [mm],X soll [mm]", "may each be the set point of X"),
        ("a [s],X [mm],Y [mm]", 'no column "time"'),
    ],
)
def test_what_is_no_set_point_is_refused(tmp_path, heading, told):
    path = tmp_path / "trace.csv"
    path.write_text(heading + "\n0,0,0\n1,1,1\n2,2,2\n", encoding="utf-8")
    with pytest.raises(InputError) as refused:
        recorded_positions(path, ("X",))
    assert told in str(refused.value)
