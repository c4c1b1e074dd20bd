"""The oldest versions that pyproject.toml allows, as constraints for pip.

    python -m tests.lowest_versions > constraints.txt

`make lowest` installs them and runs tests with them.
"""

import re
from pathlib import Path

import tomlkit

PROJECT = Path(__file__).parents[1] / "pyproject.toml"
#: extras that the tests of `make lowest` need
EXTRAS = ("formats",)
_REQUIREMENT = re.compile(r"(?P<name>[\w.-]+)>=(?P<version>[\w.]+)")


def lowest_versions(project: dict) -> dict[str, str]:
    """Name -> oldest version of every dependency, and of those of the extras.

    ValueError for one that has no lower bound.
    """
    extras = project["optional-dependencies"]
    wanted = [*project["dependencies"], *(one for name in EXTRAS for one in extras[name])]
    found = {}
    for one in wanted:
        match = _REQUIREMENT.fullmatch(one)
        if match is None:
            raise ValueError(f"pyproject.toml: {one}: NAME>=VERSION is required")
        found[match["name"]] = match["version"]
    return found


def main() -> None:
    """Print a constraint a line."""
    project = tomlkit.parse(PROJECT.read_text(encoding="utf-8"))["project"]
    for name, version in lowest_versions(project).items():
        print(f"{name}=={version}")


if __name__ == "__main__":
    main()
