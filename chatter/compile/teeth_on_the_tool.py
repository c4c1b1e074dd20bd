"""Errors of setting that would move a tooth off its tool are refused."""

from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.unit_system import units_of

#: of the radius, by which a tooth may be off its place
_FURTHEST = 0.2


def refuse_teeth_off_the_tool(case: Case) -> None:
    """Refuse runout and setting errors that would move a tooth by a good part of the radius.

    And waves of an edge that would reach the axis.
    """
    tool, length = case.tool, units_of(case).length
    most = _FURTHEST * 0.5 * tool.diameter
    given = {"runout.offset": (tool.runout.offset,) if tool.runout else ()}
    given |= {"radial_error": tool.radial_error or (), "axial_error": tool.axial_error or ()}
    problems = [
        f"{case.name}: tool.{key}: {length.text(max(map(abs, values)), 'g')} is more than a tenth "
        f"of the diameter, {length.text(tool.diameter, 'g')}"
        for key, values in given.items()
        if values and max(map(abs, values)) > most
    ]
    if tool.serration is not None and tool.serration.depth >= 0.5 * tool.diameter:
        problems.append(
            f"{case.name}: tool.serration.depth: {length.text(tool.serration.depth, 'g')} is not "
            f"less than the radius of the tool, {length.text(0.5 * tool.diameter, 'g')}"
        )
    if problems:
        raise InputError(problems)
