"""FRFs at the tool point: idle, and while tool and workpiece touch."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from chatter.compile.machine_response import STATES, MachineState, machine_response
from chatter.compile.structure import structure_of
from chatter.description.case import MACHINE_PATH, Case
from chatter.description.errors import InputError
from chatter.description.sections.tool import Tool
from chatter.explain.criteria import (
    LEAST_GAIN,
    LEAST_GAIN_SHARE_OF_FRFS,
    LEAST_SHARE_IN_PART_OF_FRFS,
)
from chatter.explain.data_checks.finding import SignalFinding
from chatter.explain.data_checks.responses import disagreeing_responses, wrong_responses
from chatter.explain.data_checks.samples import Columns, sample_checks
from chatter.explain.kinds.kind import Array, Deviation, Kind, Signals, of_sections
from chatter.explain.kinds.milling import structural_paths
from chatter.explain.kinds.same_case import OfSameCase
from chatter.explain.measurement import Measurement, Run
from chatter.explain.parameters import Parameter, with_priors, within_reach
from chatter.explain.records.response_delay import without_delay
from chatter.explain.records.response_scatter import repetitions_of, scatter
from chatter.explain.residuals.over_lines import by_condition, over_lines
from dynamics.modal.modes import receptance_matrix

IN_CUT = "in_cut"
#: between what is read and what is excited, as measurement.toml gives them
_BETWEEN = ", "
_CHANNELS = ("real", "imag")
_AXES = "xyz"
#: cases without what an FRF does not depend on, and receptances, that are kept
_KEPT = 48


@dataclass(frozen=True, eq=False)
class FrfRecord:
    """Standard deviation (m,) of real and imaginary part at every line, m/N."""

    scatter: Array


class FrequencyResponse(Kind):
    """Receptances measured in one direction each."""

    name = "frf"
    sections = ("structure",)
    columns = (("frequency",), ("real",), ("imag",))
    estimates_noise = False
    least_gain = (LEAST_GAIN, LEAST_GAIN_SHARE_OF_FRFS)
    least_share_in_part = LEAST_SHARE_IN_PART_OF_FRFS
    diagnostics = (by_condition, over_lines)
    checks = (
        sample_checks(Columns(_CHANNELS, needed=_CHANNELS)),
        (wrong_responses,),
        (disagreeing_responses,),
    )

    def __init__(self) -> None:
        self._reduced: OfSameCase[Case] = OfSameCase(_KEPT)
        self._responses: OfSameCase[Signals] = OfSameCase(_KEPT)

    def channels(self, run: Run) -> tuple[str, ...]:
        """Real and imaginary part."""
        return _CHANNELS

    def as_recorded(self, measurement: Measurement) -> tuple[Measurement, list[SignalFinding]]:
        """FRFs without the delay between the channels of force and response."""
        return without_delay(measurement)

    def prepared(self, measurement: Measurement) -> Measurement:
        """Return the measurement with the scatter of its FRFs at every line.

        Raises InputError if a run lacks its direction.
        """
        runs = []
        for run in measurement.runs:
            _refuse_unknown_place(measurement.case, run)
            runs.append(
                replace(run, record=FrfRecord(scatter(run, repetitions_of(run, measurement.runs))))
            )
        return measurement.with_runs(runs)

    def predict(self, case: Case, run: Run) -> Signals:
        """Receptance of the modes or the machine, with the contact where the tool is in the cut."""
        frequency = run.signals["frequency"]
        if case.on_machine:
            measured = run.condition, run.direction, frequency.tobytes()
            return self._responses.of(case, measured, lambda: _of_machine(case, run))
        free = receptance_matrix(structure_of(case).modes, frequency)
        if run.condition == IN_CUT and case.contact is not None:
            free = touching(free, frequency, case.contact.stiffness, case.contact.damping)
        response, force = _AXES.index(run.direction[0]), _AXES.index(run.direction[-1])
        values = free[:, response, force]
        return {"real": values.real, "imag": values.imag}

    def reduced(self, case: Case, run: Run) -> Case:
        """Return the structure; of a machine that moves its feed, and in the cut the contact."""
        state = STATES.get(run.condition) if case.on_machine else None
        if state is None:
            return case
        return self._reduced.of(case, state, lambda: self._in_state(case, state))

    def _in_state(self, case: Case, state: MachineState) -> Case:
        sections = {*self.sections}
        if state.in_cut:
            sections.add("contact")
        alone = of_sections(case, sections)
        return alone.model_copy(update=_feed_of(case)) if state.moving else alone

    def residuals(self, run: Run, predicted: Signals, noise: Mapping[str, float]) -> Array:
        """Predicted less measured over the scatter of every line."""
        own = run.record.scatter
        return np.concatenate(
            [
                (predicted[channel] - run.signals[channel]) * (run.weight(channel) / own)
                for channel in _CHANNELS
            ]
        )

    def deviation(
        self, run: Run, channel: str, measured: Array, predicted: Array, level: float | None
    ) -> Deviation:
        """Scatter of every line."""
        own = run.record.scatter
        return Deviation(own, float(np.sqrt(np.mean(own**2))))

    def searched_at_start(self, measurement: Measurement) -> list[Parameter]:
        """Values of a machine, whose resonances move farther than they are wide."""
        if not measurement.case.on_machine:
            return []
        return self.nuisance_parameters(measurement)

    def nuisance_parameters(self, measurement: Measurement) -> list[Parameter]:
        """Modal parameters, or what of the machine is declared as uncertain."""
        case = measurement.case
        paths = [*structural_paths(case), *machine_paths(case)]
        return within_reach(with_priors(measurement, paths))


def machine_paths(case: Case) -> list[str]:
    """Paths of what of the machine of a case is declared with a standard deviation."""
    return [path for path in case.deviations() if path.startswith(MACHINE_PATH)]


def _feed_of(case: Case) -> dict[str, Any]:
    """Sections that tell the feed of a case: of the tool its number of teeth alone."""
    if case.tool is None or case.cut is None:
        return {"tool": case.tool, "cut": case.cut}
    plain = {name: one.default for name, one in Tool.model_fields.items() if not one.is_required()}
    return {"tool": case.tool.model_copy(update=plain), "cut": case.cut}


def _of_machine(case: Case, run: Run) -> Signals:
    """Receptance of the machine in the state of a run."""
    read, excite = read_and_excited(run)
    found = machine_response(case, run.condition, read, excite, run.signals["frequency"])
    return {"real": found.real, "imag": found.imag}


def read_and_excited(run: Run) -> tuple[str, str]:
    """Where the response is read and where the structure is excited."""
    if _BETWEEN in run.direction:
        read, _, excite = run.direction.partition(_BETWEEN)
        return read, excite
    return run.direction[0], run.direction[-1]


def _refuse_unknown_place(case: Case, run: Run) -> None:
    if _BETWEEN in run.direction:
        if not case.on_machine:
            raise InputError(f"{run.name}: excite: the case is on no machine; give a direction")
        # the machine tells what it does not know
        frequency = np.maximum(run.signals["frequency"][:1], 1.0)
        machine_response(case, run.condition, *read_and_excited(run), frequency)
        return
    if not run.direction or any(axis not in _AXES for axis in run.direction):
        raise InputError(f'{run.name}: direction: "{run.direction}" is none; x, y, z or xy')


def touching(free: Array, frequency: Array, stiffness: float, damping: float) -> Array:
    """Receptance (m, 3, 3) with a spring and a damper between tool and work in x and y."""
    joint = np.zeros((frequency.size, 3, 3), dtype=np.complex128)
    for axis in range(2):
        joint[:, axis, axis] = stiffness + 2j * np.pi * frequency * damping
    return np.linalg.solve(np.eye(3) + free @ joint, free)
