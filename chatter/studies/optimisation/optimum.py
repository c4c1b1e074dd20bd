"""Result of a process optimisation: candidates, picture, files."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from chatter.description.case import Case
from chatter.description.formatting import to_digits
from chatter.description.unit_system import UnitSystem, units_of
from chatter.description.units import rpm
from chatter.io.result_files import SavedResult, finite_or_none
from chatter.io.result_tables import Column, Columns
from chatter.studies.optimisation.candidate import EASING, EASINGS, TIME_DOMAIN, Candidate
from chatter.studies.optimisation.exclusion import Exclusion, why_nothing
from chatter.studies.optimisation.limits import LIMITED, Limits
from chatter.studies.optimisation.operating_point import OperatingPoint, case_at
from chatter.studies.optimisation.speed_depth_slice import SpeedDepthSlice

#: m^3/s in cm^3/min
_PER_MINUTE = 6e7
#: quantity that is limited -> its name in a summary, and factor from SI
_REPORTED = {
    "power": ("power_W", 1.0),
    "torque": ("torque_Nm", 1.0),
    "deflection": ("deflection_um", 1e6),
    "surface_error": ("surface_error_um", 1e6),
}


@dataclass(frozen=True, eq=False, repr=False)
class Optimum(SavedResult):
    """Best cuts within the limits of a case.

    Parameters
    ----------
    case : Case
    limits : Limits
    candidates : tuple of Candidate
        Those that hold in the time domain first, highest removal rate first.
    over_radial_depths : tuple of OperatingPoint
        Best point of the coarse grid at every radial depth that has one.
    grid_slice : SpeedDepthSlice
        All speeds and depths at the radial depth and feed of the best cut.
    exclusions : tuple of Exclusion
        What each limit excludes of the coarse grid.
    points : int
        Of the coarse grid.
    samples, seed : int
        Of what is uncertain; no samples where nothing is.
    notes : tuple of str
    """

    drawn_by: ClassVar[str] = "plots.optimum.plot_optimum"
    picture: ClassVar[str] = "optimum.png"

    case: Case
    limits: Limits
    candidates: tuple[Candidate, ...]
    over_radial_depths: tuple[OperatingPoint, ...]
    grid_slice: SpeedDepthSlice
    exclusions: tuple[Exclusion, ...]
    points: int
    samples: int
    seed: int
    notes: tuple[str, ...] = ()

    @property
    def units(self) -> UnitSystem:
        """Units that the words and the picture are in: those of the case."""
        return units_of(self.case)

    @property
    def best(self) -> Candidate | None:
        """The best cut; None where no cut keeps all limits."""
        verified = [
            one for one in self.candidates if one.verification is None or one.verification.verified
        ]
        return verified[0] if verified else None

    @property
    def best_case(self) -> Case | None:
        """The case with the best cut written in; None where there is none."""
        return None if self.best is None else case_at(self.case, self.best.point)

    @property
    def why_nothing(self) -> str:
        """What excludes everything; empty where there is a best cut."""
        if self.best is not None:
            return ""
        if self.candidates:
            return self._why_no_candidate()
        if self.over_radial_depths:
            return (
                "no cut is stable and keeps all limits with a probability of "
                f"{self.limits.confidence:.3g}"
            )
        return why_nothing(self.exclusions)

    def _why_no_candidate(self) -> str:
        """What the time domain says of the candidates, and how to search further."""
        point, length = self.candidates[0].point, self.units.length
        return (
            "no candidate of the linear search holds all limits in the time domain, nor up to "
            f"{EASING * EASINGS:.0%} less deep, as far as is tried: such as "
            f"{length.text(point.axial_depth, '.3g')} at {rpm(point.spindle_speed):.0f} rpm; "
            "`chatter check --method time-domain` computes the limit that holds at a "
            f"speed, and optimum.depths.to, {length.text(self.limits.depths[-1], '.3g')} here, "
            "keeps the search below it"
        )

    def summary(self) -> dict:
        """Return the content of summary.json."""
        return {
            "title": self.case.title,
            "feasible": self.best is not None,
            "why_nothing": self.why_nothing or None,
            "best": None if self.best is None else _summary_of(self.best),
            "candidates": [_summary_of(one) for one in self.candidates],
            "limits": {
                **self.limits.most,
                "confidence": self.limits.confidence if self.samples else None,
                "depth_margin": self.limits.depth_margin,
                "speed_margin": self.limits.speed_margin,
            },
            "searched": {
                "spindle_speeds_rpm": _ends(rpm(self.limits.speeds)),
                "axial_depths_mm": _ends(self.limits.depths * 1e3),
                "radial_depths_mm": _ends(self.limits.radial_depths * 1e3),
                "feeds_per_tooth_mm": _ends(self.limits.feeds * 1e3),
                "points": self.points,
            },
            "excluded_share": {one.limit: one.excluded for one in self.exclusions},
            "over_radial_depths": [_point_summary(point) for point in self.over_radial_depths],
            "samples": self.samples,
            "seed": self.seed,
            "notes": list(self.notes),
        }

    def sentences(self) -> list[str]:
        """Sentences for the terminal; none where there is no best cut, see `why_nothing`."""
        if self.best is None:
            return []
        best, units = self.best, self.units
        point, known, length = best.point, best.probability, units.length
        rate, torque, small = units.removal_rate, units.torque, units.displacement
        lines = [
            f"{to_digits(rpm(point.spindle_speed), 6)} rpm, {length.text(point.axial_depth)} "
            f"deep, {length.text(point.radial_depth)} wide, "
            f"{length.text(point.feed_per_tooth)} a tooth: "
            f"{to_digits(best.removal_rate * rate.factor, 4)} {rate.name}",
            f"{units.instead_of('kW').text(best.power * 1e-3, '.3g')}, "
            f"{to_digits(best.torque * torque.factor, 3)} {torque.name}, deflection "
            f"{to_digits(best.deflection * small.factor, 3)} {small.name}, "
            f"surface error {to_digits(best.surface_error * small.factor, 3)} {small.name}",
        ]
        if known is not None:
            low, high = known.interval
            what = "stable and within all limits" if self.limits.most else "stable"
            lines.append(
                f"{what} with a probability of {known.value:.1%} (95 % confidence: {low:.1%} to "
                f"{high:.1%}, {self.samples} samples)"
            )
        limited = ", ".join(best.active) or "nothing that a deeper cut would break at once"
        lines.append(f"limited by {limited}")
        if TIME_DOMAIN in best.active:
            lines.append(
                "time domain: simulations of deeper cuts miss a limit or chatter; the depth is "
                f"taken back by {EASING:.0%} a step, {EASING * EASINGS:.0%} at the most"
            )
        return lines

    def save(self, folder: str | Path, tables: str = "csv") -> list[Path]:
        """Write optimum.csv, summary.json, optimum.png and, of an optimum, case-optimum.toml.

        Parameters and errors are those of `SavedResult.save`.
        """
        written, path = super().save(folder, tables), Path(folder) / "case-optimum.toml"
        if self.best_case is not None:
            self.best_case.save(path)
            return [*written, path]
        # one of an earlier search would be taken for what was found now
        path.unlink(missing_ok=True)
        return written

    def tables(self) -> dict[str, Columns]:
        """Columns of the table "optimum"."""
        found = self.candidates
        points = [one.point for one in found]
        known = [one.probability for one in found]
        checks = [one.verification for one in found]
        rates = [one.removal_rate * _PER_MINUTE for one in found]
        active = [" ".join(name.replace(" ", "-") for name in one.active) for one in found]
        table = {
            "rank": Column(range(1, len(found) + 1), "d"),
            "spindle_speed [rpm]": Column([rpm(one.spindle_speed) for one in points], ".8g"),
            "axial_depth [mm]": Column([one.axial_depth * 1e3 for one in points], ".7g"),
            "radial_depth [mm]": Column([one.radial_depth * 1e3 for one in points], ".7g"),
            "feed_per_tooth [mm]": Column([one.feed_per_tooth * 1e3 for one in points], ".7g"),
            "removal_rate [cm^3/min]": Column(rates, ".7g"),
            "power [kW]": Column([one.power * 1e-3 for one in found], ".7g"),
            "torque [N m]": Column([one.torque for one in found], ".7g"),
            "deflection [um]": Column([one.deflection * 1e6 for one in found], ".7g"),
            "surface_error [um]": Column([one.surface_error * 1e6 for one in found], ".7g"),
            "critical_depth [mm]": Column([one.critical_depth * 1e3 for one in found], ".7g"),
            "probability_of_stability": Column([one and one.stable for one in known], ".6g"),
            "probability": Column([one and one.value for one in known], ".6g"),
            "active": Column(active, ""),
            "time_domain_verdict": Column([one and one.verdict for one in checks], ""),
            "time_domain_verified": Column([one and one.verified for one in checks], ""),
        }
        return {"optimum": table}


def _ends(values) -> list[float]:
    return [float(values[0]), float(values[-1])]


def _point_summary(point: OperatingPoint) -> dict:
    return {
        "spindle_speed_rpm": rpm(point.spindle_speed),
        "axial_depth_mm": point.axial_depth * 1e3,
        "radial_depth_mm": point.radial_depth * 1e3,
        "feed_per_tooth_mm": point.feed_per_tooth * 1e3,
        "removal_rate_cm3_per_min": point.removal_rate * _PER_MINUTE,
    }


def _summary_of(one: Candidate) -> dict:
    known, verification = one.probability, one.verification
    return {
        **_point_summary(one.point),
        **_numbers({quantity: getattr(one, quantity) for quantity in _REPORTED}),
        "critical_depth_mm": finite_or_none(one.critical_depth * 1e3),
        "usage": {key: finite_or_none(value) for key, value in one.usage.items()},
        "active": list(one.active),
        "probability_of_stability": None if known is None else known.stable,
        "probability": None if known is None else known.value,
        "confidence_interval_95": None if known is None else list(known.interval),
        "at_confidence": None
        if known is None
        else _numbers({LIMITED[key]: value for key, value in known.quantiles.items()}),
        "time_domain": None
        if verification is None
        else {
            "verdict": verification.verdict,
            "verified": verification.verified,
            **_numbers({quantity: getattr(verification, quantity) for quantity in _REPORTED}),
        },
    }


def _numbers(values: Mapping[str, float]) -> dict:
    """Quantities that are limited, as a summary names them."""
    reported = {_REPORTED[quantity]: value for quantity, value in values.items()}
    return {name: finite_or_none(value * factor) for (name, factor), value in reported.items()}
