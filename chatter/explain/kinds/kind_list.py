"""Kinds of measurement by name: where a new one joins."""

from chatter.explain.kinds.axis import Axis
from chatter.explain.kinds.frf import FrequencyResponse
from chatter.explain.kinds.kind import Kind
from chatter.explain.kinds.milling import Milling
from chatter.explain.kinds.stability import Stability

KINDS: dict[str, Kind] = {
    kind.name: kind for kind in (Milling(), Axis(), Stability(), FrequencyResponse())
}
