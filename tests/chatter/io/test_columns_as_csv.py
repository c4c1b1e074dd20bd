"""Columns of a run as CSV: the bytes that numpy writes."""

from io import StringIO

import numpy as np
import pytest

from chatter.io.recorded_columns import write_columns


@pytest.mark.parametrize("rows", [0, 1, 511, 512, 513, 1300])
def test_the_bytes_are_those_of_numpy(tmp_path, rows):
    random = np.random.default_rng(rows)
    force = random.standard_normal(rows) * 10.0 ** random.integers(-320, 308, rows)
    for place, value in enumerate([np.nan, np.inf, -np.inf, -0.0, 0.5, 1e15]):
        force[place + 1 :: 50] = value
    columns = {"time [s]": np.linspace(0.0, 3.0, rows), "Fx [N]": force}
    forms = ["%.9g", "%.6g"]
    (path,) = write_columns(tmp_path, "signals", "csv", columns, forms)
    expected = StringIO()
    np.savetxt(
        expected, np.column_stack(list(columns.values())), fmt=forms, delimiter=",",
        header="time [s],Fx [N]", comments="",
    )  # fmt: skip
    assert path.read_bytes() == expected.getvalue().encode()
