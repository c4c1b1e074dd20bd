"""Errors of setting that would move a tooth off its tool are refused."""

from chatter.description.case import Case
from chatter.description.errors import InputError

#: of the radius, by which a tooth may be off its place
_FURTHEST = 0.2


def refuse_teeth_off_the_tool(case: Case) -> None:
    """Refuse runout and setting errors that would move a tooth by a good part of the radius.

    And waves of an edge that would reach the axis.
    """
    tool = case.tool
    most = _FURTHEST * 0.5 * tool.diameter
    given = {"runout.offset": (tool.runout.offset,) if tool.runout else ()}
    given |= {"radial_error": tool.radial_error or (), "axial_error": tool.axial_error or ()}
    problems = [
        f"{case.name}: tool.{key}: {max(map(abs, values)) * 1e3:g} mm is more than a tenth of the "
        f"diameter, {tool.diameter * 1e3:g} mm"
        for key, values in given.items()
        if values and max(map(abs, values)) > most
    ]
    if tool.serration is not None and tool.serration.depth >= 0.5 * tool.diameter:
        problems.append(
            f"{case.name}: tool.serration.depth: {tool.serration.depth * 1e3:g} mm is not less "
            f"than the radius of the tool, {tool.diameter * 500.0:g} mm"
        )
    if problems:
        raise InputError(problems)
