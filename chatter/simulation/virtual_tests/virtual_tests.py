"""FRFs of a machine by tests in time, as on the real one: blows, chirps, multisines, torques.

The response counts against that of the same run without excitation, so that a steady motion,
preloads and settling loops take no part; on a real machine a record is detrended for that. It is
read as a velocity: with friction a blow leaves a lasting displacement, which never dies away.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from chatter.description.errors import InputError
from chatter.description.progress import Progress, no_progress
from chatter.simulation.virtual_tests.run import MachineRun, RunInputs, run_machine
from dynamics.frf.container import Frf, MeasurementError
from dynamics.frf.excitation.angle_triggered import angle_at_constant_speed, angle_triggered_pulses
from dynamics.frf.excitation.chirp import linear_chirp
from dynamics.frf.excitation.hammer import half_sine_blow, several_blows
from dynamics.frf.excitation.holds import FIRST_ORDER_HOLD, ZERO_ORDER_HOLD, Hold
from dynamics.frf.excitation.multisine import full_lines, multisine, random_phases
from dynamics.frf.excitation.periodic import PeriodicRecord, frf_of_periods, joint_input_output_frf
from dynamics.frf.excitation.signal import ExcitationError, PeriodicSignal, PulseTrain
from dynamics.frf.excitation.transient import NotDiedAwayError, cut_at_pulses, frf_of_transients
from dynamics.machine.description import Machine
from dynamics.trajectory.periodic import ConstantSpeedMove
from dynamics.trajectory.set_points import SetPoints, interpolation_cycle, set_points

#: a half-sine blow this long over the highest frequency still excites it at a third of its level
_CONTACT = 0.9
#: part of the peak response that may be left at the end of a blow's record
_LEFT_AT_END = 0.02


@dataclass(frozen=True, eq=False)
class FrfTest:
    """A test: what is excited, what is read, in which state, and how."""

    name: str
    kind: str  # key of `KINDS`
    #: (n,), row along which the force acts, or axis whose torque does
    excited: NDArray[np.float64] | str
    read: NDArray[np.float64]  # (n,), row of the structure
    level: float  # peak of the force, N (N m)
    band: tuple[float, float]  # Hz
    period: float  # of a periodic excitation, or from blow to blow, s
    averages: int = 3  # blows, or periods (of a multisine: realisations of other phases)
    settling: float = 0.5  # before the excitation, s
    #: of axes that move during the test, m/s
    velocity: Mapping[str, float] = field(default_factory=dict)
    seed: int = 1  # of phases and of the scatter of blows
    spindle_speed: float = 0.0  # of the tool in a test by torque impulses, rad/s
    #: of the spindle, at which impulses are released, rad; evenly in time by default
    at_angle: float | None = None


def hammer(machine: Machine, step: float, test: FrfTest, progress: Progress) -> Frf:
    """FRF by blows of half a sine, a little different from one another."""
    width = max(_CONTACT / test.band[1], 2.0 * step)
    train = several_blows(
        width, test.level, step, test.averages, _whole(test.period, step), 0.05, test.seed
    )
    force, response = _tested(machine, step, test, train.values, progress)
    return _of_blows(train, force, response, FIRST_ORDER_HOLD, test)


def torque_impulse(machine: Machine, step: float, test: FrfTest, progress: Progress) -> Frf:
    """FRF by impulses of the torque command of an axis, of the closed loop."""
    width = max(_CONTACT / test.band[1], 2.0 * step)
    if test.at_angle is not None:
        train = _at_angle(test, width, step)
    else:
        train = several_blows(
            width, test.level, step, test.averages, _whole(test.period, step), 0.0, test.seed
        )
    commanded = _as_sampled(machine, step, test, train.values)
    _, response = _tested(machine, step, test, commanded, progress)
    return _of_blows(train, commanded, response, ZERO_ORDER_HOLD, test)


def chirp(machine: Machine, step: float, test: FrfTest, progress: Progress) -> Frf:
    """FRF by a sine chirp, repeated and averaged over its periods."""
    signal = linear_chirp(*test.band, _whole(test.period, step), test.level, step)
    record = _periodic(machine, step, test, signal, progress)
    return frf_of_periods([record], FIRST_ORDER_HOLD).frf


def multisine_force(machine: Machine, step: float, test: FrfTest, progress: Progress) -> Frf:
    """FRF by multisines of random phases, averaged over realisations."""
    records = [
        _periodic(machine, step, test, _multisine(test, step, i), _share_of(progress, i, test))
        for i in range(test.averages)
    ]
    return frf_of_periods(records, FIRST_ORDER_HOLD).frf


def torque_multisine(machine: Machine, step: float, test: FrfTest, progress: Progress) -> Frf:
    """FRF from motor torque, identified in the closed loop by injected multisines."""
    records = [
        _periodic(machine, step, test, _multisine(test, step, i), _share_of(progress, i, test))
        for i in range(test.averages)
    ]
    return joint_input_output_frf(records, ZERO_ORDER_HOLD)


#: kind of a test -> how it is made
KINDS: dict[str, Callable[[Machine, float, FrfTest, Progress], Frf]] = {
    "hammer": hammer,
    "chirp": chirp,
    "multisine": multisine_force,
    "torque impulse": torque_impulse,
    "torque multisine": torque_multisine,
}
#: those that excite through the motors of an axis
BY_TORQUE = ("torque impulse", "torque multisine")


def frf_by_test(
    machine: Machine,
    step: float,
    test: FrfTest,
    progress: Progress = no_progress,
    longest_period: float = 0.0,
) -> Frf:
    """Receptance of a machine by a test in time.

    Its coherence is there where the test has several averages. Blows after which the machine
    vibrates for longer than `longest_period`, s, are refused; up to it their period is doubled.
    InputError if the test makes no sense on this machine, RunError if the machine runs away; step
    in s.
    """
    try:
        return KINDS[test.kind](machine, step, test, progress).as_quantity("receptance")
    except NotDiedAwayError as error:
        if 2.0 * test.period <= longest_period:
            longer = replace(test, period=2.0 * test.period)
            return frf_by_test(machine, step, longer, progress, longest_period)
        raise InputError(f'test "{test.name}": {error} (period: {test.period:g} s)') from error
    except (ExcitationError, MeasurementError) as error:
        raise InputError(f'test "{test.name}": {error}') from error


def _whole(time: float, step: float) -> float:
    return max(round(time / step), 1) * step


def _multisine(test: FrfTest, step: float, realisation: int) -> PeriodicSignal:
    period = _whole(test.period, step)
    lines = full_lines(*test.band, period, step)
    phases = random_phases(lines, test.seed + realisation)
    return multisine(lines, phases, period, 1.0, step).with_peak(test.level)


def _as_sampled(machine: Machine, step: float, test: FrfTest, values: NDArray) -> NDArray:
    """A torque command as the current loop reads it: held from sample to sample."""
    names = _excited_drives(machine, test)
    every = [
        drive.controller.steps_per_sample(step)[2]
        for drive in machine.drives
        if drive.name in names
    ]
    # samples count from the start of the run
    before = round(test.settling / step)
    index = np.arange(before, before + len(values))
    held = index - index % max(every) - before
    return np.where(held >= 0, values[np.maximum(held, 0)], 0.0)


def _at_angle(test: FrfTest, width: float, step: float) -> PulseTrain:
    """Pulses released as the spindle comes to an angle, a period apart at the least."""
    turn = 2.0 * np.pi / test.spindle_speed
    revolutions = max(1, int(np.ceil(test.period / turn)))
    samples = round((test.averages + 1) * revolutions * turn / step)
    # the angle counts from the start of the run, not from that of the excitation
    start = test.spindle_speed * round(test.settling / step) * step
    angle = angle_at_constant_speed(test.spindle_speed, samples, step, start)
    pulse = half_sine_blow(width, test.level, step)
    return angle_triggered_pulses(angle, test.at_angle, pulse, step, revolutions)


def _share_of(progress: Progress, index: int, test: FrfTest) -> Progress:
    """Progress of one of several runs as part of the whole."""
    return lambda done, total: progress(index * total + done, test.averages * total)


def _of_blows(
    train: PulseTrain, force: NDArray, response: NDArray, hold: Hold, test: FrfTest
) -> Frf:
    records = cut_at_pulses(train, force, response, "mobility")
    return frf_of_transients(records, hold, test.band, left_at_end=_LEFT_AT_END)


def _periodic(
    machine: Machine, step: float, test: FrfTest, signal: PeriodicSignal, progress: Progress
) -> PeriodicRecord:
    # one realisation of a multisine gets two periods to use, a chirp as many as averages
    periods = test.averages if test.kind == "chirp" else 2
    leading = max(1, int(np.ceil(test.settling / (signal.period * step))))
    values = signal.repeated(periods, leading)
    force, response = _tested(machine, step, test, values, progress)
    reference = values if test.kind in BY_TORQUE else None
    return PeriodicRecord(
        force, response, step, signal.period, signal.lines, leading, "mobility", reference
    )


def _tested(
    machine: Machine, step: float, test: FrfTest, values: NDArray, progress: Progress
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Force and velocity at the samples of an excitation, behind the settling time."""
    before = round(test.settling / step)
    signal = np.concatenate([np.zeros(before), values])
    excited = _run(machine, step, test, signal, progress)
    drives = _excited_drives(machine, test)
    response = np.concatenate([[0.0], excited.velocity["read"]])
    force = sum((excited.force[f"drive {name}"] for name in drives), np.zeros(1))
    if test.velocity or machine.preloads:
        still = _run(machine, step, test, np.zeros_like(signal), no_progress)
        response = response - np.concatenate([[0.0], still.velocity["read"]])
        force = force - sum((still.force[f"drive {name}"] for name in drives), np.zeros(1))
    if excited.interrupted:
        raise KeyboardInterrupt
    if not drives:
        force = signal
    return force[before:], response[before : len(signal)]


