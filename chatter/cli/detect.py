"""`chatter detect RECORDING`: chatter or not over a recording, and what to do about it."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from chatter.cli import options
from chatter.cli.options_as_one import takes_options
from chatter.cli.progress import progress_bar, running
from chatter.cli.results import present
from chatter.description.errors import InputError
from chatter.report.console import answer_in_report, print_line, print_message, print_table

if TYPE_CHECKING:
    from chatter.description.case import Case
    from chatter.monitoring.result import DetectedChatter

#: verdicts whose reason is printed
_EXPLAINED = ("chatter", "not judged")


@dataclass(frozen=True)
class DetectOptions:
    """What `chatter detect` is given."""

    recording: Annotated[
        Path,
        typer.Argument(
            metavar="RECORDING",
            help="Sound, acceleration, force, displacement, current or power over time: WAV, CSV, "
            "XLSX, LVM, TDMS, MAT, NPZ, Parquet, UFF-58.",
        ),
    ]
    spindle_speed: Annotated[
        str | None,
        typer.Option("--spindle-speed", help='As set, such as "1656 rpm"; the lines refine it.'),
    ] = None
    teeth: Annotated[int | None, typer.Option("--teeth", help="Number of teeth.")] = None
    case: Annotated[
        Path | None,
        typer.Option("--case", help="Case of the cut: speed, teeth, mode, stable speeds."),
    ] = None
    channel: Annotated[
        list[str] | None,
        typer.Option("--channel", metavar="NAME", help="Column to use; repeatable."),
    ] = None
    sampling_rate: Annotated[
        str | None,
        typer.Option("--sampling-rate", help='Of a file without time, such as "25.6 kHz".'),
    ] = None
    columns: options.Columns = None
    follow: Annotated[
        bool,
        typer.Option(
            "--follow",
            help="Of a WAV or text file that is still being written: a line on stderr at every "
            "change; the whole recording at its end. Needs --spindle-speed or --case where the "
            "file has no tacho and no speed of the spindle.",
        ),
    ] = False
    sound_card: Annotated[
        str | None,
        typer.Option(
            "--sound-card",
            metavar="INPUT",
            help="With --follow: record this input (name, number or default) into RECORDING, a new "
            'WAV file, until Ctrl-C. Needs "chatter[sound]".',
        ),
    ] = None
    assignments: options.Assignments = None
    out: options.OutputFolder = None
    json: options.Json = False


@takes_options
def detect(options_: DetectOptions) -> None:
    """Detect chatter in a recording: segments, frequency, and the speeds to try."""
    case = None
    if options_.case is not None:
        case = options.patched_case(options_.case, options_.assignments)
    from chatter.io.formats.records import stem_of
    from chatter.monitoring.detect import detect as run_detect

    if options_.sound_card is not None and not options_.follow:
        raise InputError("--sound-card goes with --follow")
    if options_.follow:
        with _recorded(options_):
            _follow(options_, case)

    folder = options.output_folder(options_.out, stem_of(options_.recording))
    # the stable speeds of a case are computed by kernels, spectra are not
    shown = running if case is None else progress_bar
    with shown("spectra and verdicts"):
        found = run_detect(
            options_.recording,
            spindle_speed=options_.spindle_speed,
            teeth=options_.teeth,
            case=case,
            channels=tuple(options_.channel or ()),
            sampling_rate=options_.sampling_rate,
            columns=options_.columns,
        )
    present(found, folder, json=options_.json, words=_print_detection, notes=found.notes)


def _recorded(options_: DetectOptions) -> AbstractContextManager[None]:
    """Recording of the sound card where one is named."""
    if options_.sound_card is None:
        return nullcontext()
    from chatter.monitoring.detect import sampling_frequency
    from chatter.monitoring.sound_card import recorded

    rate = sampling_frequency(options_.sampling_rate)
    return recorded(options_.recording, options_.sound_card, rate)


def _follow(options_: DetectOptions, case: Case | None) -> None:
    """Print changes of the verdict until the file grows no more, or it is interrupted."""
    if options_.columns is not None:
        raise InputError("--columns is of a finished file; with --follow its heading names them")
    from chatter.monitoring.follow import follow

    verdict, told, corrected = "", False, False
    try:
        for one in follow(
            options_.recording,
            options_.spindle_speed,
            options_.teeth,
            tuple(options_.channel or ()),
            options_.sampling_rate,
            case=case,
        ):
            if one.verdict != verdict:
                verdict = one.verdict
                line = f", {one.chatter_frequency:.1f} Hz" if verdict == "chatter" else ""
                print_message(f"{one.time:.2f} s: {verdict}{line}")
            if one.speed_is_corrected and not corrected:
                corrected = True
                print_message(
                    f"{one.time:.2f} s: the spindle runs at {60.0 * one.spindle_frequency:.0f} rpm "
                    "by the spacing of its lines, and is taken to do so from here on"
                )
            if one.speed_is_refuted and not told:
                told = True
                print_message(
                    f"{one.time:.2f} s: the lines do not fit the spindle speed that is stated; "
                    "nothing is called stable until they do"
                )
    except KeyboardInterrupt:
        print_message("interrupted; what was written up to here follows")


def _print_detection(found: DetectedChatter) -> None:
    answer_in_report(found.headline)
    rows = [
        [
            f"{one['from_s']:.2f} to {one['to_s']:.2f}",
            one["verdict"],
            "" if one["chatter_frequency_Hz"] is None else f"{one['chatter_frequency_Hz']:.1f}",
            "" if one["bifurcation"] == "none" else one["bifurcation"],
            f"{one['confidence']:.2f}",
        ]
        for one in found.summary()["segments"]
    ]
    print_table(
        f"{found.recording.name}: {found.headline}",
        ["time [s]", "verdict", "chatter [Hz]", "bifurcation", "confidence"],
        rows,
    )
    for reason in dict.fromkeys(one.reason for one in found.segments if one.verdict in _EXPLAINED):
        print_line(reason)
    if found.advice is not None:
        for sentence in found.advice.sentences:
            print_line(sentence)
