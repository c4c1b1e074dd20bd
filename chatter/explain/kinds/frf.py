"""FRFs at the tool point: idle, and while tool and workpiece touch."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from chatter.compile.structure import structure_of
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.explain.kinds.milling import structural_paths
from chatter.explain.measurement import Measurement, Run
from chatter.explain.selection.fitting import Parameter
from chatter.explain.selection.prior import tolerated
from chatter.explain.selection.problem import scaled_difference
from dynamics.modal.modes import receptance_matrix

IN_CUT = "in_cut"
_CHANNELS = ("real", "imag")
_AXES = "xyz"
#: lines over which the scatter is taken for one
_SMOOTHED = 31


class FrequencyResponse:
    """Receptances measured in one direction each."""

    name = "frf"
    #: the noise is known of every line
    noise_is_white = False

    def channels(self, run: Run) -> tuple[str, ...]:  # noqa: ARG002
        """Real and imaginary part."""
        return _CHANNELS

    def prepared(self, measurement: Measurement) -> Measurement:
        """Measurement with the scatter of its FRFs at every line.

        Raises
        ------
        InputError
            If a run lacks a channel or its direction.
        """
        runs = []
        for run in measurement.runs:
            missing = [name for name in ("frequency", *_CHANNELS) if name not in run.signals]
            if missing:
                raise InputError(f"{run.name}: column {', '.join(missing)} is missing")
            if not run.direction or any(axis not in _AXES for axis in run.direction):
                raise InputError(f'{run.name}: direction: "{run.direction}" is none; x, y, z or xy')
            alike = [
                other
                for other in measurement.runs
                if (other.condition, other.direction) == (run.condition, run.direction)
                and other.signals["real"].size == run.signals["real"].size
            ]
            scatter = _scatter(run, alike)
            runs.append(replace(run, signals={**run.signals, "certainty": 1.0 / scatter}))
        return replace(measurement, runs=tuple(runs))

    def noise_floor(self, measurement: Measurement, case: Case) -> float:  # noqa: ARG002
        """Scatter over the signals, as errors are told."""
        shares = {channel: [] for channel in _CHANNELS}
        for run in measurement.runs:
            scatter = float(np.sqrt(np.mean(run.signals["certainty"] ** -2.0)))
            for channel in _CHANNELS:
                level = float(np.sqrt(np.mean(run.signals[channel] ** 2)))
                shares[channel].append((scatter / level) ** 2)
        return float(np.mean([np.sqrt(np.mean(parts)) for parts in shares.values()]))

    def predict(self, case: Case, run: Run) -> Mapping[str, NDArray[np.float64]]:
        """Receptance of the modes, with the contact where the tool is in the cut."""
        frequency = run.signals["frequency"]
        free = receptance_matrix(structure_of(case).modes, frequency)
        if run.condition == IN_CUT and case.contact is not None:
            free = touching(free, frequency, case.contact.stiffness, case.contact.damping)
        response, force = _AXES.index(run.direction[0]), _AXES.index(run.direction[-1])
        values = free[:, response, force]
        return {"real": values.real, "imag": values.imag}

    def residuals(self, case: Case, run: Run, noise: Mapping[str, float]) -> NDArray[np.float64]:
        """Predicted less measured over the scatter."""
        plain = dict.fromkeys(noise, 1.0)
        left = scaled_difference(self, case, run, plain).reshape(2, -1)
        return (left * run.signals["certainty"]).ravel()

    def uncertain(self, measurement: Measurement) -> list[Parameter]:
        """Modal parameters."""
        return tolerated(measurement, structural_paths(measurement.case))


def touching(
    free: NDArray[np.complex128],
    frequency: NDArray[np.float64],
    stiffness: float,
    damping: float,
) -> NDArray[np.complex128]:
    """Receptance (m, 3, 3) with a spring and a damper between tool and work in x and y."""
    joint = np.zeros((frequency.size, 3, 3), dtype=np.complex128)
    for axis in range(2):
        joint[:, axis, axis] = stiffness + 2j * np.pi * frequency * damping
    return np.linalg.solve(np.eye(3) + free @ joint, free)


def _scatter(run: Run, alike: list[Run]) -> NDArray[np.float64]:
    """Standard deviation of real and imaginary part at every line, from repetitions."""
    values = np.array([one.signals["real"] + 1j * one.signals["imag"] for one in alike])
    if len(values) > 1:
        spread = np.sum(np.abs(values - values.mean(axis=0)) ** 2, axis=0) / (2 * (len(values) - 1))
    else:
        own = run.signals["real"] + 1j * run.signals["imag"]
        spread = np.abs(np.convolve(own, [1, -2, 1], mode="same")) ** 2 / 12.0
    relative = np.sqrt(spread) / np.abs(values.mean(axis=0))
    # noise of a hammer test is a share of the response, near enough the same over some lines
    padded = np.pad(relative, _SMOOTHED // 2, mode="reflect")
    windows = np.lib.stride_tricks.sliding_window_view(padded, _SMOOTHED)
    return np.sqrt(np.mean(windows**2, axis=1)) * np.abs(values.mean(axis=0))
