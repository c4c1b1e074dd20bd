"""Tool and force laws of a case, as `cutting` knows them."""

from typing import NamedTuple

import numpy as np

from chatter.compile.empirical import speed_factor
from chatter.compile.worn_flank import land_forces
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.sections.process import ProcessDamping
from chatter.description.unit_system import units_of
from cutting.force.law import ForceLaw
from cutting.force.laws import edge_law_table
from cutting.process_damping.flank import BareFlank, ProcessDampingLaw
from cutting.process_damping.ploughing import Ploughing
from cutting.process_damping.viscous import ViscousProcessDamping
from cutting.tool.cutter import Cutter, Serration

#: longest worn land that ploughs, of the diameter: it is taken as flat along the path
_LONGEST_LAND = 0.1


def helix_angles(case: Case) -> tuple[float, ...]:
    """Helix angle of each tooth, rad."""
    helix = case.tool.helix
    return tuple(helix) if isinstance(helix, tuple) else (helix,) * case.tool.teeth


def pitch_angles(case: Case) -> tuple[float, ...]:
    """Angle from each tooth to the next, rad; they make a turn exactly."""
    teeth = case.tool.teeth
    given = np.asarray(case.tool.pitch or (1.0,) * teeth)
    return tuple(given * 2.0 * np.pi / given.sum())


def cutter_of(case: Case) -> Cutter:
    """Tool that a case describes."""
    tool = case.tool
    corner = 0.5 * tool.diameter if tool.kind == "ball" else tool.corner_radius
    wave = tool.serration
    return Cutter(
        diameter=tool.diameter,
        helix=helix_angles(case),
        pitch=pitch_angles(case),
        corner_radius=corner,
        edge_angle=tool.cutting_edge_angle - tool.taper_angle,
        runout_offset=tool.runout.offset if tool.runout else 0.0,
        runout_angle=tool.runout.angle if tool.runout else 0.0,
        radial_error=tool.radial_error or (),
        axial_error=tool.axial_error or (),
        serration=Serration(wave.depth, wave.wavelength) if wave else None,
    )


#: process damping of a sharp tool; of what wear adds, tangential over radial force
_NONE_YET = ProcessDamping(coefficient=0.0, friction=0.3)


def force_law(case: Case, helix: float) -> ForceLaw:
    """Force law of a case after its cutting time, for an edge inclined by the helix, rad."""
    law = case.material.force_law(helix).scaled(speed_factor(case))
    if case.cut is None:
        return law
    if case.tool is not None and case.tool.flank_wear:
        land = land_forces(case, law)
        law = law.worn(0.0, [land.tangential, land.radial, 0.0])
    if case.wear is None:
        return law
    wear, time = case.wear, case.cut.cut_time
    edges = [wear.increase(key, time) for key in ("edge_tangential", "edge_radial")]
    cutting, radial = (wear.increase(key, time) for key in ("cutting", "cutting_radial"))
    return law.worn([cutting, radial, cutting], [*edges, 0.0])


def edge_law(case: Case) -> NamedTuple:
    """Table of the force law for the kernels; helix may differ from tooth to tooth."""
    return edge_law_table([force_law(case, helix) for helix in helix_angles(case)])


def process_damping_of(case: Case) -> ProcessDampingLaw | None:
    """Force on the flank that a case describes; None where there is none, as of a new tool.

    InputError if ploughing lacks the clearance angle, or anything that touches the work.
    """
    tool, section = case.tool, case.process_damping
    if section is None:
        return _viscous(case, _NONE_YET)
    if section.indentation_force is None:
        return _viscous(case, section)
    problems = []
    if tool.clearance_angle is None:
        problems.append(
            f"{case.name}: tool.clearance_angle: is missing; process_damping.indentation_force "
            'needs it, such as "6 deg"'
        )
    if not tool.edge_radius and "flank_wear" not in tool.model_fields_set:
        problems.append(
            f"{case.name}: tool.edge_radius: neither edge_radius nor flank_wear is given; "
            "process_damping.indentation_force needs one of them"
        )
    longest, length = _LONGEST_LAND * tool.diameter, units_of(case).length
    if tool.flank_wear and tool.flank_wear > longest:
        problems.append(
            f"{case.name}: tool.flank_wear: {length.text(tool.flank_wear, 'g')} is out of range; "
            f"a land that ploughs is at most a tenth of the diameter, {length.text(longest, 'g')}"
        )
    if problems:
        raise InputError(problems)
    if not tool.edge_radius and not tool.flank_wear:
        # a new tool, where a study of wear begins: no land touches the work
        return _viscous(case, _NONE_YET)
    return Ploughing(
        indentation_force=section.indentation_force,
        clearance_angle=tool.clearance_angle,
        flank_wear=tool.flank_wear,
        edge_radius=tool.edge_radius,
        friction=section.friction,
    )


def _viscous(case: Case, section: ProcessDamping) -> ViscousProcessDamping | None:
    """Viscous process damping as far as the tool has worn; None where there is none."""
    given = section.coefficient
    if case.wear is not None and case.cut is not None:
        wear, time = case.wear, case.cut.cut_time
        given *= 1.0 + wear.increase("process_damping", time)
        given += wear.increase("ploughing", time)
    return ViscousProcessDamping(given, section.friction) if given else None


def flank_table(case: Case, radius: np.ndarray, step_angle: float) -> NamedTuple:
    """Table of the force on the flank for the kernels."""
    law = process_damping_of(case)
    return BareFlank() if law is None else law.table(radius, case.tool.teeth, step_angle)
