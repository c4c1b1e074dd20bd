"""`whatif`: a case or machine with values changed, the points of the study, and its result."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from chatter.description.case import Case
from chatter.description.errors import InputError, RunError
from chatter.description.given_values import text_given, values_given
from chatter.description.unit_system import METRIC, UnitSystem, units_of
from chatter.io.result_files import SavedResult
from chatter.io.result_tables import Column, Columns
from chatter.studies.model import fingerprint, model_or_read, patched
from chatter.studies.result_cache import Execution, ResultCache
from chatter.studies.whatif.design import AS_GIVEN, DesignPoint, Layout, chosen_layout, points_of
from chatter.studies.whatif.measures import Curve, Measure, Outcome, measure_of
from chatter.studies.whatif.summary import sentences
from chatter.studies.whatif.variation import Variation, read_variation, variation

if TYPE_CHECKING:
    from collections.abc import Mapping

    from typing_extensions import Unpack

    from chatter.studies.model import Model


@dataclass(frozen=True, repr=False)
class WhatIf(SavedResult):
    """Result of a study.

    Parameters
    ----------
    model : Case or MachineFile
        As given.
    variations : tuple of Variation
    layout : {"overlay", "heat map", "tornado"}
    measure : Measure
    quantity : str
        Key of the number that is shown.
    points : tuple of DesignPoint
        A tornado begins with the model as given, then low and high of each path.
    outcomes : tuple of Outcome
    """

    drawn_by: ClassVar[str] = "plots.whatif.plot_whatif"
    picture: ClassVar[str] = "whatif.png"

    model: Model
    variations: tuple[Variation, ...]
    layout: Layout
    measure: Measure
    quantity: str
    points: tuple[DesignPoint, ...]
    outcomes: tuple[Outcome, ...]

    @property
    def units(self) -> UnitSystem:
        """Units that the words and the picture are in: those of the case, metric of a machine."""
        return units_of(self.model) if isinstance(self.model, Case) else METRIC

    def sentences(self) -> list[str]:
        """What changed, by how much."""
        return sentences(self)

    def values(self, key: str | None = None) -> list[float | None]:
        """Number of a key at every point; that which is shown by default."""
        return [outcome.numbers.get(key or self.quantity) for outcome in self.outcomes]

    def summary(self) -> dict:
        """Return the content of summary.json."""
        return {
            "title": self.model.title,
            "result": self.measure.name,
            "layout": self.layout,
            "quantity": self.quantity,
            "paths": {one.path: [value.label for value in one.values] for one in self.variations},
            "points": [
                {
                    "values": dict(
                        zip((one.path for one in self.variations), point.labels, strict=True)
                    ),
                    **outcome.words,
                    **outcome.numbers,
                    **({"failure": outcome.failure} if outcome.failure else {}),
                }
                for point, outcome in zip(self.points, self.outcomes, strict=True)
            ],
            "changes": self.sentences(),
        }

    def tables(self) -> dict[str, Columns]:
        """Columns of the table "whatif", a row a point: values, then words and numbers."""
        words = list(dict.fromkeys(key for one in self.outcomes for key in one.words))
        numbers = list(dict.fromkeys(key for one in self.outcomes for key in one.numbers))
        places = zip(*(point.indices for point in self.points), strict=True)
        varied = {
            one.axis_label: Column([_value(one, index) for index in indices], ".9g")
            for one, indices in zip(self.variations, places, strict=True)
        }
        found = {key: Column([one.words.get(key, "") for one in self.outcomes]) for key in words}
        computed = {key: Column(self.values(key), ".9g", infinite="inf") for key in numbers}
        return {"whatif": {**varied, **found, **computed}}


def _value(one: Variation, index: int | None) -> str | float:
    if index is None:
        return AS_GIVEN
    return one.values[index].label if one.numbers is None else one.numbers[index]


def whatif(
    model: Model | str | Path,
    vary: Mapping[str, Sequence[Any] | str] | Sequence[Variation | str],
    result: str | None = None,
    *,
    tornado: bool = False,
    count: int | None = None,
    quantity: str | None = None,
    method: str | None = None,
    only: Sequence[str] = (),
    **execution: Unpack[Execution],
) -> WhatIf:
    """Ask what would change if values of a case or machine were others.

    Parameters
    ----------
    model : Case or MachineFile, or the path of its file
        Paths into the machine of a case begin with "machine.".
    vary : mapping of str to values, or sequence of str
        Path -> values (text with units, numbers in SI, None to take a key away), or texts as on
        the command line: "PATH=v1,v2", "PATH=from..to", "PATH=+-10%".
    result : {"lobes", "critical depth", "forces", "surface", "frf"}, optional
        Lobes of a case, FRFs of a machine by default.
    tornado : bool
        One path at a time, each at its first and last value, against the model as given. By
        default one path gives an overlay and two a heat map.
    count : int, optional
        Values of ranges; 5 by default.
    quantity : str, optional
        Key of the number that is shown.
    method : str, optional
        Of stability, as for `chatter.lobes`.
    only : sequence of str
        Names of [frf.NAME] of a machine.
    **execution
        Folder, progress, resumed and cluster, as `chatter.studies.result_cache.Execution`.

    Returns
    -------
    WhatIf

    Raises
    ------
    InputError
        If a path or value is wrong, or nothing can be computed.
    RunError
        If every run fails, or the study is interrupted; finished points are in the folder.
    """
    model = model_or_read(model)
    variations = _variations(model, vary, count)
    layout = chosen_layout(variations, tornado)
    measure = measure_of(result, model)
    if quantity and quantity not in measure.quantities:
        known = ", ".join(measure.quantities)
        raise InputError(f'--quantity "{quantity}" is not known; {measure.name} has {known}')
    points = points_of(variations, layout)
    models = _models_of(model, points)
    evaluate = partial(_record, measure.name, method, tuple(only))
    with ResultCache(execution.get("folder"), measure.name, method or "", ",".join(only)) as cache:
        keys = [cache.key(fingerprint(each)) for each in models]
        records = cache.evaluate(evaluate, models, keys, "points", **execution)
    if all(record["failure"] for record in records):
        messages, failure = records[0]["input_errors"], records[0]["failure"]
        raise InputError(messages) if messages else RunError(failure)
    outcomes = tuple(_outcome(record) for record in records)
    key = quantity or _first_known(measure, outcomes)
    return WhatIf(model, variations, layout, measure, key, points, outcomes)


def _first_known(measure: Measure, outcomes: Sequence[Outcome]) -> str:
    """First quantity that some point has, or that lies beyond what was searched."""
    for key, quantity in measure.quantities.items():
        if quantity.beyond or any(one.numbers.get(key) is not None for one in outcomes):
            return key
    return next(iter(measure.quantities))


def _models_of(model: Model, points: Sequence[DesignPoint]) -> list[Model]:
    """Model of each point; InputError with what is wrong with each of them, once."""
    models: list[Model] = []
    problems: dict[str, None] = {}
    for point in points:
        try:
            models.append(patched(model, point.patch))
        except InputError as error:
            problems |= dict.fromkeys(error.messages)
    if problems:
        raise InputError(list(problems))
    return models


def _record(
    measure: str, method: str | None, only: tuple[str, ...], model: Model
) -> dict[str, Any]:
    """Record of a point, with what is wrong with its input."""
    messages: tuple[str, ...] = ()
    try:
        outcome = measure_of(measure, model).evaluate(model, method, only)
    except InputError as error:
        outcome, messages = Outcome(failure=str(error)), error.messages
    except RunError as error:
        outcome = Outcome(failure=str(error))
    return {**asdict(outcome), "input_errors": messages}


def _outcome(record: dict[str, Any]) -> Outcome:
    curves = tuple(Curve(**curve) for curve in record["curves"])
    return Outcome(record["numbers"], record["words"], curves, record["failure"], record["units"])


def _variations(
    model: Model,
    vary: Mapping[str, Sequence[Any] | str] | Sequence[Variation | str],
    count: int | None,
) -> tuple[Variation, ...]:
    if hasattr(vary, "items"):
        return tuple(
            read_variation(f"{path}={values}", model, count)
            if isinstance(values, str)
            else variation(path, values_given(values, f"--vary {path}: values"), model)
            for path, values in vary.items()
        )
    given = [vary] if isinstance(vary, str) else values_given(vary, "--vary: variations")
    return tuple(
        one
        if isinstance(one, Variation)
        else read_variation(text_given(one, "--vary: PATH=VALUES"), model, count)
        for one in given
    )
