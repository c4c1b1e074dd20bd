"""Chatter and stability of milling: from a case file to lobes, pictures and reports.

    import chatter

    case = chatter.load("case.toml")
    diagram = chatter.lobes(case)
    diagram.plot()
    diagram.save("out")

================== ===================================================================
module             responsibility
================== ===================================================================
case               the case file: units, checks, patches, writing back, schema
structure          modes of a case, or the measured FRFs that it names
model              compile a case to flat arrays
stability          kernels: one module a method, one sweep
methods            the methods behind one call
lobe_diagram       `lobes`: limits over speed, pockets, files
path_diagram       `lobes --x`, `--y`: limits and maps over any path of the case
stability_check    `check`: verdict on the operating point
simulation         `simulate`: the cut in the time domain
what_if            `whatif`: what would change if values were others
monte_carlo        `uncertainty`: tolerances of the input to limits
best_cut           `optimum`: the highest removal rate within limits
pitch_angles       `pitch`: pitch angles for a range of speeds
judgement          chatter or not, from the signals of a cut
machine_file       the machine file: bodies, drives, friction, control -> a machine
virtual_machine    `frf`, `move`: virtual tests of a machine
findings           table of published against obtained
modal_test         `modes`: measured FRFs or hammer records to modal parameters
result_files       files that results write
example_cases      `examples`: list, copy and run the shipped examples
live               `lobes --live`: a page in the browser that follows sliders
cluster            where studies are computed: here, or on a Dask cluster
grid_blocks        the grid of a diagram on a cluster
plots              pictures
cli                the command line
================== ===================================================================
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from chatter.best_cut.study import optimum as optimum
    from chatter.case import Case as Case
    from chatter.case import load as load
    from chatter.case import schema as schema
    from chatter.errors import InputError as InputError
    from chatter.errors import RunError as RunError
    from chatter.example_cases import examples as examples
    from chatter.lobe_diagram import lobes as lobes
    from chatter.machine_file import load_machine as load_machine
    from chatter.modal_test import modes as modes
    from chatter.monte_carlo.study import uncertainty as uncertainty
    from chatter.path_diagram import lobes_over as lobes_over
    from chatter.pitch_angles.study import pitch as pitch
    from chatter.simulation.bifurcation import bifurcation as bifurcation
    from chatter.simulation.simulate import simulate as simulate
    from chatter.stability_check import check as check
    from chatter.virtual_machine.from_file import frf as frf
    from chatter.virtual_machine.from_file import move as move
    from chatter.what_if.study import whatif as whatif

__version__ = "0.1.0"

#: public name -> module that holds it; imported when first used, so that `import chatter` is quick
_PUBLIC = {
    "Case": "chatter.case",
    "InputError": "chatter.errors",
    "RunError": "chatter.errors",
    "bifurcation": "chatter.simulation.bifurcation",
    "check": "chatter.stability_check",
    "examples": "chatter.example_cases",
    "frf": "chatter.virtual_machine.from_file",
    "load": "chatter.case",
    "load_machine": "chatter.machine_file",
    "lobes": "chatter.lobe_diagram",
    "lobes_over": "chatter.path_diagram",
    "modes": "chatter.modal_test",
    "optimum": "chatter.best_cut.study",
    "move": "chatter.virtual_machine.from_file",
    "pitch": "chatter.pitch_angles.study",
    "schema": "chatter.case",
    "simulate": "chatter.simulation.simulate",
    "uncertainty": "chatter.monte_carlo.study",
    "whatif": "chatter.what_if.study",
}

__all__ = sorted(_PUBLIC)


def __getattr__(name: str) -> Any:
    if name in _PUBLIC:
        return getattr(import_module(_PUBLIC[name]), name)
    raise AttributeError(f"module 'chatter' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*globals(), *_PUBLIC])
