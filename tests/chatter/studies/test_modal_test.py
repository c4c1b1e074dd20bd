"""Folders of raw hammer records: faults found, good ones kept, modes as they were made."""

import pytest
import tomlkit

import chatter
from chatter.description.errors import InputError
from tests.places import SHARED

FOLDER = SHARED / "taptests"
SETS = sorted(FOLDER.glob("tap-*"))


@pytest.mark.skipif(not SETS, reason="shared data not at hand")
@pytest.mark.parametrize("folder", SETS, ids=lambda path: path.name)
def test_hammer_sets(folder):
    truth = tomlkit.parse((folder / "truth.toml").read_text()).unwrap()
    test = chatter.modes(folder, direction="x")
    # every faulty record found, no good one lost
    assert {finding.record for finding in test.hammer.left_out} == set(truth["faults"])
    found = [mode for mode in test.fit.identified if not mode.warning]
    assert len(found) == len(truth["modes"])
    for mode, (frequency, damping, mass) in zip(found, truth["modes"], strict=True):
        assert mode.frequency == pytest.approx(frequency, rel=0.002)
        assert mode.damping == pytest.approx(damping, rel=0.05)
        assert mode.mass == pytest.approx(mass, rel=0.03)


@pytest.mark.skipif(not SETS, reason="shared data not at hand")
def test_a_faulty_record_can_be_kept():
    test = chatter.modes(SETS[0], keep=["tap03.csv"], direction="x")
    assert "tap03.csv" in test.hammer.used
    assert "tap03.csv" not in {finding.record for finding in test.hammer.left_out}


@pytest.mark.skipif(not SETS, reason="shared data not at hand")
def test_unknown_record_to_keep():
    with pytest.raises(InputError, match=r"tap99\.csv"):
        chatter.modes(SETS[0], keep=["tap99.csv"])


def test_keep_belongs_to_hammer_records(tmp_path):
    with pytest.raises(InputError, match="hammer records"):
        chatter.modes(tmp_path / "x.csv", keep=["a"])


def test_empty_folder(tmp_path):
    with pytest.raises(InputError, match="no hammer record"):
        chatter.modes(tmp_path)
