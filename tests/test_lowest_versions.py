"""The constraints of `make lowest` are the lower bounds of pyproject.toml."""

import pytest
import tomlkit

from tests.lowest_versions import PROJECT, lowest_versions


def test_every_library_that_is_needed_has_its_oldest_version():
    project = tomlkit.parse(PROJECT.read_text(encoding="utf-8"))["project"]
    found = lowest_versions(project)
    assert len(found) == len(project["dependencies"]) + len(
        project["optional-dependencies"]["formats"]
    )
    assert f"numba>={found['numba']}" in project["dependencies"]


def test_a_library_without_a_lower_bound_is_told():
    project = {"dependencies": ["numpy"], "optional-dependencies": {"formats": []}}
    with pytest.raises(ValueError, match=r"numpy: NAME>=VERSION is required"):
        lowest_versions(project)
