"""What the moves of a drive say about its friction: table, [friction.NAME], picture."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import tomlkit

from chatter.description.formatting import to_digits
from chatter.drive_friction.drive_records import DriveRecords
from chatter.drive_friction.friction_laws import FitSettings, FittedFriction
from chatter.drive_friction.limited_effort import UNEXPLAINED, FlatTops, unexplained
from chatter.io.presentation import presentation
from chatter.io.result_files import NotebookResult, as_json, finite_or_none, write_results
from dynamics.frf.container import MeasurementError
from dynamics.friction.identification.steady_state import SteadyPoint, constant_speed_points

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: parameter -> unit along the slide, and about the motor
UNITS = {
    "inertia": ("kg", "kg*m^2"),
    "viscous": ("N*s/m", "N*m*s/rad"),
    "coulomb": ("N", "N*m"),
    "static": ("N", "N*m"),
    "offset": ("N", "N*m"),
    "stribeck_velocity": ("m/s", "rad/s"),
    "bristle_stiffness": ("N/m", "N*m/rad"),
    "bristle_damping": ("N*s/m", "N*m*s/rad"),
}
#: law that is tried -> law of a machine file
_IN_FILES = {
    "viscous": "coulomb-stribeck",
    "coulomb": "coulomb-stribeck",
    "stribeck": "coulomb-stribeck",
    "lugre": "lugre",
}
#: condition number of the linear fit from which its terms resemble each other
_ALIKE = 20.0
#: s at constant speed that make a point of the friction curve, after what the low-pass blurs
_CONSTANT = 0.1
#: share of the variance of a derived acceleration that is noise, worth telling
_NOISY = 0.02


@dataclass(frozen=True)
class TriedFriction:
    """A law that was tried on the records."""

    name: str
    fit: FittedFriction | None  # none where the records do not determine it
    holdout: float | None  # error of parts held out, over the deviation of the effort
    reason: str = ""  # why there is no fit


@dataclass(frozen=True, eq=False, repr=False)
class DriveFriction(NotebookResult):
    """Friction and inertia of a drive."""

    given: DriveRecords
    settings: FitSettings
    tried: tuple[TriedFriction, ...]
    kept: FittedFriction
    other_cutoffs: Mapping[float, FittedFriction]  # Hz -> the same law with that low-pass
    name: str  # of the axis
    flat_tops: FlatTops | None = None  # of the effort, as at the limit of a drive
    #: what the records say with the first low-pass and all samples, where that explains less
    instead_of: DriveFriction | None = None

    def __repr__(self) -> str:
        """Short: what it holds would fill the screen."""
        return f"<DriveFriction {self.kept.name}, {len(self.given.records)} records>"

    def unit(self, parameter: str) -> str:
        """Unit of a parameter of the records."""
        return UNITS[parameter][self.given.rotary]

    @property
    def residual(self) -> float:
        """Rms of what the kept law leaves of the low-passed effort, over its deviation."""
        low_pass = self.settings.low_pass
        left, whole = [], []
        for record in self.given.records:
            effort = low_pass.apply(record.effort, record.sample_time)
            judged = ~record.near_excluded(low_pass.settling)
            left.append((self.kept.effort(record, low_pass) - effort)[judged])
            whole.append(effort[judged])
        return float(np.sqrt(np.mean(np.concatenate(left) ** 2)) / np.std(np.concatenate(whole)))

    @property
    def unexplained(self) -> float:
        """Rms of what the kept law leaves of the effort of moving samples, over that of it."""
        return unexplained(self.kept, self.given.records, self.settings)

    @cached_property
    def constant_speeds(self) -> tuple[SteadyPoint, ...]:
        """Mean effort of the stretches at constant speed, which no law has a part in."""
        found: list[SteadyPoint] = []
        low_pass = self.settings.low_pass
        for record in self.given.records:
            if record.excluded is not None:
                continue
            with contextlib.suppress(MeasurementError):  # it has no such stretch
                found += constant_speed_points(
                    record,
                    low_pass=low_pass,
                    minimum_duration=_CONSTANT,
                    settling=low_pass.settling,
                    minimum_speed=self.settings.minimum_speed,
                )
        return tuple(found)

    def _at_constant_speed(self) -> list[dict[str, float]]:
        """Friction at constant speed as it was measured, and by the law kept."""
        return [
            {
                "velocity": one.velocity,
                "friction": one.effort - self.kept.offset,
                "standard_error": one.standard_error,
                "by_law": float(self.kept.law.steady_state_force(np.array([one.velocity]))[0]),
            }
            for one in self.constant_speeds
        ]

    def summary(self) -> dict[str, Any]:
        """Content of friction.json."""
        return {
            "law": self.kept.name,
            "records": [record.name for record in self.given.records],
            "motion": "about the motor" if self.given.rotary else "along the slide",
            "parameters": [
                {
                    "name": name,
                    "value": one.value,
                    "standard_error": finite_or_none(one.standard_error),
                    "ci95": [finite_or_none(one.lower), finite_or_none(one.upper)],
                    "unit": self.unit(name),
                    "decided": name not in self.kept.undecided,
                }
                for name, one in self.kept.estimates.items()
            ],
            "inertia_given": self.settings.inertia,
            "inertia_declared": self.given.declared_inertia,
            "residual": self.residual,
            "unexplained": self.unexplained,
            "effort_flat_at": None if self.flat_tops is None else self.flat_tops.level,
            "low_pass_Hz": self.settings.low_pass.cutoff,
            "minimum_speed": self.settings.minimum_speed,
            "laws": [
                {"law": one.name, "holdout_error": one.holdout, "reason": one.reason or None}
                for one in self.tried
            ],
            "other_low_passes": [
                {
                    "low_pass_Hz": cutoff,
                    "parameters": {name: one.value for name, one in fit.estimates.items()},
                }
                for cutoff, fit in self.other_cutoffs.items()
            ],
            "constant_speed": self._at_constant_speed(),
            "notes": self.notes,
        }

    @property
    def notes(self) -> list[str]:
        """What the reader should know."""
        notes = [*self._not_to_be_used(), *self._explained_otherwise()]
        if self.kept.undecided:
            notes.append(
                f"the records do not decide {', '.join(self.kept.undecided)}: the interval spans "
                "more than a decade"
            )
        linear = self.kept.linear
        if linear is not None and linear.conditioning > _ALIKE:
            notes.append(
                "the moves hardly tell inertia and friction apart: weigh it and give it by "
                "--inertia, or record both directions at several speeds"
            )
        if linear is not None and linear.attenuation > _NOISY:
            notes.append(
                f"noise of the velocity makes the inertia about {linear.attenuation:.0%} too small"
            )
        notes += self._wrong_signs()
        notes += self._moved_by_the_filter()
        if "offset" not in self.kept.estimates:
            notes.append(
                "the moves go one way only: an offset, such as weight, counts as Coulomb friction"
            )
        return notes

    def _not_to_be_used(self) -> list[str]:
        share = self.unexplained
        if share <= UNEXPLAINED:
            return []
        told = f"{share:.0%} of the effort is unexplained: these values are not to be used"
        if self.flat_tops is not None:
            told += f"; {self._flat()}, as at the limit of the drive"
            told += ": record slower moves or give a lower --low-pass"
        return [told]

    def _explained_otherwise(self) -> list[str]:
        if self.instead_of is None:
            return []
        before, after = self.instead_of, f"{self.unexplained:.0%} of the effort is unexplained"
        if any(one.excluded is not None for one in self.given.records):
            return [
                f"{self._flat()} where the law of the other samples asks for more: left out, as "
                f"cut by a limit; {after}, with them {before.unexplained:.0%}"
            ]
        low, high = (one.settings.low_pass.cutoff for one in (self, before))
        told = self.flat_tops is None or bool(self._not_to_be_used())
        flat = "" if told else f"{self._flat()}, as at the limit of the drive; "
        return [
            f"{flat}the axis vibrates beyond what the effort tells: below {low:g} Hz {after}, "
            f"below {high:g} Hz {before.unexplained:.0%}"
        ]

    def _flat(self) -> str:
        unit = self.unit("coulomb").replace("*", " ")
        tops = self.flat_tops
        return f"the effort is flat at {tops.level:.4g} {unit} in {tops.share:.0%} of the samples"

    def _wrong_signs(self) -> list[str]:
        found = self.kept.estimates
        if "inertia" in found and found["inertia"].upper < 0.0:
            return ["the inertia is below 0: the effort has the wrong sign, -HEADING turns it"]
        below = [name for name in ("viscous", "coulomb") if name in found and found[name].value < 0]
        return [
            f"{name} friction comes out below 0 and is written as 0; the records bear no more"
            for name in below
        ]

    def _moved_by_the_filter(self) -> list[str]:
        moved = []
        for name, one in self.kept.estimates.items():
            if name in self.kept.undecided:
                continue
            others = [fit.estimates[name].value for fit in self.other_cutoffs.values()]
            if any(not one.lower <= value <= one.upper for value in others):
                moved.append(name)
        if not moved:
            return []
        return [f"half or double the low-pass moves {', '.join(moved)} out of the interval"]

    def friction_toml(self) -> str:
        """[friction.NAME] of a machine file."""
        section = tomlkit.table()
        section.add("law", _IN_FILES[self.kept.name])
        for key, value in self._keys().items():
            section.add(key, value)
        on = tomlkit.inline_table()
        on["motor" if self.given.rotary else "axis"] = self.name
        section.add("on", on)
        parent = tomlkit.table(is_super_table=True)
        parent.add(self.name, section)
        document = tomlkit.document()
        names = ", ".join(record.name for record in self.given.records)
        document.add(tomlkit.comment(f"friction identified from {names}"))
        for note in self._not_to_be_used():
            document.add(tomlkit.comment(note))
        document.add("friction", parent)
        return tomlkit.dumps(document)

    def _keys(self) -> dict[str, str]:
        found = self.kept.estimates
        keys = {}
        for name in UNITS:
            if name in ("inertia", "offset") or not hasattr(self.kept.law, name):
                continue
            if name in found:
                value, error = max(found[name].value, 0.0), found[name].standard_error
                spread = f" +- {to_digits(error)}" if 0.0 < error < np.inf and value > 0.0 else ""
                keys[name] = f"{value:.5g}{spread} {self.unit(name)}"
            elif name == "coulomb":
                keys[name] = f"0 {self.unit(name)}"
        return keys

    def plot(self) -> Figure:
        """Picture of effort over time, and of friction over velocity and position."""
        return presentation("plots.drive_friction").plot_drive_friction(self)

    def save(self, folder: str | Path) -> list[Path]:
        """Write friction.json, friction.toml and friction.png."""
        texts = {"friction.json": as_json(self.summary()), "friction.toml": self.friction_toml()}
        return write_results(folder, texts, {"friction.png": self.plot()})
