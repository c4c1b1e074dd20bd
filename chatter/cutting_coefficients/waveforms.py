"""Coefficients from whole waveforms: the fits compared, cuts held out, what is written."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import tomlkit

from chatter.cutting_coefficients.coefficient_units import unit_of
from chatter.cutting_coefficients.feed_series import position_among
from chatter.cutting_coefficients.fit import FittedLaw
from chatter.cutting_coefficients.laws import LAWS, REFERENCE_CHIP
from chatter.cutting_coefficients.mean_forces import force_channels
from chatter.cutting_coefficients.number_of_cuts import number_of_cuts
from chatter.cutting_coefficients.prediction import PredictedCut, compared
from chatter.cutting_coefficients.revolution_average import RevolutionAverage, revolution_average
from chatter.cutting_coefficients.waveform_choice import waveform_fits
from chatter.cutting_coefficients.waveform_fit import WaveformFit
from chatter.cutting_coefficients.waveform_model import RUNOUT_UNIT, Complex
from chatter.description.arrays import Array
from chatter.description.formatting import to_digits
from chatter.description.unit_system import METRIC, UnitSystem, units_of
from chatter.explain.measurement import Measurement

#: share of the varying force above which a rigid tool is no model of the cut
_VIBRATES = 0.2
#: difference of the Bayesian criterion that is strong evidence (Kass and Raftery 1995)
_STRONG = 10.0


@dataclass(frozen=True, eq=False)
class Waveforms:
    """What the whole waveforms of a series of cuts say.

    Parameters
    ----------
    fits : tuple of WaveformFit
        Of all laws, the best first.
    holdout : tuple of PredictedCut
        Each cut by the others; empty of fewer than three.
    units : UnitSystem
        In which coefficients are written.
    """

    fits: tuple[WaveformFit, ...]
    holdout: tuple[PredictedCut, ...] = ()
    units: UnitSystem = METRIC

    @property
    def kept(self) -> WaveformFit:
        """Fit of the best law."""
        return self.fits[0]

    @property
    def linear_law_holds(self) -> bool:
        """Whether no other law is better by strong evidence."""
        effective = self.kept.effective
        linear = min(one.criterion(effective) for one in self.fits if one.model.law.law == "linear")
        return bool(linear - self.kept.criterion(effective) < _STRONG)

    @property
    def of_case(self) -> WaveformFit:
        """Fit of the best law; of one form for all directions where that one does not cut."""
        if _cuts(self.kept):
            return self.kept
        names = [law.name for law in LAWS]
        return next(one for one in self.fits if one.model.law.name in names)

    @property
    def has_material(self) -> bool:
        """Whether that law cuts: no cutting coefficient is below zero."""
        return _cuts(self.of_case)

    @property
    def material(self) -> dict[str, object]:
        """Section [material] in SI."""
        fit = self.of_case
        exponent = fit.model.split(fit.parameters, len(fit.averages))["exponent"]
        return fit.model.law.section(fit.coefficients, exponent)

    def linear_fit(self) -> tuple[Array, Array]:
        """Coefficients (6,) of the linear law with edge forces, and their covariance, SI."""
        fit = next(one for one in self.fits if one.model.law.name == "linear")
        return fit.coefficients, fit.coefficient_covariance

    def as_fitted_law(self) -> FittedLaw:
        """Best law of a case file as one that gives mean forces, without offsets."""
        fit = self.of_case
        return FittedLaw(
            fit.model.law,
            fit.coefficients,
            fit.model.split(fit.parameters, len(fit.averages))["exponent"],
            fit.coefficient_covariance,
            dict(fit.model.signs),
            np.empty(0),
            0.0,
        )

    def offset(self, run: str, channel: str) -> float:
        """Offset of a channel in a cut, as the waveforms show it, N."""
        return _offsets(self.of_case).get(run, {}).get(channel, 0.0)

    def answer(self) -> dict[str, Any]:
        """Law of a case file with its coefficients and exponents, as the mean forces give them."""
        fit = self.of_case
        names = fit.model.names(fit.averages)
        return {
            "law": fit.model.law.name,
            "coefficients": _coefficients(fit, self.units),
            "exponents": [
                {
                    "of": fit.model.law.directions_of(number),
                    "value": one["value"],
                    "standard_deviation": one["standard_deviation"],
                }
                for number, one in enumerate(_of_kind(fit, names, "exponent", 1.0, ""))
            ],
        }

    @property
    def most_left(self) -> float:
        """Largest share of the varying force of a channel that the fit leaves."""
        kept = self.kept
        return max(
            share
            for average, residual in zip(kept.averages, kept.residual, strict=True)
            for share in _left(average, residual)
        )

    def worst_peaks(self) -> dict[str, float]:
        """Worst error of a peak-to-peak force of cuts held out, between other feeds and beyond."""
        feeds = [one.average.case.cut.feed_per_tooth for one in self.holdout]
        found: dict[str, float] = {}
        for one, feed in zip(self.holdout, feeds, strict=True):
            place = position_among(feed, feeds)
            for channel in one.errors().values():
                ratio = channel["peak_to_peak_predicted_N"] / channel["peak_to_peak_N"]
                found[place] = max(found.get(place, 0.0), abs(ratio - 1.0))
        return found

    @property
    def tool_is_rigid(self) -> bool:
        """Whether a rigid tool and the dynamometer explain the varying force."""
        return self.most_left <= _VIBRATES

    @property
    def hidden(self) -> tuple[str, ...]:
        """Coefficients of the linear law that offsets hide; other laws have other ones for them."""
        return next(one for one in self.fits if one.model.law.name == "linear").hidden

    @property
    def hides_chip_forces(self) -> bool:
        """Whether offsets hide a cutting coefficient: the forces of the chip do not vary."""
        return any(key.endswith("c") for key in self.hidden)

    @property
    def notes_of_offsets(self) -> list[str]:
        """That offsets may be what is taken for cutting forces."""
        if not self.hidden:
            return []
        return [
            f"the waveforms do not tell {', '.join(self.hidden)} from an offset of the "
            "dynamometer: the sum over the teeth does not vary; record the air before the cut"
        ]

    @property
    def notes(self) -> list[str]:
        """What the reader should know."""
        notes = self.notes_of_offsets
        if not self.tool_is_rigid:
            notes.append(
                f"a rigid tool leaves up to {self.most_left:.0%} of the varying force: tool or "
                "workpiece vibrates, the deviations are too small, and the mean forces are the "
                "safer ones"
            )
        if not self.has_material:
            notes.append(
                "no [material] section is written from the waveforms: a cutting coefficient of the "
                f"{self.of_case.model.law.name} law is below zero"
            )
        return notes

    def summary(self) -> dict[str, Any]:
        """Part of coefficients.json."""
        kept = self.kept
        names = kept.model.names(kept.averages)
        return {
            "law": kept.model.law.name,
            "coefficients": _coefficients(kept, self.units),
            "exponents": _of_kind(kept, names, "exponent", 1.0, ""),
            "runout": _of_kind(
                kept,
                names,
                "runout",
                RUNOUT_UNIT * self.units.displacement.factor,
                self.units.displacement.name,
            ),
            "helix": _of_kind(kept, names, "helix", math.degrees(1.0), "deg"),
            "start_angles": _of_kind(kept, names, "start", math.degrees(1.0), "deg"),
            "resonances": _resonances(kept),
            "low_pass_Hz": _low_pass(kept),
            "offsets": _offsets(kept),
            "signs": dict(kept.model.signs),
            "tool_is_rigid": self.tool_is_rigid,
            "notes": self.notes,
            "independent_readings": float(kept.effective.sum()),
            "laws": [
                {
                    "law": one.model.law.name,
                    "criterion": float(one.criterion(kept.effective)),
                    "rms_left_N": one.rms_left,
                }
                for one in self.fits
            ],
            "cuts": [
                {
                    "run": one.run,
                    "spindle_speed_rpm": 30.0 * one.speed / math.pi,
                    "repeated": dict(zip(one.channels, map(float, one.repeated), strict=True)),
                    "left": dict(zip(one.channels, _left(one, left), strict=True)),
                    "channels": compared(one, one.amplitude + left),
                }
                for one, left in zip(kept.averages, kept.residual, strict=True)
            ],
            "holdout": {one.average.run: one.errors() for one in self.holdout},
        }

    def row(self) -> dict[str, Any]:
        """Keys and values of [material], by the best law that a case file may have."""
        fit = self.of_case
        row: dict[str, Any] = {"law": fit.model.law.law}
        for one in _coefficients(fit, self.units):
            row[one["name"]] = (
                f"{one['value']:.5g} +- {to_digits(one['standard_deviation'])} {one['unit']}"
            )
        exponent = fit.model.split(fit.parameters, len(fit.averages))["exponent"]
        if exponent.size:
            keys = fit.model.law.exponent_keys(exponent)
            row |= {key: round(power, 5) for key, power in keys.items()}
            row["h0"] = f"{1e3 * REFERENCE_CHIP:g} mm"
        return row

    def material_toml(self) -> str:
        """[material] section of a case file by the best law that a case file may have."""
        fit = self.of_case
        section = tomlkit.table()
        for key, value in self.row().items():
            section.add(key, value)
        document = tomlkit.document()
        cuts = number_of_cuts(len(fit.averages))
        document.add(tomlkit.comment(f"{fit.model.law.name} law, waveforms of {cuts}"))
        for note in self.notes:
            document.add(tomlkit.comment(note))
        document.add("material", section)
        return tomlkit.dumps(document)


def waveforms(measurement: Measurement, *, zeroed: bool) -> Waveforms:
    """Fit the waveforms of all cuts together.

    The forces are averaged over the revolution at the speed that each record shows. Start angles,
    runout, offsets of channels and one resonance of the dynamometer for each channel are fitted
    with the law, a low-pass before all channels, and the helix where the case does not give it;
    what does not lower the Bayesian criterion is left out. `zeroed` tells whether the offsets were
    those of the air, and are taken off.

    Raises
    ------
    InputError
        If the records cannot be used.
    """
    averages = [revolution_average(measurement, run) for run in measurement.runs]
    known = force_channels(measurement, measurement.runs[0])
    unsigned = [name for name, (_, has_sign) in known.items() if not has_sign]
    has_free_helix = "helix" not in measurement.case.tool.model_fields_set
    fits = waveform_fits(averages, unsigned, has_free_helix, zeroed)
    return Waveforms(tuple(fits), units=units_of(measurement.case))


def _left(average: RevolutionAverage, residual: Complex) -> list[float]:
    """Share of the varying force of each channel that the fit leaves, as amplitudes."""
    left = np.linalg.norm(residual[:, 1:], axis=1)
    return [float(one) for one in left / np.linalg.norm(average.amplitude[:, 1:], axis=1)]


def _cuts(fit: WaveformFit) -> bool:
    """Whether no cutting coefficient is below zero."""
    return bool(np.all(fit.coefficients[fit.model.law.cutting] >= 0.0))


def _coefficients(fit: WaveformFit, units: UnitSystem) -> list[dict[str, Any]]:
    return [
        {
            "name": key,
            "value": float(value) * unit_of(key, units).factor,
            "standard_deviation": float(deviation) * unit_of(key, units).factor,
            "unit": unit_of(key, units).name,
        }
        for key, value, deviation in zip(
            fit.model.law.keys, fit.coefficients, fit.deviations, strict=True
        )
    ]


def _of_kind(
    fit: WaveformFit, names: Sequence[str], kind: str, factor: float, unit: str
) -> list[dict[str, Any]]:
    return [
        {
            "name": name,
            "value": factor * float(value),
            "standard_deviation": factor * float(deviation),
            "unit": unit,
        }
        for name, value, deviation in zip(
            names, fit.parameters, fit.parameter_deviations, strict=True
        )
        if name.startswith(kind)
    ]


def _resonances(fit: WaveformFit) -> dict[str, dict[str, float]]:
    parts = fit.model.split(fit.parameters, len(fit.averages))
    pairs = np.exp(parts["resonance"]).reshape(-1, 2)
    return {
        name: {"frequency_Hz": float(frequency), "damping_ratio": float(damping)}
        for name, (frequency, damping) in zip(fit.model.resonant, pairs, strict=True)
    }


def _low_pass(fit: WaveformFit) -> float | None:
    given = fit.model.split(fit.parameters, len(fit.averages))["low_pass"]
    return float(np.exp(given[0])) if given.size else None


def _offsets(fit: WaveformFit) -> dict[str, dict[str, float]]:
    if not fit.model.offsets:
        return {}
    values = iter(fit.values[len(fit.model.law.keys) :])
    return {one.run: {name: float(next(values)) for name in one.channels} for one in fit.averages}
