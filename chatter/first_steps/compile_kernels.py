"""Everything that users ask for is asked once, small, so that its compiled code is in the cache."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from chatter.description.case import Case, load
from chatter.description.machine.machine_file import MachineFile, load_machine
from chatter.first_steps.self_check import CASE, compiled_self_check
from chatter.io.shipped_examples import examples
from chatter.simulation.simulate import simulate
from chatter.simulation.virtual_tests.from_file import frf, move
from chatter.stability.check import check
from chatter.stability.lobes import lobes
from chatter.stability.registry import METHODS

_ONE = {"simulation.revolutions": 4}
_HELIX = {"tool.helix": "30 deg"}
_EXPONENTIAL = {"material.law": "exponential", "material.h0": "0.1 mm", "material.exponent": 0.7}
_VISCOUS = {"process_damping.coefficient": "0.2 MN/m", "process_damping.friction": 0.3}
_PLOUGHING = {
    "process_damping.indentation_force": "40 N/um/mm^2",
    "process_damping.friction": 0.3,
    "tool.flank_wear": "0.05 mm",
    "tool.clearance_angle": "6 deg",
}
_INCLINED = {"cut.lead": "2 deg"}
_VARYING = {"cut.speed_variation.amplitude": 0.1, "cut.speed_variation.frequency": "20 Hz"}
_CONTACT = {"contact.stiffness": "2 N/um", "contact.damping": "60 N*s/m"}
_SPEEDS = {"lobes.speeds": {"from": "8000 rpm", "to": "12000 rpm", "count": 4}}
_FRICTIONS = {
    "coulomb-stribeck": {"static": "4 N", "stribeck_velocity": "10 mm/s"},
    "smooth-coulomb": {"smoothing_velocity": "5 mm/s"},
    "tanh-hysteresis": {"viscous": "2 N*s/m", "presliding_stiffness": "1 N/um"},
    "lugre": {
        "static": "4 N",
        "stribeck_velocity": "10 mm/s",
        "bristle_stiffness": "1 N/um",
        "bristle_damping": "3 N*s/m",
    },
}


class Question(NamedTuple):
    """Something that a user may ask, as small as it can be asked."""

    name: str
    ask: Callable[[], object]


class Compiled(NamedTuple):
    """A question that was asked, and how long it took, s."""

    name: str
    seconds: float


def compile_kernels(stage: Callable[[str], None] | None = None) -> Iterator[Compiled]:
    """Ask every question once; what each compiles is kept on disk before the next begins.

    Parameters
    ----------
    stage : callable, optional
        Called with what is compiled next, and how many there are.

    Yields
    ------
    Compiled
        As each is done: an interruption loses nothing of those before.
    """
    asked = [*_of_stability(), *_of_time(), *_of_machines()]
    for place, question in enumerate(asked, 1):
        if stage is not None:
            stage(f"compiling {place} of {len(asked)}: {question.name}")
        started = time.perf_counter()
        question.ask()
        yield Compiled(question.name, time.perf_counter() - started)


def _case(**patches: Mapping[str, Any]) -> Case:
    """Case of the self-check with patches over it, whatever they are called."""
    case = Case.from_dict(CASE, "chatter compile")
    together: dict[str, Any] = {}
    for patch in patches.values():
        together.update(patch)
    return case.patch(together)


def _of_stability() -> Iterator[Question]:
    for name in METHODS.names():
        yield Question(f"limit by {name}", partial(lobes, _case(speeds=_SPEEDS), name))
    for name, patch in {
        "helical edge": _HELIX,
        "exponential law": _HELIX | _EXPONENTIAL,
        "viscous process damping": _VISCOUS,
        "ploughing of a worn flank": _PLOUGHING,
        "varying spindle speed": _VARYING,
        "inclined axis": _HELIX | _INCLINED,
        "contact": _CONTACT,
    }.items():
        yield Question(f"verdict, {name}", partial(check, _case(patch=patch)))
    yield Question("grid of a diagram", lambda: lobes(_case(speeds=_SPEEDS), grid=True))


def _of_time() -> Iterator[Question]:
    of_cuts = {
        "straight edge": {},
        "helical edge": _HELIX,
        "exponential law": _HELIX | _EXPONENTIAL,
        "viscous process damping": _VISCOUS,
        # what `explain` tries together
        "exponential law, viscous process damping": _HELIX | _EXPONENTIAL | _VISCOUS,
        "ploughing of a worn flank": _PLOUGHING,
        "varying spindle speed": _VARYING,
        "contact": _CONTACT,
        "inclined axis": _HELIX | _INCLINED,
        "carved by dexels": {"simulation.chip": "dexel"},
        "carved by voxels": {"simulation.chip": "voxel"},
    }
    for law, keys in _FRICTIONS.items():
        values = {"law": law, "coulomb": "3 N", **keys}
        of_cuts[f"{law} friction on a mode"] = {
            "friction": {"guide": values},
            "structure.mode[0].friction": "guide",
        }
    for name, patch in of_cuts.items():
        yield Question(f"cut, {name}", partial(simulate, _case(patch=patch, short=_ONE)))
    yield Question("self-check", compiled_self_check)


def _of_machines() -> Iterator[Question]:
    shipped = examples()
    machine = shipped.get("machine-coupled-milling")
    cut = shipped.get("face-mill-chatter")
    if machine is not None:
        file = machine.folder / "machine.toml"
        yield Question("frequency response of a machine", lambda: frf(_quick(file), ["moving"]))
        yield Question("move of a machine", lambda: move(_quick(file), "speed"))
    if cut is not None:
        short = {"structure.settling": "0.05 s", "simulation.duration": "0.05 s"}
        case = cut.folder / "case.toml"
        yield Question("cut on a machine", lambda: simulate(load(case).patch(short)))


def _quick(file: Path) -> MachineFile:
    """The machine with short tests."""
    return load_machine(file).patch({"frf.moving.averages": 1, "move.speed.travel": "5 mm"})
