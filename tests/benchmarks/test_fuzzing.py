"""A small share of the fuzzing campaign, and that it finds what is planted."""

import os
import signal
import time

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

import chatter
from benchmarks.fuzzing.answers import checked, command, linearised, read_as_all, read_set, sources
from benchmarks.fuzzing.campaign import campaign, read_journal, table
from benchmarks.fuzzing.from_schema import documents
from benchmarks.fuzzing.from_shipped import nodes_at, paths
from benchmarks.fuzzing.isolated import AS_IT_SHOULD, REFUSED, Worker, in_words
from benchmarks.fuzzing.odd_records import odd_tables
from chatter import InputError
from chatter.description.case import loads
from chatter.explain.measurement_schema import measurement_schema

#: `CHATTER_FUZZING=1000 pytest tests/benchmarks/test_fuzzing.py` draws more
COUNT = int(os.environ.get("CHATTER_FUZZING", "12"))
ASKED = {
    "one-degree-of-freedom/case.toml": (checked, command("check", "--method", "zero-order")),
    "flexible-workpiece/case.toml": (checked,),
    "machine-drive-control/machine.toml": (linearised,),
    "set-121/measurement.toml": (read_set,),
    "set-131/measurement.toml": (read_set,),
}


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    return list(sources(tmp_path_factory.mktemp("fuzzing")))


def asked(source, answer, count):
    """What is wrong with the answers to some inputs of a source."""
    wrong = []

    @settings(
        max_examples=count,
        database=None,
        deadline=None,
        derandomize=True,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(source.inputs)
    def ask(content):
        source.path.write_bytes(content)
        words = in_words(lambda: answer(source.path), (source.path.name, source.path.parent.name))
        if words not in AS_IT_SHOULD:
            wrong.append((words, content))

    ask()
    source.path.write_bytes(source.whole)
    return wrong


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", ASKED)
def test_drawn_files_end_in_an_answer_or_a_refusal(found, name):
    (source,) = (one for one in found if one.name == name)
    for answer in ASKED[name]:
        assert asked(source, answer, COUNT) == []


@pytest.mark.filterwarnings("ignore")
def test_damaged_files_of_every_format_end_in_an_answer_or_a_refusal(found):
    files = [one for one in found if one.kind == "file"]
    assert len(files) > 20
    for source in files:
        assert read_as_all(source.path) is None  # whole
        assert asked(source, read_as_all, COUNT // 2) == []


def test_paths_of_shipped_files_are_known_to_the_schemas(found):
    shipped = loads(next(one for one in found if one.kind == "case").whole.decode())
    schema = chatter.schema()
    assert all(nodes_at(schema, path) for path in paths(shipped._plain()))
    assert not nodes_at(schema, ("tool", "nothing"))


def test_documents_hold_what_the_schema_requires():
    schema = measurement_schema()

    @settings(max_examples=5, database=None, deadline=None, derandomize=True)
    @given(documents(schema))
    def draw(document):
        assert {"kind", "case"} <= set(document) <= set(schema["properties"])

    draw()


def _faulty(number):
    def answer():
        if number == 0:
            raise InputError("case.toml: tool.teeth: 0 is given")
        if number == 1:
            raise InputError("something is wrong")
        if number == 2:
            return 1 / 0
        if number == 3:
            os.kill(os.getpid(), signal.SIGTERM)
        if number == 4:
            until = time.process_time() + 60.0
            while time.process_time() < until:
                pass
        return bytearray(4 << 30) and None

    return in_words(answer, ("case.toml",))


@pytest.mark.filterwarnings("ignore")
def test_what_is_planted_is_found():
    worker = Worker(_faulty)
    said = [worker.ask(number, seconds=1) for number in range(6)]
    worker.end()
    assert said[0] == REFUSED
    assert said[1].startswith("refusal without a file")
    assert said[2].startswith("ZeroDivisionError at test_fuzzing.py")
    assert said[3] == "signal 15"
    assert said[4] == "no answer within 1 s"
    assert said[5] == "memory"


@pytest.mark.filterwarnings("ignore")
def test_a_campaign_goes_on_where_it_ended(found, tmp_path):
    files = [one for one in found if one.name in ("tap.csv", "tap.txt")]
    first = campaign(tmp_path, files, 100, seed=5)
    assert [sum(v for k, v in one.items() if k not in ("source", "seed")) for one in first] == [
        50,
        50,
    ]
    journal = tmp_path / "journal.jsonl"
    # ended within the second line
    journal.write_text(journal.read_text()[:-20])
    assert len(read_journal(tmp_path)) == 1
    journal.write_text(journal.read_text() + "\n")
    assert campaign(tmp_path, files, 100, seed=5) == first
    assert "| file | 100 |" in table(first)


def test_values_fit_their_bounds_mostly():
    integers = {"type": "integer", "minimum": 2, "maximum": 5}
    drawn = []

    @settings(max_examples=60, database=None, derandomize=True)
    @given(st.deferred(lambda: documents({"properties": {"n": integers}, "required": ["n"]})))
    def draw(document):
        drawn.append(document["n"])

    draw()
    fitting = [n for n in drawn if isinstance(n, int) and 2 <= n <= 5]
    assert set(fitting) == {2, 3, 4, 5}
    assert len(fitting) > len(drawn) // 2


TAP = "time [s],force [N]\n" + "\n".join(f"{1e-3 * k:g},{k % 7}" for k in range(300)) + "\n"


@settings(max_examples=COUNT, deadline=None, database=None, phases=[Phase.generate])
@given(content=odd_tables(TAP.encode()))
def test_odd_records_are_read_or_refused(tmp_path_factory, content):
    path = tmp_path_factory.mktemp("record") / "tap.csv"
    path.write_bytes(content)
    assert in_words(lambda: read_as_all(path), (path.name,)) in AS_IT_SHOULD
