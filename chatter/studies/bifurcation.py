"""Bifurcation diagram: Poincaré sections of simulated cuts over a value of the case."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from chatter.description.arrays import Array
from chatter.description.brief_repr import BriefRepr
from chatter.description.case import Case
from chatter.description.case_or_path import takes_case_or_path
from chatter.description.errors import InputError
from chatter.description.given_values import text_given, values_given
from chatter.description.unit_system import UnitSystem, units_of
from chatter.io.result_files import SavedResult, finite_or_none
from chatter.io.result_tables import Column, Columns
from chatter.simulation.perturbation.multiplier import periods_per_revolution
from chatter.simulation.setup import set_up
from chatter.simulation.simulate import run_setup
from chatter.simulation.structure_in_time import modes_of
from chatter.simulation.verdict import with_verdict
from chatter.studies.executor import ThreadExecutor
from chatter.studies.linear_limits import (
    NO_LIMITS,
    LinearLimits,
    Simulated,
    linear_limits,
    spectral_radius_or_nan,
)
from chatter.studies.model import fingerprint
from chatter.studies.parameter_axis import axis_of
from chatter.studies.result_cache import Execution, ResultCache
from dynamics.modal.modes import Mode

if TYPE_CHECKING:
    from typing_extensions import Unpack

#: cuts of a range that gives no number
DEFAULT_CUTS = 60
#: revolutions of every cut, and those at its end that are kept
_REVOLUTIONS = 200.0
_KEPT_REVOLUTIONS = 60


@dataclass(frozen=True, repr=False)
class BifurcationPoint(BriefRepr):
    """One cut of the diagram."""

    value: float  # of the path that varies, SI
    #: displacement when a tooth is at +y, m, over the last revolutions: every tooth of a uniform
    #: tool, else the first one; empty where the tool left the range of the model (k, 3)
    poincare_section: Array
    verdict: str  # "stable" or "chatter"
    bifurcation: str
    chatter_frequency: float  # Hz; nan where there is none
    spectral_radius: float = math.nan  # by the linear analysis; nan where it does not take the cut

    @property
    def is_complete(self) -> bool:
        """Whether the tool stayed within the range of the model."""
        return len(self.poincare_section) > 0


@dataclass(frozen=True, repr=False)
class BifurcationDiagram(SavedResult):
    """Points of all cuts.

    Parameters
    ----------
    case : Case
    path : str
        Dotted path of the value that varies.
    points : tuple of BifurcationPoint
    linear : LinearLimits
        Limits of the linear analysis over the same values, and where the cuts say otherwise.
    """

    drawn_by: ClassVar[str] = "plots.bifurcation.plot_bifurcation"
    picture: ClassVar[str] = "bifurcation.png"

    case: Case
    path: str
    points: tuple[BifurcationPoint, ...]
    linear: LinearLimits = NO_LIMITS

    @property
    def units(self) -> UnitSystem:
        """Units that the words and the picture are in: those of the case."""
        return units_of(self.case)

    def summary(self) -> dict:
        """Return the content of summary.json."""
        return {
            "title": self.case.title,
            "path": self.path,
            "points": [
                {
                    "value": point.value,
                    "verdict": point.verdict,
                    "bifurcation": point.bifurcation,
                    "chatter_frequency_Hz": finite_or_none(point.chatter_frequency),
                    "spread_um": finite_or_none(_spread(point) * 1e6),
                    "spectral_radius": finite_or_none(point.spectral_radius),
                }
                for point in self.points
            ],
            "linear_analysis": self.linear.summary(),
        }

    def tables(self) -> dict[str, Columns]:
        """Columns of the table "bifurcation", a row a point of a Poincaré section."""
        counts = [len(one.poincare_section) for one in self.points]
        displacement = np.concatenate(
            [np.empty((0, 3)), *(one.poincare_section for one in self.points)]
        )
        values, verdicts = (
            np.repeat([getattr(one, name) for one in self.points], counts)
            for name in ("value", "verdict")
        )
        return {
            "bifurcation": {
                f"{self.path} [SI]": Column(values, ".9g"),
                **{
                    f"{axis} [um]": Column(1e6 * along, ".6g")
                    for axis, along in zip("xyz", displacement.T, strict=True)
                },
                "verdict": Column(verdicts.tolist()),
            }
        }


@takes_case_or_path
def bifurcation(
    case: Case, path: str, values: Sequence[Any] | str, **execution: Unpack[Execution]
) -> BifurcationDiagram:
    """Simulate a case over the values of one of its keys.

    Parameters
    ----------
    case : Case
        Runs are 200 revolutions long where `[simulation]` does not say.
    path : str
        Dotted path, such as "cut.axial_depth" or "cut.spindle_speed".
    values : sequence or str
        Quantities as text, or numbers in SI; or a range as on the command line, such as
        "1 mm..4 mm:60".
    **execution
        Folder, progress, resumed and cluster, as `chatter.studies.result_cache.Execution`.

    Returns
    -------
    BifurcationDiagram

    Raises
    ------
    InputError
        If there are no values, or a patched case is wrong.
    RunError
        If the study is interrupted; finished cuts are in the folder.
    """
    path = text_given(path, "the path of what changes")
    if isinstance(values, str):
        axis = axis_of(f"{path}={values}", case, "values", DEFAULT_CUTS)
        values = [one.patch[axis.path] for one in axis.values]
    values = values_given(values, f"{case.name}: {path}: values")
    if not values:
        raise InputError(f"{case.name}: {path}: no values are given for the bifurcation diagram")
    if not (case.simulation and (case.simulation.revolutions or case.simulation.duration)):
        case = case.patch({"simulation.revolutions": _REVOLUTIONS})
    cases = _patched(case, path, values)
    on_machine = case.structure is not None and case.structure.machine is not None
    modes = None if on_machine or path.startswith("structure") else modes_of(case)[0]
    if modes == ():
        raise InputError(f"{case.name}: [structure] is missing; a rigid tool does not vibrate")
    if execution.get("cluster") is None:
        execution["cluster"] = ThreadExecutor()
    with ResultCache(execution.get("folder"), "bifurcation", path) as cache:
        keys = [cache.key(fingerprint(one)) for one in cases]
        records = cache.evaluate(partial(_record, path, modes), cases, keys, "cuts", **execution)
    points = [
        BifurcationPoint(**{**one, "poincare_section": _section(one["poincare_section"])})
        for one in records
    ]
    cuts = [Simulated(point.value, point.verdict, point.spectral_radius) for point in points]
    return BifurcationDiagram(case, path, tuple(points), linear_limits(case, path, cuts))


def _patched(case: Case, path: str, values: Sequence[Any]) -> list[Case]:
    """Case with each of the values; InputError with what is wrong with each of them, once."""
    cases: list[Case] = []
    problems: dict[str, None] = {}
    for value in values:
        try:
            cases.append(case.patch({path: value}))
        except InputError as error:
            problems |= dict.fromkeys(error.messages)
    if problems:
        raise InputError(list(problems))
    return cases


def _record(path: str, modes: tuple[Mode, ...] | None, case: Case) -> dict[str, Any]:
    """Cut of a case as the result cache keeps it."""
    point = asdict(_point(case, path, modes))
    point["spectral_radius"] = spectral_radius_or_nan(case)
    return {**point, "poincare_section": point["poincare_section"].tolist()}


def _section(rows: list[list[float]]) -> Array:
    return np.array(rows, dtype=np.float64).reshape(-1, 3)


def _point(case: Case, path: str, modes: tuple[Mode, ...] | None) -> BifurcationPoint:
    result, _ = run_setup(set_up(case, modes))
    value = float(case.get(path))
    if not result.complete:
        return BifurcationPoint(value, np.zeros((0, 3)), "chatter", "unknown", math.nan)
    detection = with_verdict(result).detection
    a_turn = periods_per_revolution(result.setup)
    periods = np.arange(math.floor(result.revolutions * a_turn) + 1) / a_turn
    kept = 2.0 * math.pi * periods[-_KEPT_REVOLUTIONS * a_turn :]
    points = np.stack(
        [np.interp(kept, result.spindle_angle, column) for column in result.displacement.T], axis=1
    )
    if detection is None:
        return BifurcationPoint(value, points, "not judged", "unknown", math.nan)
    return BifurcationPoint(
        value, points, detection.verdict, detection.bifurcation, detection.chatter_frequency
    )


def _spread(point: BifurcationPoint) -> float:
    """Largest extent of the Poincaré section, m; nan where the tool left the range of the model."""
    if not point.is_complete:
        return math.nan
    return float(np.ptp(point.poincare_section, axis=0).max())
