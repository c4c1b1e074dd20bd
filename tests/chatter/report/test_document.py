"""Values of a description in a report: bare numbers have the units that people read them in."""

from chatter.description.case import loads
from chatter.description.machine.machine_file import MachineFile
from chatter.report.document import rows_of
from tests.cases import TOOL_OF_922_HERTZ
from tests.chatter.simulation.virtual_tests.conftest import FILE


def test_a_gain_is_in_one_over_seconds_as_it_is_written():
    machine = MachineFile.from_text(FILE).patch({"axis.Y.control.position.gain": 42.0})
    assert ["axis.Y.control.position.gain", "42 1/s"] in rows_of(machine)


def test_a_rate_of_wear_is_by_the_minute_and_a_pressure_in_megapascal():
    case = loads(TOOL_OF_922_HERTZ).patch({"wear.cutting": 0.002, "material.Ktc": 6.1e8})
    rows = rows_of(case)
    assert ["wear.cutting", "0.12 1/min"] in rows
    assert ["material.Ktc", "610 MPa"] in rows
