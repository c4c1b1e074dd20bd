"""Force laws and friction laws: those of this project and those of installed packages."""

from __future__ import annotations

from chatter.description.registry import Registry
from dynamics.friction import laws as friction_laws
from dynamics.friction.law import FrictionLawEntry

FRICTION_LAWS: Registry[FrictionLawEntry] = Registry(
    group="chatter.friction_laws", what="friction law", built_in=friction_laws.LAWS
)

for _law in FRICTION_LAWS:
    friction_laws.include(_law)
