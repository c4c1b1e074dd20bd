"""The registry of stability methods: its table in the docs, refusals, former names."""

import pytest

from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.progress import no_progress
from chatter.stability.model import milling_model
from chatter.stability.registry import METHODS, chosen_method, documentation, with_radius
from tests.places import ROOT

CASE = {
    "tool": {"teeth": 2, "diameter": "16 mm"},
    "material": {"Ktc": "600 MPa", "Krc": "200 MPa"},
    "cut": {
        "mode": "up", "spindle_speed": "20000 rpm", "feed_per_tooth": "0.1 mm",
        "axial_depth": "2.5 mm", "radial_depth": "0.8 mm",
    },
    "structure": {
        "mode": [
            {"frequency": "922 Hz", "damping": 0.011, "mass": "0.03993 kg", "direction": [1, 0, 0]}
        ]
    },
}  # fmt: skip


def test_the_docs_hold_the_table_of_methods():
    assert documentation() in (ROOT / "docs" / "methods.md").read_text(encoding="utf-8")


def test_auto_takes_what_the_case_needs():
    case = Case.from_dict(CASE)
    assert chosen_method(case).name == "collocation"
    assert chosen_method(case.patch({"lobes.steps": 40})).name == "semi-discretization"
    held = case.patch({"contact": {"stiffness": "1e5 N/m", "damping": "5 N s/m"}})
    assert chosen_method(held).name == "matrix-free"


def test_a_former_name_is_read():
    case = Case.from_dict({**CASE, "lobes": {"method": "time"}})
    assert chosen_method(case).name == "time-domain"
    assert "time-domain" in case.notes[0]


def test_an_unknown_name_in_a_case_is_named_with_its_key():
    case = Case.from_dict({**CASE, "lobes": {"method": "magic"}}, name="a.toml")
    with pytest.raises(InputError, match=r'a\.toml: lobes\.method: .* "magic" is not'):
        chosen_method(case)


def test_an_unknown_name_is_refused_with_those_there_are():
    with pytest.raises(InputError, match=r'method "hugo" is not known; there are "collocation"'):
        chosen_method(Case.from_dict(CASE), "hugo")


def test_a_method_without_spectral_radius_leaves_it_to_collocation():
    for method in METHODS:
        assert with_radius(method).gives_radius
        assert (with_radius(method) is method) == method.gives_radius


@pytest.mark.parametrize(
    ("patch", "refuses"),
    [
        (
            {"cut.speed_variation": {"amplitude": 0.1, "frequency": "20 Hz", "shape": "sine"}},
            lambda method: not method.takes_varying_speed,
        ),
        ({"tool.pitch": ["170 deg", "190 deg"]}, lambda method: not method.takes_any_tool),
    ],
)
def test_methods_refuse_what_they_do_not_take(patch, refuses):
    model = milling_model(Case.from_dict(CASE).patch(patch))
    for method in filter(refuses, METHODS):
        with pytest.raises(InputError, match=method.name):
            method.limits(model, None, None, None, no_progress)
