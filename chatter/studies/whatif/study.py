"""A what-if study and its result."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chatter.description.errors import InputError
from chatter.description.progress import Progress, no_progress
from chatter.engine.parallel import Executor
from chatter.io.presentation import presentation
from chatter.io.result_files import as_json, write_results
from chatter.studies.whatif import summary as telling
from chatter.studies.whatif.design import AS_GIVEN, DesignPoint, Layout, chosen_layout, points_of
from chatter.studies.whatif.measures import Measure, Outcome, measure_of
from chatter.studies.whatif.points import Resumed, no_report, outcomes_of
from chatter.studies.whatif.variation import Variation, read_variation, variation

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.figure import Figure

    from chatter.studies.model import Model


@dataclass(frozen=True)
class WhatIf:
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

    model: Model
    variations: tuple[Variation, ...]
    layout: Layout
    measure: Measure
    quantity: str
    points: tuple[DesignPoint, ...]
    outcomes: tuple[Outcome, ...]

    @property
    def sentences(self) -> list[str]:
        """What changed, by how much."""
        return telling.sentences(self)

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
            "changes": self.sentences,
        }

    def plot(self) -> Figure:
        """Return the picture of the study as a matplotlib figure."""
        return presentation("plots.whatif").plot_whatif(self)

    def save(self, folder: str | Path) -> list[Path]:
        """Write whatif.csv, summary.json and whatif.png.

        Returns
        -------
        list of Path
            What was written.
        """
        texts = {"whatif.csv": self._table(), "summary.json": as_json(self.summary())}
        return write_results(folder, texts, {"whatif.png": self.plot()})

    def _table(self) -> str:
        """One row a point: values of the paths, then words and numbers."""
        words = list(dict.fromkeys(key for one in self.outcomes for key in one.words))
        numbers = list(dict.fromkeys(key for one in self.outcomes for key in one.numbers))
        text = StringIO()
        writer = csv.writer(text, lineterminator="\n")
        heads = [one.axis_label for one in self.variations]
        writer.writerow([*heads, *words, *numbers])
        for point, outcome in zip(self.points, self.outcomes, strict=True):
            given = [
                _cell(one, place) for one, place in zip(self.variations, point.places, strict=True)
            ]
            told = [outcome.words.get(key, "") for key in words]
            found = [outcome.numbers.get(key) for key in numbers]
            cells = ["" if one is None else f"{one:.9g}" for one in found]
            writer.writerow([*given, *told, *cells])
        return text.getvalue()


def _cell(one: Variation, place: int | None) -> str:
    if place is None:
        return AS_GIVEN
    if one.numbers is None:
        return one.values[place].label
    return f"{one.numbers[place]:.9g}"


def whatif(
    model: Model,
    vary: Mapping[str, Sequence[Any] | str] | Sequence[Variation | str],
    result: str | None = None,
    *,
    tornado: bool = False,
    count: int | None = None,
    quantity: str | None = None,
    method: str | None = None,
    only: Sequence[str] = (),
    folder: str | Path | None = None,
    progress: Progress = no_progress,
    resumed: Resumed = no_report,
    cluster: str | Executor | None = None,
) -> WhatIf:
    """Ask what would change if values of a case or machine were others.

    Parameters
    ----------
    model : Case or MachineFile
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
    folder : path, optional
        Keeps finished points in the result cache there, and reuses those of the same input.
    progress : callable, optional
        Called with (done, total) points.
    resumed : callable, optional
        Called once with (finished before, total) points.
    cluster : str or Executor, optional
        Where points are computed, as for `chatter.studies.executor.open_executor`; here by default.

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
    variations = _variations(model, vary, count)
    layout = chosen_layout(variations, tornado)
    measure = measure_of(result, model)
    shown = quantity or next(iter(measure.quantities))
    if shown not in measure.quantities:
        known = ", ".join(measure.quantities)
        raise InputError(f'--quantity "{shown}" is not known; {measure.name} has {known}')
    points = points_of(variations, layout)
    outcomes = outcomes_of(
        model, points, measure, method, tuple(only), folder, progress, resumed, cluster
    )
    return WhatIf(model, variations, layout, measure, shown, points, tuple(outcomes))


def _variations(
    model: Model,
    vary: Mapping[str, Sequence[Any] | str] | Sequence[Variation | str],
    count: int | None,
) -> tuple[Variation, ...]:
    if hasattr(vary, "items"):
        return tuple(
            read_variation(f"{path}={values}", model, count)
            if isinstance(values, str)
            else variation(path, list(values), model)
            for path, values in vary.items()
        )
    return tuple(
        one if isinstance(one, Variation) else read_variation(one, model, count) for one in vary
    )
