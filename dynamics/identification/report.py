"""Fitted models turned into what is reported: modes with uncertainty, warnings, FRF models."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dynamics.identification.delay import without_delay
from dynamics.identification.mode_quality import TINY, near_mode, peak_share
from dynamics.identification.real_modes import RealModel, ToolPointRecords
from dynamics.identification.refinement import ModalModel, fit_residues
from dynamics.identification.residues import Records
from dynamics.identification.result import FrfModel, IdentifiedMode
from dynamics.identification.tool_point import share_of_real_mode
from dynamics.modal.modes import Mode

#: relative standard deviation of damping or mass above which a mode is doubtful
DOUBTFUL_STD = 0.1

#: relative standard deviation of the mass from which a mode is not felt at the tool point
UNFELT_STD = 0.67
UNFELT = "not felt at the tool point: no mass"

#: relative deviation in the half-power band above which a mode is doubtful
DOUBTFUL_FIT = 0.1

#: share of the peak below which a mode is doubtful
DOUBTFUL_WEIGHT = 0.02

#: phase off a real mode above which a mode is doubtful, degrees
DOUBTFUL_PHASE = 20.0

_UNIT = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def complex_frf_model(
    records: Records, model: ModalModel, k: int, sense: float, delay: float
) -> FrfModel:
    """Model of FRF k of a set with complex modes, in the sense of the sensors."""
    modes = model.count
    rest = sense * model.coefficients[2 * modes :, k]
    return FrfModel(
        records.derivative,
        records.added_decay,
        model.natural_frequency,
        model.damping,
        sense * model.coefficients[:modes, k],
        sense * model.coefficients[modes : 2 * modes, k],
        delay,
        tuple((p, float(c)) for p, c in zip(model.terms, rest, strict=True)),
    )


def real_frf_model(
    tool: ToolPointRecords, model: RealModel, k: int, sense: float, delay: float
) -> FrfModel:
    """Model of FRF k of a set with real modes, in the sense of the sensors."""
    rest = sense * model.free[k][model.free[k].size - len(model.terms) :]
    return FrfModel(
        tool.records.derivative,
        tool.records.added_decay,
        model.natural_frequency,
        model.damping,
        sense * model.residues(tool.pairs)[:, k],
        np.zeros(model.count),
        delay + (model.delay or 0.0),
        tuple((p, float(c)) for p, c in zip(model.terms, rest, strict=True)),
    )


class _Resonance(NamedTuple):
    """A fitted mode within the lines: its index in the model, pole and how sure that is."""

    mode: int
    hertz: float
    damping: float
    std_frequency: float  # Hz
    std_damping: float
    inflation: float  # of standard deviations, for correlated errors
    fit_error: float


def _resonances(
    records: Records,
    model: ModalModel | RealModel,
    synthesis: NDArray[np.complex128],
    covariance: NDArray[np.float64],
) -> Iterator[_Resonance]:
    """Modes of a model but those that stand for modes beyond the band."""
    error = (records.values - synthesis) / records.noise
    for r in range(model.count):
        hertz = float(model.natural_frequency[r] / (2.0 * np.pi))
        if records.frequency[0] <= hertz <= records.frequency[-1]:
            damping, k = float(model.damping[r]), model.count + r
            inflation = _inflation(records, error, hertz, damping)
            yield _Resonance(
                r,
                hertz,
                damping,
                float(hertz * inflation * np.sqrt(covariance[r, r])),
                float(damping * inflation * np.sqrt(covariance[k, k])),
                inflation,
                _fit_error(records, synthesis, hertz, damping),
            )


def _identified(
    one: _Resonance,
    residues: NDArray[np.complex128],
    weight: float,
    phase: float,
    warning: str,
    mass: tuple[float, float, tuple[float, float, float]] | None = None,
) -> IdentifiedMode:
    """Report of a mode; mass, its standard deviation and direction where it is felt."""
    modal_mass, mass_std, direction = mass or (None, None, None)
    return IdentifiedMode(
        frequency=one.hertz,
        damping=one.damping,
        frequency_std=one.std_frequency,
        damping_std=one.std_damping,
        residues=residues,
        mass=modal_mass,
        mass_std=mass_std,
        direction=direction,
        fit_error=one.fit_error,
        weight=weight,
        phase_deviation=phase,
        warning=warning,
    )


def identified_complex_modes(records: Records, model: ModalModel) -> list[IdentifiedMode]:
    """Report of modes without mass."""
    found = []
    for one in _resonances(records, model, model.synthesis(records), covariance_of(model.normal)):
        r = one.mode
        residues = model.coefficients[r] + 1j * model.coefficients[model.count + r]
        weight, phase = peak_share(records, model, r), _phase_deviation(residues)
        warning = _warning(one, None, weight, phase)
        found.append(_identified(one, residues, weight, phase, warning))
    return found


def identified_real_modes(tool: ToolPointRecords, model: RealModel) -> list[IdentifiedMode]:
    """Report of real modes with mass and direction at the tool point.

    How far each is off a real mode comes from complex residues of the same poles, delay removed.
    """
    undelayed = without_delay(tool.records, model.delay or 0.0)
    free = fit_residues(undelayed, model.natural_frequency, model.damping, model.terms)
    covariance = covariance_of(model.normal)
    residues = model.residues(tool.pairs).astype(np.complex128)
    axes = len(tool.axes)
    found = []
    for one in _resonances(tool.records, model, model.synthesis(tool), covariance):
        r = one.mode
        vector = model.vectors[r]
        inverse_mass = float(vector @ vector)
        own = slice(2 * model.count + r * axes, 2 * model.count + (r + 1) * axes)
        # 1/m = u.u, so that the relative deviation of m is 2 u.du / u.u
        variance = float(vector @ covariance[own, own] @ vector)
        mass_std = 2.0 * one.inflation * np.sqrt(max(variance, 0.0)) / inverse_mass**2
        mass = 1.0 / inverse_mass
        weight = share_of_real_mode(tool, model, r)
        phase = _phase_deviation(free.coefficients[r] + 1j * free.coefficients[model.count + r])
        warning = _warning(one, mass_std / mass, weight, phase)
        felt = mass_std < UNFELT_STD * mass
        if not felt:
            warning = "; ".join(part for part in (UNFELT, warning) if part)
        at_tool = (mass, float(mass_std), direction_of(tool.axes, vector)) if felt else None
        found.append(_identified(one, residues[r], weight, phase, warning, at_tool))
    return found


def mode_of(mode: IdentifiedMode) -> Mode:
    """Mode at the tool point, for simulation and stability."""
    if mode.mass is None or mode.direction is None:
        message = f"the mode at {mode.frequency:.1f} Hz has no mass: no drive point was measured"
        raise ValueError(message)
    return Mode(mode.frequency, mode.damping, mode.mass, mode.direction)


def direction_of(axes: tuple[str, ...], vector: NDArray[np.float64]) -> tuple[float, float, float]:
    """Unit vector of a mode; the largest component is positive. An axis without name is x."""
    total = np.zeros(3)
    for name, value in zip(axes, vector, strict=True):
        total += value * np.array(_UNIT.get(name.lower(), _UNIT["x"]))
    total /= np.linalg.norm(total)
    total *= np.sign(total[np.argmax(np.abs(total))])
    return (float(total[0]), float(total[1]), float(total[2]))


def covariance_of(normal: NDArray[np.float64]) -> NDArray[np.float64]:
    """Inverse of the Gauss-Newton matrix, for unit variance of the weighted residuals.

    Real and imaginary part of a line share the variance of its noise.
    """
    scale = np.sqrt(np.maximum(np.diag(normal), 1e-300))
    return (
        0.5 * np.linalg.pinv(normal / scale[:, None] / scale, rcond=1e-14) / scale[:, None] / scale
    )


def _inflation(
    records: Records, error: NDArray[np.complex128], hertz: float, damping: float
) -> float:
    """Root of the chi-square per line near a mode, scaled for correlated errors."""
    near = error[near_mode(records, hertz, damping)]
    power = float(np.sum(np.abs(near) ** 2))
    neighbours = float(np.sum(near[1:] * near[:-1].conj()).real)
    correlation = float(np.clip(neighbours / max(power, 1e-300), 0.0, 0.9))
    return float(np.sqrt(power / near.size * (1.0 + correlation) / (1.0 - correlation)))


def _fit_error(
    records: Records, synthesis: NDArray[np.complex128], hertz: float, damping: float
) -> float:
    """Deviation in the half-power band (three lines at least) over the largest value there."""
    distance = np.abs(records.frequency - hertz)
    near = distance <= max(damping * hertz, float(np.sort(distance)[min(2, distance.size - 1)]))
    deviation = np.sqrt(np.mean(np.abs(records.values[near] - synthesis[near]) ** 2))
    return float(deviation / max(float(np.max(np.abs(records.values[near]))), TINY))


def _phase_deviation(residues: NDArray[np.complex128]) -> float:
    """Mean angle of the residues (k,) off the real axis, degrees, weighted by their size."""
    size = np.abs(residues)
    angle = np.abs(np.arctan2(residues.imag, np.abs(residues.real)))
    return float(np.degrees(np.sum(angle * size**2) / max(float(np.sum(size**2)), 1e-300)))


def _warning(one: _Resonance, relative_mass_std: float | None, weight: float, phase: float) -> str:
    """What makes a mode doubtful, in words; empty where nothing does."""
    said = []
    if one.std_damping > DOUBTFUL_STD * one.damping:
        said.append(f"damping uncertain by {100 * one.std_damping / one.damping:.0f} %")
    if relative_mass_std is not None and relative_mass_std > DOUBTFUL_STD:
        said.append(f"mass uncertain by {100 * relative_mass_std:.0f} %")
    if one.fit_error > DOUBTFUL_FIT:
        said.append(f"the fit misses the resonance by {100 * one.fit_error:.0f} %")
    if weight < DOUBTFUL_WEIGHT:
        said.append(f"weak: adds {100 * weight:.1f} % of the peak")
    if phase > DOUBTFUL_PHASE:
        said.append(f"complex: {phase:.0f} degrees off a real mode")
    return "; ".join(said)
