"""FRFs of the shipped machines: three tests in time against the linearised machine.

Stated of tests in time: within 1 %. Allowed are 1 % of the response at each line and 0.2 % of the
largest in the band, which is what is left between resonances. Levels are small where there is
friction, since the linearised machine is that of small motion.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.contradictions.confrontation import Comparison, Confrontation, Document
from benchmarks.contradictions.drawing.quantities import chosen, happens, log_uniform, text
from chatter.description.machine.frequency_response import FrfSection
from chatter.description.machine.machine_file import MachineFile, load_machine
from chatter.io.shipped_examples import examples
from chatter.simulation.virtual_tests.from_file import one_frf

_TESTS = ("hammer", "chirp", "multisine")
_OF_THE_LINE, _OF_THE_LARGEST = 0.01, 0.002
#: peak force without friction, and beside friction that holds, which a moving axis has in the
#: others, N: a chirp of 0.5 N is off by 3 to 9 % of a resonance, and by a tenth of it at 0.05 N
_LEVELS = {"no friction": 100.0, "moving": 0.05, "rest": 0.05}
#: example -> its file, and what can be said of its friction
_MACHINES = {
    "machine-coupled-milling": ("machine.toml", ("no friction", "moving", "rest")),
    "machine-gantry": ("machine.toml", ("no friction",)),
    "machine-drive-control": ("machine.toml", ("no friction", "moving", "rest")),
    # dry friction at rest has no small motion
    "machine-mandelli-m5": ("machine.toml", ("no friction", "moving")),
    "machine-twin-control": ("comau.toml", ("no friction",)),
}


def draw_test(rng: np.random.Generator) -> Document:
    """A machine with some masses and its damping changed, at rest or feeding, and a test of it."""
    name = chosen(rng, tuple(_MACHINES))
    place, states = _MACHINES[name]
    file = _shipped(f"{name}/{place}")
    values = {
        f"body.{body}.mass": text(file.get(f"body.{body}.mass") * rng.uniform(0.7, 1.4), "kg")
        for body in file.body
        if happens(rng, 0.4)
    }
    values["damping_ratio"] = round(rng.uniform(0.01, 0.05), 4)
    state = chosen(rng, states)
    against = f"/{file.workpiece}" if file.workpiece and happens(rng, 0.5) else ""
    section: Document = {
        "excite": f"{file.tool_point}{against}:{chosen(rng, 'xyz')}",
        "by": chosen(rng, _TESTS),
        "level": text(_LEVELS[state], "N"),
        "band": [
            text(log_uniform(rng, 8.0, 25.0), "Hz"),
            text(log_uniform(rng, 60.0, 180.0), "Hz"),
        ],
        "period": text(rng.uniform(1.5, 3.0), "s"),
        "averages": 2,
        "friction": state != "no friction",
    }
    if state == "moving":
        axis = chosen(rng, tuple(file.axis))
        section["moving"] = {axis: text(log_uniform(rng, 200.0, 2000.0), "mm/min")}
    machine = {"file": f"{name}/{place}", "values": values}
    return {"machine": machine, "frf": {"drawn": section}}


@cache
def _shipped(place: str) -> MachineFile:
    name, file = place.split("/")
    return load_machine(Path(examples()[name].folder) / file)


def machine_of(document: Document) -> MachineFile:
    """Machine of a drawn document, with its test."""
    machine = document["machine"]
    sections = {f"frf.{name}": section for name, section in document["frf"].items()}
    return _shipped(machine["file"]).patch({**machine["values"], **sections})


def section_of(file: MachineFile) -> FrfSection:
    """The drawn test."""
    return file.frf["drawn"]


def compare_responses(document: Document) -> list[Comparison]:
    """Response at the line that is farthest off, over what is allowed there."""
    file = machine_of(document)
    section = section_of(file)
    curve = one_frf(file, "drawn", section)
    lines = curve.tested.frequency
    inside = (lines >= section.band[0]) & (lines <= section.band[1])
    lines, tested = lines[inside], curve.tested.values[inside]
    # both at the lines of the test: the linearised response is smooth between its own
    fine = section.model_copy(update={"by": "linearised", "lines": 20000})
    harmonic = one_frf(file, "drawn", fine).harmonic
    wanted = np.interp(lines, harmonic.frequency, harmonic.values)
    size = np.abs(wanted)
    off = np.abs(tested - wanted)
    allowed = _OF_THE_LINE * size + _OF_THE_LARGEST * size.max()
    worst = int(np.argmax(off / allowed))
    found = Comparison(
        f"off the linearised receptance at {lines[worst]:.4g} Hz, of {size[worst]:.4g}",
        float(off[worst]),
        0.0,
        float(allowed[worst]),
    )
    return [found]


MACHINE_RESPONSES = Confrontation(
    name="responses of machines",
    ways="linearised machine; blows, chirps, multisines in time, at rest, feeding and without "
    "friction",
    stated="1 % of the response at each line and 0.2 % of the largest in the band",
    weight=0.5,
    draw=draw_test,
    compare=compare_responses,
    reads=machine_of,
)
