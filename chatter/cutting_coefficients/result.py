"""What the mean forces of cuts say about the force law: table, [material], picture."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import tomlkit

from chatter.compile.cutter import cutter_of
from chatter.cutting_coefficients.coefficient_units import unit_of
from chatter.cutting_coefficients.feed_series import position_among
from chatter.cutting_coefficients.fit import FittedLaw
from chatter.cutting_coefficients.laws import DIRECTION_NAMES
from chatter.cutting_coefficients.mean_forces import MeanForce, channels_of
from chatter.cutting_coefficients.notes import notes_on
from chatter.cutting_coefficients.number_of_cuts import number_of_cuts
from chatter.cutting_coefficients.oblique_fit import ObliqueFit, oblique_fit
from chatter.cutting_coefficients.own_table import add_row
from chatter.cutting_coefficients.predicted_cuts import each_by_the_others, of_measurement
from chatter.cutting_coefficients.prediction import PredictedCut
from chatter.cutting_coefficients.waveforms import Waveforms, waveforms
from chatter.description.arrays import Array
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.formatting import to_digits
from chatter.description.unit_system import UnitSystem, units_of
from chatter.explain.measurement import Measurement
from chatter.io.presentation import presentation
from chatter.io.result_files import (
    NotebookResult,
    as_json,
    finite_or_none,
    short_repr,
    write_results,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: coefficients of the linear law with edge forces in all three directions
_LINEAR_KEYS = 6
#: normal rake that a milling cutter has less than, rad
_MOST_RAKE = 0.25 * math.pi
#: radial force over the tangential one by which a sharp edge draws itself into the work at the most
_MOST_PULL = 0.5


@dataclass(frozen=True, eq=False, repr=False)
class Coefficients(NotebookResult):
    """Cutting coefficients of a series of cuts.

    Parameters
    ----------
    measurement : Measurement
    means : tuple of MeanForce
    fits : tuple of FittedLaw
        Of all laws that the cuts determine.
    kept : FittedLaw
    holdout : dict of str to float, or None
        Error of the mean forces of each cut by the law fitted to the others, over their size.
    by_direction : FittedLaw, optional
        Law of which every direction has its own form, a line or a power.
    holdout_by_direction : dict of str to float, or None
        Error by that law of each cut, fitted to the others.
    kept_apart : Measurement, optional
        Cuts that were not fitted.
    zeroed : bool
        Whether the air before or after every cut showed the offsets, and they are taken off.
    waveforms : Waveforms, optional
        What the whole waveforms say; see `with_waveforms`.
    predicted_cuts : tuple of PredictedCut
        Cuts that were not fitted, with their forces by the others.
    oblique : ObliqueFit, optional
        Oblique law; see `with_rake`.
    """

    measurement: Measurement
    means: tuple[MeanForce, ...]
    fits: tuple[FittedLaw, ...]
    kept: FittedLaw
    holdout: dict[str, float] | None
    by_direction: FittedLaw | None
    holdout_by_direction: dict[str, float] | None
    kept_apart: Measurement | None = None
    zeroed: bool = False
    waveforms: Waveforms | None = None
    predicted_cuts: tuple[PredictedCut, ...] = ()
    oblique: ObliqueFit | None = None

    def with_waveforms(self) -> Coefficients:
        """Return the same with the whole waveforms fitted beside the mean forces.

        Raises
        ------
        InputError
            If the waveforms cannot be used.
        """
        found = waveforms(self.measurement, zeroed=self.zeroed)
        given = (self.law_of_means, self.means, self._cases, found.kept)
        apart = self.kept_apart
        return replace(
            self,
            waveforms=replace(found, holdout=each_by_the_others(*given)),
            predicted_cuts=() if apart is None else of_measurement(apart, *given),
        )

    def with_rake(self, rake: float) -> Coefficients:
        """Return the same with the oblique law fitted for a normal rake, rad.

        Raises
        ------
        InputError
            If no linear law with edge forces was fitted, or the rake is no rake.
        """
        where = self.measurement.folder
        if not abs(rake) < _MOST_RAKE:
            raise InputError(
                f"{where}: a normal rake of {math.degrees(rake):g} deg; it lies between -45 and 45"
            )
        linear = self._linear_fit()
        if linear is None or linear[0].size < _LINEAR_KEYS or linear[0][0] <= 0.0:
            raise InputError(
                f"{where}: the oblique law follows from the linear one, which the records do not "
                "determine; forces along x, y and z of two feeds do"
            )
        helix = cutter_of(self.measurement.case).helix[0]
        return replace(self, oblique=oblique_fit(*linear, rake, helix, self.units))

    def _linear_fit(self) -> tuple[Array, Array] | None:
        """Coefficients (6,) of the linear law and their covariance, by what the answer is from."""
        if self.waveforms is not None and self.by_waveforms:
            return self.waveforms.linear_fit()
        linear = next((one for one in self.fits if one.law.name == "linear"), None)
        return None if linear is None else (linear.values, linear.covariance)

    @cached_property
    def units(self) -> UnitSystem:
        """Units of the case: coefficients are written in them."""
        return units_of(self.measurement.case)

    @property
    def _cases(self) -> dict[str, Case]:
        return {run.name: run.of(self.measurement.case) for run in self.measurement.runs}

    @property
    def law_of_means(self) -> FittedLaw:
        """Law by which mean forces are predicted: of forms of their own where no line holds."""
        if self._line_fits_means is False and self.by_direction is not None:
            return self.by_direction
        return self.kept

    @property
    def by_waveforms(self) -> bool:
        """Whether the coefficients are those of the waveforms.

        They tell offsets and runout from the law, but need a tool that does not vibrate, and
        forces of the chip that vary.
        """
        found = self.waveforms
        if found is None or found.hides_chip_forces:
            return False
        return found.tool_is_rigid and found.has_material

    def __repr__(self) -> str:
        """Short: what it holds would fill the screen."""
        return short_repr(self)

    @property
    def material(self) -> dict[str, object]:
        """Section [material] in SI."""
        if self.waveforms is not None and self.by_waveforms:
            return self.waveforms.material
        return self.kept.law.section(self.kept.values, self.kept.exponents)

    @property
    def origin(self) -> str:
        """What the coefficients are from."""
        return "waveforms" if self.by_waveforms else "mean forces"

    @property
    def answer_law(self) -> FittedLaw:
        """Law of the answer."""
        if self.waveforms is not None and self.by_waveforms:
            return self.waveforms.as_fitted_law()
        return self.kept

    @property
    def law_name(self) -> str:
        """Law of the answer as the report calls it."""
        return self.answer_law.law.name

    def offset_of(self, mean: MeanForce) -> float:
        """Offset that the waveforms show in a mean force, where the answer is from them, N."""
        if self.waveforms is not None and self.by_waveforms:
            return self.waveforms.offset(mean.run, mean.channel)
        return 0.0

    @property
    def has_material(self) -> bool:
        """Whether the law cuts: by its tangential force, and without a large radial pull."""
        return self.by_waveforms or (self._tangential > 0.0 and not self.pulls_at_the_work)

    @property
    def _tangential(self) -> float:
        """Tangential coefficient of the mean forces, SI."""
        return float(self.kept.values[0])

    @property
    def pulls_at_the_work(self) -> bool:
        """Whether the radial force draws the tool into the work as no chip does."""
        found = dict(zip(self.kept.law.keys, self.kept.values, strict=True))
        return bool(found.get("Krc", 0.0) < -_MOST_PULL * self._tangential < 0.0)

    @property
    def linear_law_holds(self) -> bool | None:
        """Whether the linear law holds, by what the coefficients are from; None if not fitted.

        By waveforms: no other law is better by strong evidence. By mean forces: it leaves no more
        than the readings scatter.
        """
        if self.waveforms is not None and self.by_waveforms:
            return self.waveforms.linear_law_holds
        return self._line_fits_means

    @property
    def _line_fits_means(self) -> bool | None:
        linear = next((one for one in self.fits if one.law.name == "linear"), None)
        more = None if linear is None else linear.leaves_more_than_scatter(len(self.means))
        return None if more is None else not more

    def worst_means(self) -> dict[str, float]:
        """Worst error of the mean forces of a cut held out, by its feed among those of the others.

        Between them, beyond them, or as they are where the feed does not vary.
        """
        feeds = {name: case.cut.feed_per_tooth for name, case in self._cases.items()}
        found: dict[str, float] = {}
        for name, error in (self.holdout or {}).items():
            place = position_among(feeds[name], list(feeds.values()))
            found[place] = max(found.get(place, 0.0), error)
        return found

    def summary(self) -> dict[str, Any]:
        """Content of coefficients.json."""
        answer: dict[str, Any] = {
            "from": "mean forces",
            "law": self.kept.law.name,
            "coefficients": self._coefficients(self.kept),
            "exponents": self._exponents(self.kept),
        }
        by_mean_forces = {key: answer[key] for key in ("law", "coefficients", "exponents")}
        if self.waveforms is not None and self.by_waveforms:
            answer = {"from": "waveforms", **self.waveforms.answer()}
        return {
            **answer,
            "by_mean_forces": by_mean_forces,
            "by_direction": self._by_direction(),
            "signs": self.kept.signs,
            "linear_law_holds": self.linear_law_holds,
            "laws": [self._compared(one) for one in self.fits],
            "holdout_error": self.holdout,
            "mean_forces": [
                {
                    "run": one.run,
                    "channel": one.channel,
                    "measured_N": one.value,
                    "standard_deviation_N": one.deviation,
                    "predicted_N": float(predicted),
                    "revolutions": one.revolutions,
                }
                for one, predicted in zip(self.means, self.kept.predicted, strict=True)
            ],
            "waveforms": None if self.waveforms is None else self.waveforms.summary(),
            "oblique": None if self.oblique is None else self.oblique.summary(),
            "not_fitted": {one.average.run: one.errors() for one in self.predicted_cuts},
            "notes": self.notes,
        }

    @property
    def notes(self) -> list[str]:
        """What the reader should know."""
        return notes_on(self)

    def lengths(self, value: float, *others: float) -> str:
        """Return lengths, m, in the unit of the case: "0.05 to 0.2 mm"."""
        unit = self.units.length
        return " to ".join(f"{one * unit.factor:.4g}" for one in (value, *others)) + f" {unit.name}"

    def straightness(self) -> dict[str, float]:
        """Share r^2 of the variance of each channel over the cuts that the linear law explains."""
        linear = next((one for one in self.fits if one.law.name == "linear"), None)
        if linear is None:
            return {}
        found = {}
        for name in channels_of(self.means):
            chosen = np.array([one.channel == name for one in self.means])
            measured = np.array([one.value for one in self.means])[chosen]
            variance = float(np.sum((measured - measured.mean()) ** 2))
            left = float(np.sum((measured - linear.predicted[chosen]) ** 2))
            if variance > 0.0:
                found[name] = 1.0 - left / variance
        return found

    def _by_direction(self) -> dict[str, Any] | None:
        one = self.by_direction
        if one is None:
            return None
        forms = {
            name: "line" if number < 0 else "power"
            for name, number in zip(DIRECTION_NAMES, one.law.exponents, strict=True)
        }
        return {
            "forms": forms,
            "coefficients": self._coefficients(one),
            "exponents": self._exponents(one),
            "chi_square": one.chi_square,
            "holdout_error": self.holdout_by_direction,
        }

    def _coefficients(self, fit: FittedLaw) -> list[dict[str, Any]]:
        return [
            {
                "name": key,
                "value": float(value) * unit_of(key, self.units).factor,
                "standard_deviation": float(deviation) * unit_of(key, self.units).factor,
                "unit": unit_of(key, self.units).name,
            }
            for key, value, deviation in zip(fit.law.keys, fit.values, fit.deviations, strict=False)
        ]

    def _exponents(self, fit: FittedLaw) -> list[dict[str, Any]]:
        deviations = fit.deviations[len(fit.law.keys) :]
        return [
            {
                "of": fit.law.directions_of(number),
                "value": float(value),
                "standard_deviation": float(deviation),
            }
            for number, (value, deviation) in enumerate(zip(fit.exponents, deviations, strict=True))
        ]

    def _compared(self, one: FittedLaw) -> dict[str, Any]:
        count = len(self.means)
        freedom = count - one.law.parameters
        return {
            "law": one.law.name,
            "chi_square_over_freedom": finite_or_none(
                one.chi_square / freedom if freedom > 0 else float("nan")
            ),
            "criterion": finite_or_none(one.criterion(count)),
        }

    def material_toml(self) -> str:
        """[material] section of a case file."""
        if self.waveforms is not None and self.by_waveforms:
            return self.waveforms.material_toml()
        section = tomlkit.table()
        for key, value in self._row().items():
            section.add(key, value)
        document = tomlkit.document()
        cuts = number_of_cuts(len(self.measurement.runs))
        document.add(tomlkit.comment(f"{self.kept.law.name} law, mean forces of {cuts}"))
        if self.linear_law_holds is False and self.kept.law.law == "linear":
            document.add(tomlkit.comment("the linear law leaves more than the readings scatter"))
        if np.any(self.kept.values[self.kept.law.cutting] < 0.0):
            document.add(tomlkit.comment("a cutting coefficient is below zero: check the channels"))
        document.add("material", section)
        return tomlkit.dumps(document)

    def _row(self) -> dict[str, Any]:
        """Keys and values of [material], in usual units."""
        if self.waveforms is not None and self.by_waveforms:
            return self.waveforms.row()
        row: dict[str, Any] = {"law": self.kept.law.law}
        for one in self._coefficients(self.kept):
            row[one["name"]] = (
                f"{one['value']:.5g} +- {to_digits(one['standard_deviation'])} {one['unit']}"
            )
        if self.kept.exponents.size:
            keys = self.kept.law.exponent_keys(self.kept.exponents)
            row |= {key: round(power, 5) for key, power in keys.items()}
            row["h0"] = "0.1 mm"
        return row

    def keep_in(self, table: str | Path, name: str) -> Path:
        """Add the coefficients to a table of materials, where cases find them by name.

        Raises
        ------
        InputError
            If there is a row of that name, the file is no table of materials, or the law does not
            cut.
        """
        if not self.has_material:
            raise InputError(
                f"{self.measurement.folder}: no row is kept: the forces do not cut; a direction "
                "or a sense may be wrong, or channels exchanged"
            )
        case = self.measurement.case
        feeds = [run.of(case).cut.feed_per_tooth for run in self.measurement.runs]
        folder = self.measurement.folder.resolve().name
        source = f"{self.origin} of {number_of_cuts(len(feeds))}, {folder}"
        validity = f"feeds of {self.lengths(min(feeds), max(feeds))} a tooth"
        return add_row(table, name, {**self._row(), "source": source, "validity": validity})

    def plot(self) -> Figure:
        """Picture of mean forces over the cuts, and the laws."""
        return presentation("plots.coefficients").plot_coefficients(self)

    def save(self, folder: str | Path) -> list[Path]:
        """Write coefficients.json, material.toml and coefficients.png; of waveforms theirs too."""
        texts = {"coefficients.json": as_json(self.summary())}
        if self.has_material:
            texts["material.toml"] = self.material_toml()
        if self.oblique is not None:
            texts["material-oblique.toml"] = self.oblique.material_toml()
        pictures = {"coefficients.png": self.plot()}
        if self.waveforms is not None:
            if self.waveforms.has_material:
                texts["material-waveforms.toml"] = self.waveforms.material_toml()
            pictures["waveforms.png"] = presentation("plots.force_waveforms").plot_waveforms(
                self.waveforms, self.predicted_cuts
            )
        return write_results(folder, texts, pictures)
