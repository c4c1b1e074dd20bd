"""A case names files below its folder; others where the user allows them."""

import pytest

import chatter
from chatter import InputError
from chatter.app.workbench.session import Session
from chatter.description import file_access
from chatter.description.file_access import VARIABLE
from chatter.explain.measurement_file import read_measurement
from tests.cases import TOOL_OF_922_HERTZ

TABLE = "secret"
WITH_TABLE = TOOL_OF_922_HERTZ.replace(
    'Ktc = "600 MPa"\nKrc = "200 MPa"', 'name = "own"\ntable = "{}"'
)
OWN = '[own]\nKtc = "600 MPa"\nKrc = "200 MPa"\nsource = "measured"\n'


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Folder of the case; the program starts elsewhere."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.delenv(VARIABLE, raising=False)
    start, case = tmp_path / "start", tmp_path / "elsewhere" / "case"
    for one in (start, case / "below"):
        one.mkdir(parents=True)
    monkeypatch.chdir(start)
    for place in (case / "below", case.parent, start):
        (place / "own.toml").write_text(OWN)
    return case


def case_with(folder, table):
    path = folder / "case.toml"
    path.write_text(WITH_TABLE.format(table))
    return path


@pytest.mark.parametrize("outside", ["../own.toml", "below/../../own.toml", "{}/own.toml"])
def test_a_file_outside_is_refused(folder, outside):
    path = case_with(folder, outside.format(folder.parent))
    with pytest.raises(InputError, match=rf"case\.toml: material\.table: .*{VARIABLE}=.*elsewhere"):
        chatter.load(path)


def test_a_link_does_not_lead_outside(folder):
    (folder / "own.toml").symlink_to(folder.parent / "own.toml")
    with pytest.raises(InputError, match="outside"):
        chatter.load(case_with(folder, "own.toml"))


def test_files_below_and_where_the_program_starts_are_read(folder, tmp_path):
    for table in ("below/own.toml", tmp_path / "start" / "own.toml"):
        assert chatter.load(case_with(folder, table)).material.Ktc == 600e6


def test_the_user_allows_a_folder(folder, monkeypatch):
    monkeypatch.setenv(VARIABLE, str(folder.parent))
    assert chatter.load(case_with(folder, "../own.toml")).material.Ktc == 600e6


def test_what_the_user_types_is_allowed(folder):
    case = chatter.load(case_with(folder, "below/own.toml"))
    assert case.patch({"material.table": "../own.toml"}).material.Ktc == 600e6


def test_a_case_that_was_written_here_may_name_what_the_case_before_named(folder, tmp_path):
    case = chatter.load(case_with(folder, "below/own.toml"))
    written = tmp_path / "results" / "case.toml"
    case.patch({"cut.axial_depth": "2 mm"}).save(written)
    assert chatter.load(written).material.Ktc == 600e6
    # the same by another hand
    written.write_text(written.read_text() + "# changed\n")
    with pytest.raises(InputError, match="outside"):
        chatter.load(written)


def test_a_folder_that_the_workbench_was_given_is_allowed(folder, monkeypatch):
    monkeypatch.setattr(file_access, "_OPENED", set())
    path = case_with(folder, "../own.toml")
    with pytest.raises(InputError, match="own"):
        chatter.load(path)
    Session(folder.parent)
    assert chatter.load(path).material.Ktc == pytest.approx(600e6)
    path = case_with(folder, "../../start/own.toml")
    monkeypatch.chdir(folder)
    with pytest.raises(InputError, match="lies outside"):
        chatter.load(path)


MEASUREMENT = 'kind = "milling"\ncase = "{case}"\n[[run]]\nfile = "{run}"\n'


@pytest.mark.parametrize(
    ("key", "names"),
    [
        ("case", {"case": "../case.toml", "run": "run.csv"}),
        (r"run 1: file", {"case": "case.toml", "run": "../run.csv"}),
        (r"run 1: file", {"case": "case.toml", "run": "link.csv"}),
    ],
)
def test_a_measurement_names_files_below_its_folder(folder, monkeypatch, key, names):
    for place in (folder, folder.parent):
        (place / "case.toml").write_text(TOOL_OF_922_HERTZ)
        (place / "run.csv").write_text("time [s],Fx [N]\n0,secret\n1,2\n")
    (folder / "link.csv").symlink_to("../run.csv")
    (folder / "measurement.toml").write_text(MEASUREMENT.format(**names))
    with pytest.raises(InputError, match=rf"measurement\.toml: {key}: .*{VARIABLE}=") as told:
        read_measurement(folder)
    assert "secret" not in str(told.value)
    monkeypatch.setenv(VARIABLE, str(folder.parent))
    with pytest.raises(InputError, match="secret"):
        read_measurement(folder)
