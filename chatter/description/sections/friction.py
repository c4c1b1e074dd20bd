"""[friction.NAME]: friction on the modes of the structure that name it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pydantic import model_validator

from chatter.description.law_section import FRICTION_LAWS, LawSection, law_section
from chatter.description.quantities import quantity
from chatter.description.section import SectionError
from dynamics.friction.law import FrictionLaw


class FrictionLawSection(LawSection):
    """A friction law and its parameters, in a case or a machine."""

    LAWS = FRICTION_LAWS

    @model_validator(mode="after")
    def _check_law(self) -> FrictionLawSection:
        try:
            self.spec()
        except ValueError as error:
            raise SectionError([("", str(error))]) from None
        return self

    def spec(self) -> FrictionLaw:
        """The law, SI."""
        return self.LAWS[self.law].of(self.values)


def friction_section(default: str | None, field_type: Callable[..., Any]) -> Any:
    """Make the base of a section with a friction law; see `law_section`."""
    return law_section(FrictionLawSection, default, field_type)


_Keys: Any = friction_section("coulomb-stribeck", quantity)


class Friction(_Keys):
    """Friction of a guide or drive."""
