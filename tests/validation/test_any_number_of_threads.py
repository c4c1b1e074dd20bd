"""Every file that a study writes is the same, byte by byte, on one, two and eight processors."""

import os

import pytest

import chatter
from tests.cases import tool_of_922_hertz

CASE = {
    "simulation": {"revolutions": 60},
    "lobes": {
        "speeds": {"from": "8000 rpm", "to": "10000 rpm", "count": 40},
        "depths": {"to": "4 mm", "count": 20},
    },
}
STUDIES = {
    "lobes": lambda case, _: chatter.lobes(case),
    "grid": lambda case, _: chatter.lobes(case, grid=True),
    "check": lambda case, _: chatter.check(case),
    "whatif": lambda case, out: chatter.whatif(case, ["material.Ktc=+-10%"], folder=out),
    "uncertainty": lambda case, out: chatter.uncertainty(
        case.patch({"material.Ktc": "600 +- 50 MPa"}), 12, speeds=3, folder=out
    ),
    "bifurcation": lambda case, out: chatter.bifurcation(
        case, "cut.axial_depth", ["1 mm", "2 mm", "3 mm"], folder=out
    ),
}


def written(study, folder):
    """Every file of a study but those of the result cache, and what only packs them."""
    case = tool_of_922_hertz(**CASE)
    STUDIES[study](case, folder).save(folder)
    return {
        path.name: path.read_bytes()
        for path in sorted(folder.iterdir())
        if path.is_file() and path.suffix != ".npz"
    }


@pytest.mark.parametrize("study", STUDIES)
def test_the_same_bytes_on_any_number_of_processors(study, tmp_path, monkeypatch):
    found = []
    for count in (1, 2, 8):
        monkeypatch.setattr(
            os, "sched_getaffinity", lambda _, n=count: set(range(n)), raising=False
        )
        found.append(written(study, tmp_path / str(count)))
    assert found[0]
    assert found[1] == found[0]
    assert found[2] == found[0]
