"""Frictions of [friction.NAME] on the modes that name them."""

from __future__ import annotations

from collections.abc import Callable

from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.sections.process import Friction
from dynamics.friction.coulomb_stribeck import CoulombStribeck
from dynamics.friction.laws import FrictionLaw, friction_groups
from dynamics.friction.lugre import LuGre
from dynamics.friction.smooth_coulomb import SmoothCoulomb
from dynamics.friction.tanh_hysteresis import TanhHysteresis

#: Stribeck velocity of a friction without a Stribeck curve, m/s: it changes nothing
_ANY = 1.0


def _coulomb(section: Friction) -> FrictionLaw:
    return CoulombStribeck(section.coulomb, section.coulomb, _ANY, section.viscous or 0.0)


def _coulomb_stribeck(section: Friction) -> FrictionLaw:
    return CoulombStribeck(
        section.coulomb, section.static, section.stribeck_velocity, section.viscous or 0.0
    )


def _smooth_coulomb(section: Friction) -> FrictionLaw:
    return SmoothCoulomb(section.coulomb, section.smoothing_velocity, section.viscous or 0.0)


def _tanh(section: Friction) -> FrictionLaw:
    # the slope at a reversal is twice the inclination times the force
    inclination = section.presliding_stiffness / (2.0 * section.coulomb)
    return TanhHysteresis(
        coulomb=section.coulomb,
        viscous=section.viscous or 0.0,
        slow_viscous=0.0,
        slow_decay=0.0,
        inclination=inclination,
    )


def _lugre(section: Friction) -> FrictionLaw:
    return LuGre(
        stiffness=section.sigma0,
        bristle_damping=section.sigma1 or 0.0,
        viscous=section.sigma2 or 0.0,
        coulomb=section.coulomb,
        static=section.static,
        stribeck_velocity=section.stribeck_velocity,
    )


#: law in a case file -> its specification, and the keys that it needs
LAWS: dict[str, tuple[Callable[[Friction], FrictionLaw], tuple[str, ...]]] = {
    "coulomb": (_coulomb, ("coulomb",)),
    "smooth-coulomb": (_smooth_coulomb, ("coulomb", "smoothing_velocity")),
    "coulomb-stribeck": (_coulomb_stribeck, ("coulomb", "static", "stribeck_velocity")),
    "tanh": (_tanh, ("coulomb", "presliding_stiffness")),
    "lugre": (_lugre, ("coulomb", "static", "stribeck_velocity", "sigma0")),
}


def friction_law(case: Case, name: str) -> FrictionLaw:
    """Law of a section [friction.NAME].

    Raises
    ------
    InputError
        If it lacks a key of its law, or a number is out of its range.
    """
    section = case.friction[name]
    made, needed = LAWS[section.law]
    where = f"{case.name}: friction.{name}"
    missing = [key for key in needed if getattr(section, key) is None]
    if missing:
        raise InputError(
            [f'{where}.{key}: is missing; law = "{section.law}" needs it' for key in missing]
        )
    if section.law == "tanh" and not section.coulomb > 0.0:
        raise InputError(f"{where}.coulomb: must be above 0 N")
    try:
        return made(section)
    except ValueError as error:
        raise InputError(f"{where}: {error}") from None


def mode_frictions(case: Case) -> tuple:
    """Tables of the frictions of the modes of a case at rest; ports are numbers of modes."""
    modes = case.structure.mode if case.structure is not None else ()
    rubbing = [place for place, mode in enumerate(modes) if mode.friction is not None]
    return friction_groups([friction_law(case, modes[i].friction) for i in rubbing], rubbing)
