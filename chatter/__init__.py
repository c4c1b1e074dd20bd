"""Chatter and stability of milling: from a case file to lobes, pictures and reports.

    import chatter

    case = chatter.load("case.toml")
    diagram = chatter.lobes(case)
    diagram.plot()
    diagram.save("out")

Layers, each of which imports only those below it:

==================== =========================================================================
package              responsibility
==================== =========================================================================
cli, app             the command line, a module a command; the page in the browser
plots                pictures of results
report               pages of results
assembly             tool, holder and spindle put together, at any stick-out
cutting_coefficients coefficients of the force law from the forces of cuts
drive_friction       friction and inertia of a drive from records of its moves
monitoring           chatter in recordings of cuts, and what to do about it
learning             what a few cutting tests leave possible, and the next cut
explain              what a measurement says that its declared case lacks
studies              what-if, uncertainty, optimisation, pitch design; executor, result cache
stability            `lobes`, `check`: diagrams, pockets, a package for each method
simulation           `simulate`, `frf`, `move`: a cut or a machine in the time domain
detection            chatter or not, from signals
engine               the time loop, its dispatch, the presets of compiled code
compile              from a case to flat arrays: tool, forces, structure, machine
io                   file formats in and out
description          case, machine and measurement files: keys, units, patches, errors
==================== =========================================================================
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from chatter.app.workbench.explore import explore as explore
    from chatter.assembly.assemble import assemble as assemble
    from chatter.cutting_coefficients.identify import coefficients as coefficients
    from chatter.description.case import Case as Case
    from chatter.description.case import load as load
    from chatter.description.errors import InputError as InputError
    from chatter.description.errors import RunError as RunError
    from chatter.description.machine.machine_file import load_machine as load_machine
    from chatter.drive_friction.identify import friction as friction
    from chatter.explain.comparison import compare as compare
    from chatter.io.shipped_examples import examples as examples
    from chatter.learning.learn import learn as learn
    from chatter.monitoring.detect import detect as detect
    from chatter.operator_sheet.sheet import sheet as sheet
    from chatter.simulation.simulate import simulate as simulate
    from chatter.simulation.virtual_tests.export import export as export
    from chatter.simulation.virtual_tests.from_file import frf as frf
    from chatter.simulation.virtual_tests.from_file import move as move
    from chatter.simulation.virtual_tests.mode_shapes import mode_shapes as mode_shapes
    from chatter.stability.case_schema import schema as schema
    from chatter.stability.check import check as check
    from chatter.studies.bifurcation import bifurcation as bifurcation
    from chatter.studies.diagram_over_axes import lobes as lobes
    from chatter.studies.diagram_over_axes import lobes_over as lobes_over
    from chatter.studies.modal_test import modes as modes
    from chatter.studies.optimisation.process_optimisation import optimum as optimum
    from chatter.studies.pitch_design.pitch_design import pitch as pitch
    from chatter.studies.uncertainty.monte_carlo import uncertainty as uncertainty
    from chatter.studies.whatif.whatif_study import whatif as whatif

__version__ = "0.1.0"

#: public name -> module that holds it; imported when first used, so that `import chatter` is quick
_PUBLIC = {
    "assemble": "chatter.assembly.assemble",
    "Case": "chatter.description.case",
    "InputError": "chatter.description.errors",
    "RunError": "chatter.description.errors",
    "bifurcation": "chatter.studies.bifurcation",
    "coefficients": "chatter.cutting_coefficients.identify",
    "check": "chatter.stability.check",
    "compare": "chatter.explain.comparison",
    "explore": "chatter.app.workbench.explore",
    "detect": "chatter.monitoring.detect",
    "examples": "chatter.io.shipped_examples",
    "export": "chatter.simulation.virtual_tests.export",
    "friction": "chatter.drive_friction.identify",
    "frf": "chatter.simulation.virtual_tests.from_file",
    "learn": "chatter.learning.learn",
    "load": "chatter.description.case",
    "load_machine": "chatter.description.machine.machine_file",
    "lobes": "chatter.studies.diagram_over_axes",
    "lobes_over": "chatter.studies.diagram_over_axes",
    "mode_shapes": "chatter.simulation.virtual_tests.mode_shapes",
    "modes": "chatter.studies.modal_test",
    "optimum": "chatter.studies.optimisation.process_optimisation",
    "move": "chatter.simulation.virtual_tests.from_file",
    "pitch": "chatter.studies.pitch_design.pitch_design",
    "schema": "chatter.stability.case_schema",
    "sheet": "chatter.operator_sheet.sheet",
    "simulate": "chatter.simulation.simulate",
    "uncertainty": "chatter.studies.uncertainty.monte_carlo",
    "whatif": "chatter.studies.whatif.whatif_study",
}

__all__ = sorted([*_PUBLIC, "explain"])


def __getattr__(name: str) -> Any:
    if name == "explain":
        # a package and a call: see chatter.explain
        return import_module("chatter.explain")
    if name in _PUBLIC:
        return getattr(import_module(_PUBLIC[name]), name)
    raise AttributeError(f"module 'chatter' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
