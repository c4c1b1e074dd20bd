"""A recording that is still being written: a verdict every revolution, as it grows."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from chatter.description.case import Case, load
from chatter.description.errors import InputError
from chatter.detection.spectral.running_detection import Observation, RunningDetection
from chatter.monitoring.detect import sampling_frequency, spindle_frequency, teeth_of
from chatter.monitoring.growing_file import growing_file

#: s after which the file is read again
_EVERY = 0.01
#: s without growth after which a file is finished
DEFAULT_PATIENCE = 5.0


def follow(
    path: str | Path,
    spindle_speed: str | float | None = None,
    teeth: int | None = None,
    channels: Sequence[str] = (),
    sampling_rate: str | float | None = None,
    patience: float = DEFAULT_PATIENCE,
    clock: Callable[[], float] = time.monotonic,
    case: str | Path | Case | None = None,
) -> Iterator[Observation]:
    """Observe chatter in a file that is being written, once a revolution.

    Above 3000 rpm it is once in 20 ms. Each verdict is of the last 24 revolutions, a quarter of a
    second at the least. A sample is part of one as soon as the revolution, or the 20 ms, ends in
    which it was written.

    Parameters
    ----------
    path : path
        WAV, or a table in text that grows by lines.
    spindle_speed : str or float
        As for `detect`; by default of the case, or of a measured speed in the file. Right within
        12 %; the lines correct what is more than 1.5 % off. The pulses of a tacho in the file show
        it at every moment.
    teeth, channels, sampling_rate
        As for `detect`.
    patience : float
        s without growth after which the file is finished.
    clock : callable
        s, that never goes back.
    case : path or Case, optional
        For the speed and the teeth where they are not given.

    Raises
    ------
    InputError
        If the file cannot be followed, or a value is wrong.
    """
    if isinstance(case, (str, Path)):
        case = load(case)
    frequency = spindle_frequency(spindle_speed, case)
    teeth = teeth_of(teeth, case)
    file = growing_file(Path(path), channels, sampling_frequency(sampling_rate))
    if frequency is None:
        frequency = file.start.spindle_frequency
    if frequency is None and file.start.tacho is None:
        raise InputError(
            "--follow needs --spindle-speed, such as 1656 rpm, or --case, where the file has no "
            "tacho and no speed of the spindle"
        )
    running = RunningDetection(file.start, frequency, teeth)
    grown = clock()
    while clock() - grown < patience:
        samples = file.new_samples()
        if len(samples):
            yield from running.take(samples)
            # after the verdicts: what they take is no time without growth
            grown = clock()
        else:
            time.sleep(_EVERY)
