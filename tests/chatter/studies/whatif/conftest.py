"""A small case, as a file and as an object."""

import pytest

from chatter.description.case import loads
from tests.cases import TOOL_OF_922_HERTZ

TEXT = f"""{TOOL_OF_922_HERTZ.replace('"1 mm"', '"1.5 mm"')}
[simulation]
revolutions = 30

[lobes]
speeds = {{ from = "8000 rpm", to = "12000 rpm", count = 9 }}
depths = {{ to = "5 mm", count = 40 }}
method = "zero-order"
"""

MACHINE = """
title = "two masses"
tool_point = "tool"
workpiece = "work"

[body.head]
mass = "100 kg"
size = ["300 mm", "300 mm", "300 mm"]
centre = ["0 mm", "0 mm", "300 mm"]

[connector.column]
between = ["head", "ground"]
at = ["0 mm", "0 mm", "300 mm"]
stiffness = { x = "20 N/um", y = "40 N/um", z = "80 N/um", rx = "1e8 N*m/rad", ry = "1e8 N*m/rad", rz = "1e8 N*m/rad" }
damping = { x = "2 kN*s/m", y = "3 kN*s/m", z = "5 kN*s/m" }

[point.tool]
on = "head"
at = ["0 mm", "0 mm", "300 mm"]
[point.work]
on = "ground"
at = ["0 mm", "0 mm", "300 mm"]

[frf.x]
excite = "tool/work:x"
band = ["20 Hz", "200 Hz"]
lines = 1801
"""  # noqa: E501


@pytest.fixture
def case():
    return loads(TEXT)


@pytest.fixture
def case_file(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(TEXT, encoding="utf-8")
    return path


@pytest.fixture
def machine_file(tmp_path):
    path = tmp_path / "machine.toml"
    path.write_text(MACHINE, encoding="utf-8")
    return path


@pytest.fixture
def case_on_machine(tmp_path, machine_file):
    head = TEXT[: TEXT.index("[[structure.mode]]")]
    tail = TEXT[TEXT.index("[simulation]") :]
    path = tmp_path / "on-machine.toml"
    path.write_text(f'{head}[structure]\nmachine = "{machine_file.name}"\n\n{tail}')
    return path