def _run(
    machine: Machine, step: float, test: FrfTest, signal: NDArray, progress: Progress
) -> MachineRun:
    total = len(signal)
    points = _at_speed(machine, test.velocity, total * step, step)
    names = _excited_drives(machine, test)
    if names:
        injected = dict.fromkeys(names, signal)
        inputs = RunInputs(total * step, points, {}, injected, {"read": test.read})
    else:
        load = np.append(signal, 0.0)
        loads = {"excited": (test.excited, load)}
        inputs = RunInputs(total * step, points, loads, {}, {"read": test.read})
    return run_machine(machine, step, inputs, progress)


def _excited_drives(machine: Machine, test: FrfTest) -> list[str]:
    """Drives whose torque excites; none where a force does."""
    if not isinstance(test.excited, str):
        return []
    names = [drive.name for drive in machine.drives if drive.axis == test.excited]
    if not names:
        known = ", ".join(f'"{drive.axis}"' for drive in machine.drives) or "none"
        raise InputError(
            f'test "{test.name}": axis "{test.excited}" is not under control, so that no torque '
            f"can be injected; there are {known}"
        )
    return names


def _at_speed(
    machine: Machine, velocity: Mapping[str, float], duration: float, step: float
) -> SetPoints | None:
    """Set points of axes at constant speed, for longer than a duration."""
    if not velocity:
        return None
    cycle = interpolation_cycle(
        (drive.controller.position.timing.sample_time for drive in machine.drives), step
    )
    ways = np.array([velocity.get(axis, 0.0) * (duration + 2.0 * cycle) for axis in machine.axes])
    speed = float(np.linalg.norm([velocity.get(axis, 0.0) for axis in machine.axes]))
    motion = ConstantSpeedMove(np.zeros(len(ways)), ways, speed)
    return set_points(motion, cycle, step)
