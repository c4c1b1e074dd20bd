import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from chatter.description.errors import InputError
from chatter.description.registry import Registry


@dataclass(frozen=True)
class Law:
    name: str
    label: str = "Law"
    help: str = "a law"


LAWS = Registry(
    group="chatter.force_laws", what="force law", built_in=(Law("linear"), Law("exponential"))
)


def test_entries_are_found_by_name_in_the_order_of_the_list():
    assert LAWS.names() == ("linear", "exponential")
    assert LAWS["linear"].name == "linear"
    assert "linear" in LAWS
    assert "cubic" not in LAWS
    assert [law.name for law in LAWS] == ["linear", "exponential"]
    assert len(LAWS) == 2


def test_an_unknown_name_is_answered_by_what_there_is():
    with pytest.raises(InputError, match='force law "cubic" is not known; there are "linear", "ex'):
        LAWS["cubic"]
    with pytest.raises(InputError, match='did you mean "exponential"'):
        LAWS["exponental"]


def test_a_group_must_be_one_that_is_read():
    with pytest.raises(ValueError, match="none of the entry point groups"):
        Registry(group="chatter.laws", what="law", built_in=())


def _install(folder: Path, module: str, entry: str) -> None:
    """Lay out an installed package as pip does."""
    (folder / "my_laws.py").write_text(module)
    info = folder / "my_laws-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: my-laws\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[chatter.force_laws]\nmine = {entry}\n")


def _run(folder: Path, program: str) -> str:
    paths = [str(folder), str(Path(__file__).parents[3])]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}
    done = subprocess.run(
        [sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True
    )
    return done.stdout


_PROGRAM = """
from chatter.description.errors import InputError
from chatter.description.registry import Registry, extension_sources
from types import SimpleNamespace
laws = Registry(group="chatter.force_laws", what="force law",
                built_in=(SimpleNamespace(name="linear", label="", help=""),))
print([path.name for path in extension_sources()])
try:
    print(*laws.names())
except InputError as error:
    print(error)
"""
_MODULE = "class Mine:\n    name, label, help = 'mine', 'Mine', 'a law of mine'\n"


def test_an_entry_of_an_installed_package_is_found(tmp_path):
    _install(tmp_path, _MODULE, "my_laws:Mine")
    assert _run(tmp_path, _PROGRAM).splitlines() == ["['my_laws.py']", "linear mine"]


@pytest.mark.parametrize(
    ("module", "entry", "said"),
    [
        (_MODULE.replace("'mine'", "'linear'"), "my_laws:Mine", "has the name of another one"),
        (_MODULE, "my_laws:Yours", 'force law "mine" of package my-laws (my_laws:Yours) cannot be'),
        ("Mine = 1", "my_laws:Mine", "has no name, label, help"),
    ],
)
def test_an_entry_that_does_not_fit_is_named_with_its_package(tmp_path, module, entry, said):
    _install(tmp_path, module, entry)
    answer = _run(tmp_path, _PROGRAM)
    assert said in answer
    assert "my-laws" in answer
