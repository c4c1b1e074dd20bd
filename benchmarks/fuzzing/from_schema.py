"""Strategies of values and documents, made from a JSON schema."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from hypothesis import strategies as st

Schema = dict[str, Any]

_UNITS = [
    "mm",
    "um",
    "m",
    "N",
    "kN",
    "N/um",
    "N/m",
    "MPa",
    "GPa",
    "kg",
    "g",
    "Hz",
    "kHz",
    "rpm",
    "1/s",
    "rad/s",
    "deg",
    "rad",
    "s",
    "ms",
    "%",
    "W",
    "N*s/m",
    "m/s",
]
#: words that programs stumble over: marks of formulas, markup, paths, formats and other alphabets
_WORDS = (
    "",
    " ",
    "nan",
    "inf",
    "-",
    "=1+1",
    "<b>",
    "../..",
    "%s",
    "{0}",
    "\u202e",
    "ä" * 40,
    "x" * 5000,
)
_text = st.sampled_from(_WORDS) | st.text(
    st.characters(exclude_categories=("Cs", "Cc")), max_size=12
)
_wild_number = st.one_of(
    st.sampled_from([0, -1, 1, 10**6, 10**9, 2**31, 2**63, -(2**63), 10**400]),
    st.sampled_from([0.0, -0.0, 1e300, -1e300, 1e-300, 5e-324, float("inf"), float("nan")]),
    st.floats(),
    st.integers(-(10**20), 10**20),
)
_wild_quantity = st.builds("{} {}".format, _wild_number, st.sampled_from(_UNITS))
#: values that fit nothing
WILD = st.recursive(
    st.one_of(_wild_number, _wild_quantity, _text, st.booleans()),
    lambda one: st.lists(one, max_size=3) | st.dictionaries(_text, one, max_size=2),
    max_leaves=4,
)
_MOST_ENTRIES = 4


def resolved(node: Schema, root: Schema) -> Schema:
    """Node of a schema with its reference followed."""
    while "$ref" in node:
        name = node["$ref"].rpartition("/")[2]
        node = {**root["$defs"][name], **{k: v for k, v in node.items() if k != "$ref"}}
    return node


def alternatives(node: Schema, root: Schema) -> Iterator[Schema]:
    """Nodes that a value may follow, with references followed."""
    node = resolved(node, root)
    choices = [*node.get("anyOf", []), *node.get("oneOf", [])]
    # a table may say by alternatives which keys go together
    rest = {key: value for key, value in node.items() if key not in ("anyOf", "oneOf")}
    if not choices:
        yield node
    for one in choices:
        for each in alternatives(one, root):
            required = [*rest.get("required", []), *each.get("required", [])]
            yield {**rest, **each, **({"required": required} if required else {})}


@st.composite
def _near(draw: st.DrawFn, least: float, most: float, around: float) -> float:
    """Number within bounds, mostly of the magnitude of an example, at times at a bound."""
    decades = draw(st.floats(-2.0, 2.0) | st.floats(-12.0, 12.0))
    value = around * 10.0**decades
    value = draw(st.sampled_from([value, value, value, -value, least, most, 0.0]))
    return min(max(value, least), most)


def _number(node: Schema) -> st.SearchStrategy[Any]:
    least = node.get("minimum", node.get("exclusiveMinimum", -1e18))
    most = node.get("maximum", node.get("exclusiveMaximum", 1e18))
    around = node.get("default", 1.0)
    around = around if isinstance(around, (int, float)) and around else 1.0
    if node["type"] == "integer":
        near = st.integers(int(least), int(min(most, max(least, 0) + 10)))
        return near | st.integers(int(least), int(most))
    return _near(least, most, around)


@st.composite
def _quantity(draw: st.DrawFn, example: str) -> str:
    """Quantity as in an example, of another magnitude, at times of another unit."""
    number, _, unit = example.partition(" ")
    try:
        around = float(number)
    except ValueError:
        return example
    value = draw(_near(-1e300, 1e300, around))
    unit = draw(st.sampled_from([unit] * 9 + _UNITS[:3]))
    return f"{value:.6g} {unit}".strip()


def _string(node: Schema) -> st.SearchStrategy[str]:
    examples = node.get("examples", [])
    return st.sampled_from(examples).flatmap(_quantity) if examples else _text


def _array(node: Schema, root: Schema) -> st.SearchStrategy[list]:
    if "prefixItems" in node:
        return st.tuples(*(values(one, root) for one in node["prefixItems"])).map(list)
    least = node.get("minItems", 0)
    most = min(node.get("maxItems", least + _MOST_ENTRIES), least + _MOST_ENTRIES)
    return st.lists(values(node.get("items", {}), root), min_size=least, max_size=most)


@st.composite
def _object(draw: st.DrawFn, node: Schema, root: Schema) -> dict[str, Any]:
    """Table with what is required and a few of the other keys."""
    properties, required = node.get("properties", {}), node.get("required", [])
    others = [key for key in properties if key not in required]
    chosen = draw(st.sets(st.sampled_from(others), max_size=4)) if others else set()
    found = {key: draw(values(properties[key], root)) for key in (*required, *sorted(chosen))}
    more = node.get("additionalProperties")
    if isinstance(more, dict):
        names = draw(st.lists(st.sampled_from(["X", "Y", "spindle", ""]), max_size=2, unique=True))
        found.update({name: draw(values(more, root)) for name in names})
    return found


def values(node: Schema, root: Schema) -> st.SearchStrategy[Any]:
    """Values that a node of a schema allows, at times one that fits nothing."""
    fitting = st.one_of([_fitting(one, root) for one in alternatives(node, root)])
    return st.integers(0, 19).flatmap(lambda k: WILD if k == 0 else fitting)


def _fitting(node: Schema, root: Schema) -> st.SearchStrategy[Any]:
    if "enum" in node:
        return st.sampled_from(node["enum"])
    if "const" in node:
        return st.just(node["const"])
    kind = node.get("type")
    if kind == "object":
        return st.deferred(lambda: _object(node, root))
    if kind == "array":
        return st.deferred(lambda: _array(node, root))
    if kind in ("number", "integer"):
        return _number(node)
    if kind == "boolean":
        return st.booleans()
    return _string(node) if kind == "string" else WILD


@st.composite
def documents(draw: st.DrawFn, schema: Schema) -> dict[str, Any]:
    """Whole documents: two thirds of the sections that the schema has, and all that it requires."""
    properties, required = schema.get("properties", {}), schema.get("required", [])
    return {
        key: draw(values(node, schema))
        for key, node in properties.items()
        if key in required or draw(st.integers(0, 2))
    }
