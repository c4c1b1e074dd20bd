"""The hunt for contradictions: its quadrature, its bookkeeping, a small share of its cases."""

import dataclasses
import json
import math

import numpy as np
import pytest
import tomlkit

from benchmarks.contradictions.confrontation import Comparison, PremiseFailsError
from benchmarks.contradictions.confrontation_list import CONFRONTATIONS, by_name
from benchmarks.contradictions.edge_quadrature import RigidCut
from benchmarks.contradictions.hunt import read_results, table, tasks_of, write_finding
from benchmarks.contradictions.one_case import Judged, drawn, judged
from chatter import Case
from chatter.description.errors import InputError

#: seed and cases of the share: kernels of the loop and of collocation alone, so that it is quick
SEED, SHARE = 2026, {"up and down by turned structures": 25}


def straight(**cut):
    return Case.from_dict(
        {
            "tool": {"teeth": 2, "diameter": "20 mm", "helix": "30 deg"},
            "material": {"Ktc": "700 MPa", "Krc": "250 MPa", "Kac": "100 MPa", "Kte": "20 N/mm"},
            "cut": {
                "mode": "up",
                "spindle_speed": "3000 rpm",
                "feed_per_tooth": "0.1 mm",
                "axial_depth": "3 mm",
                "radial_depth": "5 mm",
                **cut,
            },
        }
    )


def test_quadrature_of_a_cylinder_is_the_closed_form_of_the_mean():
    # Altintas 2012, section 2.5: integrals of the linear law over the arc, depth N/(2 pi)
    arc = math.acos(0.5)
    share = 3e-3 * 2 / (2.0 * math.pi)
    feed, s, c = 1e-4, math.sin(arc), math.cos(arc)
    ss, sc = 0.5 * arc - 0.25 * math.sin(2.0 * arc), 0.5 * s * s
    fx = -7e8 * feed * sc - 2e4 * s - 2.5e8 * feed * ss
    fy = 7e8 * feed * ss + 2e4 * (1.0 - c) - 2.5e8 * feed * sc
    fz = 1e8 * feed * (1.0 - c)
    torque = 10e-3 * (7e8 * feed * (1.0 - c) + 2e4 * arc)
    expected = share * np.array([fx, fy, fz, torque])
    rigid = RigidCut(straight())
    np.testing.assert_allclose(rigid.mean(), expected, rtol=1e-4)
    angles = 2.0 * math.pi * (np.arange(4000) + 0.5) / 4000
    np.testing.assert_allclose(rigid.at(angles).mean(axis=1), expected, rtol=1e-3)


@pytest.mark.parametrize("confrontation", CONFRONTATIONS, ids=lambda one: one.name)
def test_draws_are_cases_that_the_product_reads_and_come_from_seed_and_number(confrontation):
    documents = [drawn(confrontation, SEED, number) for number in range(20)]
    assert documents[3] == drawn(confrontation, SEED, 3)
    assert documents[3] != documents[4]
    for document in documents:
        written = tomlkit.parse(tomlkit.dumps(document)).unwrap()
        assert confrontation.reads(written) is not None


def test_tasks_follow_the_weights():
    tasks = list(tasks_of(CONFRONTATIONS, 1, 500))
    whole = sum(one.weight for one in CONFRONTATIONS)
    assert len(set(tasks)) == 500
    for one in CONFRONTATIONS:
        own = sum(task[0] == one.name for task in tasks)
        assert abs(own - 500 * one.weight / whole) <= 1.0


def test_every_outcome_is_told_apart():
    one = CONFRONTATIONS[0]

    def by(compare):
        return judged(dataclasses.replace(one, compare=compare), 1, 0)

    def raising(error):
        def compare(document):
            raise error

        return compare

    assert by(lambda document: [Comparison("a", 1.0, 1.001, 0.01)]).outcome == "agrees"
    assert by(lambda document: [Comparison("a", 1.0, 1.1, 0.01)]).outcome == "disagrees"
    assert by(lambda document: [Comparison("a", math.nan, 1.0, 1.0)]).outcome == "disagrees"
    assert by(lambda document: [Comparison("a", math.inf, math.inf, 0.1)]).outcome == "agrees"
    assert by(raising(PremiseFailsError("teeth miss"))).reason == "teeth miss"
    assert by(raising(InputError("no"))).outcome == "refused"
    assert by(raising(ZeroDivisionError("x"))).outcome == "failed"


def test_a_finding_is_a_case_file_with_its_numbers(tmp_path):
    compared = {"quantity": "F, N", "one": 1.0, "other": 2.0, "allowed": 0.1, "excess": 10.0}
    found = Judged(CONFRONTATIONS[0].name, 1, 7, "disagrees", compared=[compared])
    path = write_finding(tmp_path, found)
    text = path.read_text(encoding="utf-8")
    assert "F, N: 1 and 2, 10 times what is allowed" in text
    assert Case.from_file(path).cut is not None
    (tmp_path / "results.jsonl").write_text(json.dumps(found.as_dict()) + "\n", encoding="utf-8")
    assert read_results(tmp_path) == [found]
    assert f"| {found.confrontation} | 1 | 0 | 1 |" in table([found])


@pytest.mark.parametrize(("name", "count"), SHARE.items())
def test_a_small_share_agrees(name, count):
    for number in range(count):
        found = judged(by_name(name), SEED, number)
        assert found.outcome in ("agrees", "refused", "premise"), found
