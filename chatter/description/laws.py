"""Force laws and friction laws: those of this project and those of installed packages."""

from __future__ import annotations

from chatter.description.registry import Registry
from cutting.force import laws as force_laws
from cutting.force.law import ForceLawEntry
from dynamics.friction import laws as friction_laws
from dynamics.friction.law import FrictionLawEntry

FORCE_LAWS: Registry[ForceLawEntry] = Registry(
    group="chatter.force_laws", what="force law", built_in=force_laws.LAWS
)
FRICTION_LAWS: Registry[FrictionLawEntry] = Registry(
    group="chatter.friction_laws", what="friction law", built_in=friction_laws.LAWS
)

for _force_law in FORCE_LAWS:
    force_laws.include(_force_law)
for _friction_law in FRICTION_LAWS:
    friction_laws.include(_friction_law)
