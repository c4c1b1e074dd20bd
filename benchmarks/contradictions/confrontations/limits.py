"""Critical depth by the linear methods, and verdicts of simulated cuts beside it."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.contradictions.confrontation import (
    Comparison,
    Confrontation,
    Document,
    PremiseFailsError,
    relative,
)
from benchmarks.contradictions.confrontations.multipliers import draw_vibrating
from benchmarks.contradictions.numbers import (
    critical_depths,
    refuse_large_vibration,
    spectral_radius,
)
from chatter.description.case import Case
from chatter.simulation.simulate import simulate
from chatter.stability.model import milling_model

#: default tolerance of limits, and what the truncated harmonics of multi-frequency leave
_TOLERANCE, _TRUNCATION = 1e-3, 2e-3
#: cuts are simulated at these shares of the limit
_SHARES = (0.9, 1.1)
#: growth over a revolution that is none
_NO_GROWTH = 2e-3


def compare_limits(document: Document) -> list[Comparison]:
    """First limit by collocation, matrix-free, multi-frequency, and semi-discretization."""
    model = milling_model(Case.from_dict(document))
    methods = ["collocation", "matrix-free"]
    if model.cutter.is_cylindrical:
        methods.append("multi-frequency")
    if model.is_uniform:
        methods.append("semi-discretization")
    found = critical_depths(model, methods)
    one, error = found.pop("collocation")
    compared = []
    for name, (other, own) in found.items():
        share = error + own + (_TRUNCATION if name == "multi-frequency" else _TOLERANCE)
        compared.append(relative(f"critical depth ({name}), mm", 1e3 * one, 1e3 * other, share))
    return compared


LIMITS = Confrontation(
    name="limits by methods",
    ways="collocation; matrix-free; multi-frequency of cylindrical tools; semi-discretization of "
    "uniform end mills",
    stated="their stated errors and the tolerance of 0.1 %, 0.2 % for multi-frequency, whose "
    "harmonics end",
    weight=1.0,
    draw=draw_vibrating,
    compare=compare_limits,
)


def draw_to_simulate(rng: np.random.Generator) -> Document:
    """A vibrating cut whose simulation takes seconds."""
    sections = draw_vibrating(rng)
    for mode in sections["structure"]["mode"]:
        mode["damping"] = max(mode["damping"], 0.015)
    return sections


def compare_verdicts(document: Document) -> list[Comparison]:
    """Verdict of simulated cuts at 0.9 and 1.1 of the limit, as a spectral radius beside 1."""
    case = Case.from_dict(document)
    limit, _ = critical_depths(milling_model(case), ["collocation"])["collocation"]
    if not math.isfinite(limit):
        raise PremiseFailsError("there is no limit down to the maximum axial depth searched")
    found = []
    for share in _SHARES:
        deep = case.patch({"cut.axial_depth": share * limit})
        refuse_large_vibration(deep)
        radius, _ = spectral_radius(deep)
        if abs(math.log(radius)) < _NO_GROWTH:
            continue
        result = simulate(deep)
        if result.detection is None:
            raise PremiseFailsError(f"not judged: {result.why_no_verdict}")
        if result.detection.verdict == "not judged":
            raise PremiseFailsError(f"not judged: {result.detection.reason}")
        simulated = 1.0 if result.detection.verdict == "chatter" else 0.0
        found.append(
            Comparison(f"chatter at {share} of the limit", simulated, float(radius > 1.0), 0.5)
        )
    return found


VERDICTS = Confrontation(
    name="verdicts at 0.9 and 1.1 of the limit",
    ways="chatter detection on the simulated cut; collocation",
    stated="the same verdict, where the product does not note that forced vibration makes teeth "
    "miss",
    weight=0.6,
    draw=draw_to_simulate,
    compare=compare_verdicts,
)
