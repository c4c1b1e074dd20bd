"""A case against itself, said in another way: units, names, order and parts of modes."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.contradictions.confrontation import Comparison, Confrontation, Document, relative
from benchmarks.contradictions.confrontations.multipliers import draw_any_speed
from benchmarks.contradictions.edge_quadrature import oblique_coefficients
from benchmarks.contradictions.numbers import rows_compared, signals, spectral_radius
from chatter.description.case import Case
from chatter.stability.model import milling_model
from cutting.material.table import MATERIALS

#: unit -> another one of the same dimension, and how many of it are one of the first
_OTHER_UNITS = {
    "mm": ("inch", 1.0 / 25.4),
    "um": ("thou", 1.0 / 25.4),
    "deg": ("rad", math.pi / 180.0),
    "MPa": ("psi", 1e6 * 0.0254**2 / (9.80665 * 0.45359237)),
    "N/mm": ("kN/m", 1.0),
    "N/m": ("N/um", 1e-6),
    "rpm": ("deg/s", 6.0),
    "Hz": ("kHz", 1e-3),
}
#: of the spectral radius, beyond the stated errors, and of signals: rounding that a few growing
#: revolutions magnify
_ROUNDING = 1e-6


def draw_short(rng: np.random.Generator) -> Document:
    """Any vibrating cut, simulated for two revolutions."""
    return {**draw_any_speed(rng), "simulation": {"revolutions": 2}}


def restated(document: Document) -> Document:
    """Other units, modes in another order, names replaced by what they stand for."""
    widens = document["tool"]["kind"] in ("taper", "inserted")
    document = {**document, "tool": _tool(document), "material": _material(document)}
    # a cone is wider than its tip, so that a slot of it is more than the diameter
    if document["cut"]["mode"] == "slot" and not widens:
        width = document["tool"]["diameter"]
        document["cut"] = {**document["cut"], "mode": "up", "radial_depth": width}
    modes = [_seen_from_the_other_side(mode) for mode in document["structure"]["mode"]]
    document["structure"] = {"mode": modes[::-1]}
    return _in_other_units(document)


def _seen_from_the_other_side(mode: Document) -> Document:
    """The same mode, its direction reversed, on the other side of the cut."""
    side = {"tool": "workpiece", "workpiece": "tool"}[mode["side"]]
    return {**mode, "direction": [-part for part in mode["direction"]], "side": side}


def _tool(document: Document) -> Document:
    tool = dict(document["tool"])
    teeth = tool["teeth"]
    if tool["kind"] == "ball":
        tool |= {"kind": "bull nose", "corner_radius": _halved(tool["diameter"])}
    elif tool["kind"] == "taper":
        angle = 90.0 - float(tool.pop("taper_angle").split()[0])
        tool |= {"kind": "inserted", "cutting_edge_angle": f"{angle!r} deg"}
    elif tool["kind"] == "end mill":
        tool["kind"] = "inserted"
    if not isinstance(tool["helix"], list):
        tool["helix"] = [tool["helix"]] * teeth
    if "pitch" not in tool:
        tool["pitch"] = [f"{360.0 / teeth!r} deg"] * teeth
    return tool


def _halved(quantity: str) -> str:
    value, unit = quantity.split()
    return f"{0.5 * float(value)!r} {unit}"


def _material(document: Document) -> Document:
    material = document["material"]
    if "name" in material:
        return MATERIALS[material["name"]].keys()
    helix = document["tool"]["helix"]
    if material["law"] != "oblique" or isinstance(helix, list):
        return material
    given = Case.from_dict(document).material.values
    found = oblique_coefficients(given, math.radians(float(helix.split()[0])))
    edge = {key: material[key] for key in ("Kte", "Kre") if key in material}
    return {
        "law": "linear",
        **dict(zip(("Ktc", "Krc", "Kac"), map(float, found), strict=True)),
        **edge,
    }


def _in_other_units(part):
    """Every quantity of a document, or of a part of it, in another unit."""
    if isinstance(part, dict):
        return {key: _in_other_units(value) for key, value in part.items()}
    if isinstance(part, list):
        return [_in_other_units(value) for value in part]
    if isinstance(part, str) and " " in part:
        value, unit = part.split(maxsplit=1)
        if unit in _OTHER_UNITS:
            other, factor = _OTHER_UNITS[unit]
            return f"{float(value) * factor!r} {other}"
    return part


def compare_restated(document: Document) -> list[Comparison]:
    """Spectral radius and signals of both."""
    case, other = Case.from_dict(document), Case.from_dict(restated(document))
    found = rows_compared(signals(case), signals(other), _ROUNDING)
    radius, error = spectral_radius(case)
    own, its_error = spectral_radius(other)
    allowed = error + its_error + _ROUNDING * max(1.0, radius)
    found.append(Comparison("spectral radius", radius, own, allowed))
    means = (milling_model(each).averaged_directional for each in (case, other))
    one, two = (float(np.linalg.norm(mean)) for mean in means)
    found.append(relative("averaged directional coefficients, N/m^2", one, two, _ROUNDING))
    return found


RESTATED = Confrontation(
    name="the same case in other words",
    ways="a case; the same in other units, modes permuted and seen from the other side, names "
    "and kinds replaced by what they stand for",
    stated="the same but for rounding, 1e-6, and the stated errors of the radius",
    weight=4.0,
    draw=draw_short,
    compare=compare_restated,
)
