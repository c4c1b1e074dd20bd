"""Keys of a case that nothing uses, as the case stands: said in words, in every command."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from chatter.description.case import Case
    from chatter.description.section import Section

#: keys of [wear] that are rates over the cutting time
_RATES = (
    *("edge_tangential", "edge_radial", "cutting", "cutting_radial"),
    *("process_damping", "ploughing"),
)
_LAND = ("flank_pressure", "flank_friction")


def keys_without_effect(case: Case) -> tuple[str, ...]:
    """Sentences on keys that are given and that no command uses, and what would make them count.

    Sections for one command, such as [optimum] or [dynamometer], are not meant: what they are for
    is in their name.
    """
    return (*_of_tool(case), *_of_wear(case), *_of_friction(case))


def _of_tool(case: Case) -> list[str]:
    tool, damping = case.tool, case.process_damping
    if tool is None:
        return []
    found = []
    if damping is None or damping.indentation_force is None:
        found += [
            _sentence(f"tool.{key}", "without process_damping.indentation_force")
            for key in _given(tool, ("clearance_angle", "edge_radius"))
        ]
    elif not tool.flank_wear and not tool.edge_radius and "flank_wear" in tool.model_fields_set:
        found.append(_sentence("process_damping.indentation_force", "while tool.flank_wear is 0"))
    if tool.stick_out is None:
        keys = _given(tool, ("shank_diameter",))
        found += [_sentence(f"tool.{key}", "without tool.stick_out") for key in keys]
    return found


def _of_wear(case: Case) -> list[str]:
    cut, wear, tool = case.cut, case.wear, case.tool
    if cut is None or tool is None:
        return []
    found = []
    if wear is None and case.tool_life is None:
        keys = _given(cut, ("cut_time",))
        found += [_sentence(f"cut.{key}", "without [wear] or [tool_life]") for key in keys]
    if wear is None:
        return found
    if not cut.cut_time:
        keys = _given(wear, (*_RATES, "saturation_time"))
        found += [_sentence(f"wear.{key}", "while cut.cut_time is 0") for key in keys]
    elif not _given(wear, _RATES):
        keys = _given(wear, ("saturation_time",))
        found += [_sentence(f"wear.{key}", "without a rate of wear") for key in keys]
    if not tool.flank_wear:
        keys = _given(wear, _LAND)
        found += [_sentence(f"wear.{key}", "without tool.flank_wear") for key in keys]
    return found


def _of_friction(case: Case) -> list[str]:
    """Laws of friction that no mode names; a machine has its own file."""
    if case.on_machine:
        return []
    modes = case.structure.mode if case.structure is not None else ()
    named = {mode.friction for mode in modes}
    return [
        _sentence(f"[friction.{name}]", f'while no structure.mode[i].friction is "{name}"')
        for name in case.friction
        if name not in named
    ]


def _given(section: Section, keys: Iterable[str]) -> list[str]:
    """Keys that the file gives, with a value that could count."""
    return [
        key
        for key in keys
        if key in section.model_fields_set and getattr(section, key) not in (None, 0.0, ())
    ]


def _sentence(key: str, why: str) -> str:
    return f"{key} has no effect {why}"
