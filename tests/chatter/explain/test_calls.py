"""`chatter.explain` and `chatter.compare` are calls like the others."""

import subprocess
import sys

import numpy as np
import pytest

import chatter
from chatter.explain.comparison import compare
from chatter.explain.effects.effect_list import EFFECTS
from chatter.explain.kinds.kind import Kind
from chatter.explain.kinds.kind_list import KINDS
from chatter.io.shipped_examples import examples


@pytest.mark.parametrize(
    "imports",
    [
        "import chatter",
        "import chatter.explain.kinds.kind_list",
        "import chatter; chatter.compare; import chatter.explain.effects",
        "from chatter import explain; import chatter",
    ],
)
def test_explain_is_a_call_whatever_was_imported_before(imports, tmp_path):
    (tmp_path / "measurement.toml").write_text('kind = "drilling"\n')
    code = (
        f"{imports}\nimport chatter\n"
        "from chatter import InputError\n"
        f"try:\n    chatter.explain({str(tmp_path)!r})\n"
        "except InputError as error:\n    print(error)\n"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "drilling" in told.stdout


def test_compare_takes_a_folder_and_another_case(tmp_path):
    folder = examples()["explain-axis"].folder / "measurement"
    declared = chatter.compare(folder)
    stiffer = chatter.load(folder / "case.toml").patch({"axis.coulomb_friction": "10 N"})
    other = compare(folder, stiffer)
    assert declared.summary()["nrmse"] != pytest.approx(other.summary()["nrmse"], rel=0.01)
    residual = declared.signature.residual.of("force")[0]
    assert residual.values.shape == residual.run.signals["time"].shape
    assert np.all(np.isfinite(residual.normalised))


def test_every_kind_is_one_and_every_effect_says_what_it_is():
    assert all(isinstance(kind, Kind) for kind in KINDS.values())
    for effect in EFFECTS:
        assert effect.label
        assert effect.help
        assert set(effect.kinds) <= set(KINDS)
