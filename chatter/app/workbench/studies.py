"""Long computations of the views: the public call, the command that gives the same, its files."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import chatter
from chatter.app.workbench.page_words import in_words_of_the_page
from chatter.app.workbench.residual_file import RESIDUALS, write_residuals
from chatter.app.workbench.separate_process import Report
from chatter.app.workbench.session import (
    CaseText,
    forget_started,
    read_call,
    root_of_results,
    without_folder,
    write_call,
    write_started,
)
from chatter.description.errors import InputError
from chatter.description.progress import Progress
from chatter.explain.next_measurement.proposal import in_words as next_in_words
from chatter.report.parameters import parameter_row

#: files of a picture that a result draws beside the PNG that it saves
PICTURE = "picture.svg"
#: pages of a result of several that are shown
_MOST_PAGES = 4


class Study(NamedTuple):
    """A study of a case.

    Parameters
    ----------
    label, description : str
    options : mapping of str to object
        Name in Python -> default.
    compute : callable
        Called with the case, the options, the folder and a progress; returns a result.
    goes_on : bool
        Whether one that was ended goes on with what it has finished.
    """

    label: str
    description: str
    options: Mapping[str, Any]
    compute: Callable[[Any, Mapping[str, Any], Path, Progress], Any]
    goes_on: bool = True


def _sheet(case: Any, options: Mapping[str, Any], folder: Path, progress: Progress) -> Any:
    del options, folder
    return chatter.sheet(case, progress)


def _lobes(case: Any, options: Mapping[str, Any], folder: Path, progress: Progress) -> Any:
    return chatter.lobes(case, options.get("method") or None, False, progress, None, folder)


def _check(case: Any, options: Mapping[str, Any], folder: Path, progress: Progress) -> Any:
    del options, folder
    return chatter.check(case, None, progress)


def _optimum(case: Any, options: Mapping[str, Any], folder: Path, progress: Progress) -> Any:
    return chatter.optimum(case, progress=progress, folder=folder, **options)


def _pitch(case: Any, options: Mapping[str, Any], folder: Path, progress: Progress) -> Any:
    del options
    return chatter.pitch(case, progress, folder)


def _uncertainty(case: Any, options: Mapping[str, Any], folder: Path, progress: Progress) -> Any:
    given = dict(options)
    count = given.pop("count")
    return chatter.uncertainty(case, count, folder=folder, progress=progress, **given)


def _whatif(case: Any, options: Mapping[str, Any], folder: Path, progress: Progress) -> Any:
    given = {key: value for key, value in options.items() if value not in ("", None)}
    vary = [one.strip() for one in str(given.pop("vary", "")).splitlines() if one.strip()]
    if not vary:
        raise InputError(
            'vary: a path and its values are required, such as "cut.radial_depth=+-20%"'
        )
    return chatter.whatif(case, vary, folder=folder, progress=progress, **given)


STUDIES = {
    "check": Study("Check", "the stated cut: stable or not, and by how much", {}, _check, False),
    "lobes": Study("Lobes", "stability lobe diagram with pockets", {}, _lobes),
    "sheet": Study("Operator's sheet", "cuts worth making, as PDF and XLSX", {}, _sheet, False),
    "optimum": Study(
        "Optimum",
        "the cut with the highest removal rate within the limits of [optimum]",
        {"samples": 200, "seed": 1},
        _optimum,
    ),
    "pitch": Study("Pitch design", "pitch angles that raise the limit", {}, _pitch),
    "whatif": Study(
        "What if",
        "what would change if values were others; a path and its values a line",
        {"vary": "cut.radial_depth=+-20%", "result": "", "tornado": False},
        _whatif,
    ),
    "uncertainty": Study(
        "Uncertainty",
        'what values such as "1650 +- 80 MPa" make of the limits',
        {"count": 200, "seed": 1, "speeds": 121},
        _uncertainty,
    ),
}  # fmt: skip
#: name of an option in Python -> of the command line
OPTION_NAMES = {"count": "samples"}


def same_call(name: str, file: str, options: Mapping[str, Any]) -> dict[str, str]:
    """Command and Python call that give the same as a study of a case file."""
    words = ["chatter", name, file]
    for key, value in options.items():
        if value in ("", None, False):
            continue
        option = f"--{OPTION_NAMES.get(key, key)}"
        lines = str(value).splitlines() if key == "vary" else [str(value)]
        words += [option] if value is True else [part for one in lines for part in (option, one)]
    given = {key: value for key, value in options.items() if value not in ("", None, False)}
    if "vary" in given:
        given["vary"] = [one.strip() for one in given["vary"].splitlines() if one.strip()]
    listed = "".join(f", {key}={value!r}" for key, value in given.items())
    return {
        "command": shlex.join(words),
        "python": f"chatter.{name}(chatter.load({file!r}){listed})",
    }


def run_study(
    name: str, case: CaseText, options: Mapping[str, Any], folder: Path, report: Report
) -> None:
    """Compute a study and write its files; a study that was ended before goes on from there."""
    study = STUDIES[name]

    def progress(done: int, total: int) -> None:
        report(study.label, done / total if total else 0.0)

    report(f"{study.label}: starting", 0.0)
    write_started(folder)
    try:
        result = study.compute(case.case(), options, folder, progress)
        save_result(result, folder, {"title": study.label, **same_call(name, case.name, options)})
    finally:  # a process that is ended from outside does not come here
        forget_started(folder)


#: what is computed of a machine, and its heading
MACHINE_WORK = {"frf": "FRFs", "move": "Move", "mode_shapes": "Mode shapes"}


def run_machine(
    name: str,
    file: Path,
    call: Mapping[str, str],
    tests: Sequence[str],
    folder: Path,
    report: Report,
) -> None:
    """Compute FRFs, a move or the mode shapes of a machine file and write their files."""
    title = MACHINE_WORK[name]

    def progress(done: int, total: int) -> None:
        report(title, done / total if total else 0.0)

    report(f"{title}: starting", 0.0)
    machine = chatter.load_machine(file, file.relative_to(root_of_results(folder)).as_posix())
    if name == "frf":
        result: Any = chatter.frf(machine, list(tests) or None, progress)
    elif name == "move":
        result = chatter.move(machine, tests[0], progress)
    else:
        result = chatter.mode_shapes(machine)
    told = f"{title}: {', '.join(tests)}" if tests else title
    save_result(result, folder, {"title": told, **call})


def run_measurement(
    name: str,
    measurement: Path,
    case: CaseText | None,
    call: Mapping[str, str],
    folder: Path,
    report: Report,
) -> None:
    """Compare or explain a measurement and write the files of it."""  # fmt: skip
    given = None if case is None else case.case()
    report(f"{name}: reading the signals", 0.0)
    if name == "compare":
        result: Any = chatter.compare(measurement, given)
        sentences = result.sentences()
    else:
        result = chatter.explain(measurement, given, report, folder)
        sentences = explanation_in_words(result.summary())
    save_result(result, folder, {"title": name, **call})
    write_residuals(result, folder)
    write_call(folder, {**read_call(folder), "sentences": sentences})


#: errors of an explanation, in the words of the page
_ERRORS = {
    "declared": "of the declared case",
    "before": "refitted",
    "after": "with the effects",
    "holdout_before": "of runs that were not fitted, refitted",
    "holdout_after": "the same with the effects",
    "noise_floor": "of noise alone",
}
#: those that are the same as without where no effect was found
_WITH_EFFECTS = ("after", "holdout_after")


def explanation_in_words(summary: Mapping[str, Any]) -> list[str]:
    """Verdict, effects with their values, and what became of the error."""
    found = [f"verdict: {summary['verdict']}"]
    for effect in summary.get("effects", ()):
        found.append(
            f"{effect['name'].replace('_', ' ')} (probability {effect['probability']:.3g}): "
            f"{effect['description']}; {_values_of(effect)}"
        )
    partial = [f"{one['name'].replace('_', ' ')} (probability {one['probability']:.2g})"
               for one in summary.get("partial", ())]  # fmt: skip
    found += [f"may explain a part, not added: {', '.join(partial)}"] if partial else []
    error = summary.get("error") or {}
    told = [f"{words} {100.0 * error[key]:.3g} %" for key, words in _ERRORS.items()
            if isinstance(error.get(key), float)
            and (summary.get("effects") or key not in _WITH_EFFECTS)]  # fmt: skip
    found += [f"error of the prediction over the signal: {', '.join(told)}"] if told else []
    if summary.get("next_measurement"):
        found.append(next_in_words(summary["next_measurement"]))
    return found + [one["description"] for one in summary.get("checks", ())]


def _values_of(effect: Mapping[str, Any]) -> str:
    """Parameters of an effect in the units that people use, with their intervals."""
    rows = (parameter_row(key, one) for key, one in effect["parameters"].items())
    return ", ".join(
        f"{name.replace('_', ' ')} {value}{f' {unit}' if unit else ''} ({interval})"
        for name, value, unit, interval in rows
    )


def save_result(result: Any, folder: Path, call: Mapping[str, Any]) -> None:
    """Write the files of a result, its picture as SVG, and how it was made."""
    for stale in (
        *folder.glob("*.png"),
        *folder.glob("*.svg"),
        *folder.glob("*.csv"),
        *folder.glob(RESIDUALS),
    ):
        stale.unlink()
    result.save(folder)
    drawn = result.plot()
    if isinstance(drawn, (list, tuple)):
        for number, page in enumerate(drawn[:_MOST_PAGES], start=1):
            page.savefig(folder / f"page-{number}.png")
            page.savefig(folder / f"page-{number}.svg")
    else:
        drawn.savefig(folder / PICTURE)
    told = result.sentences() if hasattr(result, "sentences") else ()
    sentences = [in_words_of_the_page(one) for one in told]
    notes = [without_folder(one, root_of_results(folder)) for one in getattr(result, "notes", ())]
    write_call(folder, {**call, "sentences": sentences, "notes": notes})
