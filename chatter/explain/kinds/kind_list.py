"""Kinds of measurement by name: where a new one joins."""

from chatter.explain.kinds.axis import Axis
from chatter.explain.kinds.drive import Drive
from chatter.explain.kinds.frf import FrequencyResponse
from chatter.explain.kinds.kind import Kind
from chatter.explain.kinds.milling import Milling
from chatter.explain.kinds.set_up import SetUp
from chatter.explain.kinds.stability import Stability

#: kinds of which a part of a set-up may be
OF_PARTS: dict[str, Kind] = {
    kind.name: kind for kind in (Milling(), Axis(), Stability(), FrequencyResponse(), Drive())
}
#: kind of a move of a case on a machine, in the place of an axis by itself
ON_MACHINE: dict[str, str] = {Axis.name: Drive.name}
KINDS: dict[str, Kind] = {**OF_PARTS, SetUp.name: SetUp(OF_PARTS)}
