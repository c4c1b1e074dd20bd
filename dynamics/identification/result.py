"""What a modal identification found, and how well it describes the measurement."""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.frf.container import DERIVATIVE_ORDER, Frf
from dynamics.identification.band import Band
from dynamics.identification.residues import COMPLIANCE, QUADRATURE
from dynamics.identification.stabilisation import StabilisationDiagram
from dynamics.modal.modes import Mode

#: noise over peak above which an FRF, such as a cross term of nothing, says little
MOSTLY_NOISE = 0.1


class BeyondBand(NamedTuple):
    """Modes for what lies beyond the band, and what is lost by them."""

    modes: tuple[Mode, ...] = ()
    #: largest deviation in the band of all modes together from the fit, delay and quadrature apart,
    #: over its largest receptance
    misfit: float = 0.0


@dataclass(frozen=True)
class SynthesisError:
    """Deviation of a synthesised FRF from the measured one over the band."""

    rms: float  # of the deviation, over the largest magnitude of the measured function in the band
    maximum: float  # largest magnitude of the deviation, over the same
    rms_receptance: float  # after conversion of both to receptance
    maximum_receptance: float  # likewise
    noise: float  # rms of the noise of the measurement, over the same peak: no model comes closer


@dataclass(frozen=True)
class IdentifiedMode:
    """One mode with what the data say about its parameters.

    Parameters
    ----------
    frequency, damping : float
        Undamped natural frequency, Hz, and damping ratio, 1.
    frequency_std, damping_std : float
        Standard deviations of the two.
    residues : (k,) array of complex
        Per FRF of the fit: residue as 1 / mass (1/kg, for accelerance over force); real for a
        real mode. NaN for FRFs of which the mode is no part.
    mass, mass_std : float or None
        Modal mass at the tool point and its standard deviation, kg; None without a drive point.
    direction : tuple of float or None
        Unit vector of the tool point.
    fit_error : float
        Root mean square deviation on the lines of the half-power band, relative to the largest
        measured value there.
    weight : float
        Largest contribution of the mode relative to the peak of an FRF.
    phase_deviation : float
        Angle between the residues and a real mode, degrees, delay removed.
    warning : str
        Why the mode is doubtful; empty where the data support it.
    """

    frequency: float
    damping: float
    frequency_std: float
    damping_std: float
    residues: NDArray[np.complex128]
    mass: float | None
    mass_std: float | None
    direction: tuple[float, float, float] | None
    fit_error: float
    weight: float
    phase_deviation: float
    warning: str


@dataclass(frozen=True)
class FrfModel:
    """Modal model of one FRF: modes, delay and residual terms."""

    derivative: int  # 0, 1 or 2: the quantity that the FRF is
    added_decay: float  # of an exponential window in the measurement, rad/s
    natural_frequency: NDArray[np.float64]  # (m,), rad/s
    damping: NDArray[np.float64]  # (m,), 1
    residues: NDArray[np.float64]  # (m,), real residue, 1/kg
    quadrature: NDArray[np.float64]  # (m,), the part in quadrature, which multiplies s / w
    delay: float  # lag of the response channel, s
    #: power of s and coefficient, in receptance, of each residual term: 1/s^2 the mass line of
    #: modes below the band (1/kg), 1/s the quadrature that a lag leaves, constant the compliance of
    #: modes above the band (m/N); 1/s^4 and s^2 their next terms
    residual: tuple[tuple[int, float], ...]

    @property
    def residual_compliance(self) -> float:
        """Constant in receptance, m/N."""
        return dict(self.residual).get(COMPLIANCE, 0.0)

    def values(self, frequency: ArrayLike) -> NDArray[np.complex128]:
        """The function as measured, with its delay and window, (n,)."""
        f = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
        s = self.added_decay + 2j * np.pi * f
        rest = sum(coefficient * s**power for power, coefficient in self.residual)
        return (self._elastic(s) + rest) * np.exp(-s * self.delay) * s**self.derivative

    def values_of_modes(self, frequency: ArrayLike) -> NDArray[np.complex128]:
        """Modes with mass lines and compliances, without delay and quadrature, (n,)."""
        f = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
        s = self.added_decay + 2j * np.pi * f
        rest = sum(c * s**power for power, c in self.residual if power != QUADRATURE)
        return (self._elastic(s) + rest) * s**self.derivative

    def _elastic(self, s: NDArray[np.complex128]) -> NDArray[np.complex128]:
        w, zeta = self.natural_frequency, self.damping
        amplitude = self.residues + self.quadrature * s[:, None] / w
        return np.sum(amplitude / (s[:, None] ** 2 + 2.0 * zeta * w * s[:, None] + w**2), axis=1)


@dataclass(frozen=True)
class ModalFit:
    """Result of a modal identification.

    Parameters
    ----------
    frfs : tuple of Frf
        The measured functions, all lines, in one quantity.
    band : Band
        Lines that were fitted, and why these.
    identified : tuple of IdentifiedMode
        By rising frequency.
    modes : tuple of Mode
        Real modes at the tool point; empty where no FRF is a drive point there.
    no_mass_reason : str
        Why `modes` is empty; empty where it is not.
    models : tuple of FrfModel
        Per FRF the model that the errors belong to: real modes where there is a drive point,
        complex modes otherwise.
    complex_models : tuple of FrfModel
        Per FRF the model with complex modes, free of the constraints of real modes and
        positive masses.
    errors, complex_errors : tuple of SynthesisError
        Per FRF, of the two; their difference is the price of real modes with positive mass.
    mode_errors : tuple of SynthesisError
        Per FRF, of `models` without measured delay and quadrature: what the modes with residual
        mass and compliance alone give. Of little meaning where the models are complex.
    diagrams : tuple of StabilisationDiagram
        One for each set of FRFs with poles of its own.
    notes : tuple of str
        What a person should know: sign reversed, delay, modes refused.
    beyond : BeyondBand
        Modes that stand for what lies below and above the band, where there is a drive point.
    """

    frfs: tuple[Frf, ...]
    band: Band
    identified: tuple[IdentifiedMode, ...]
    modes: tuple[Mode, ...]
    no_mass_reason: str
    models: tuple[FrfModel, ...]
    complex_models: tuple[FrfModel, ...]
    errors: tuple[SynthesisError, ...]
    complex_errors: tuple[SynthesisError, ...]
    mode_errors: tuple[SynthesisError, ...]
    diagrams: tuple[StabilisationDiagram, ...]
    notes: tuple[str, ...]
    beyond: BeyondBand

    def synthesis(self, frequency: ArrayLike) -> NDArray[np.complex128]:
        """Fitted functions in the quantity of `frfs`.

        Parameters
        ----------
        frequency : (n,) array of float
            Hz.

        Returns
        -------
        (n, k) array of complex
            One column an FRF.
        """
        return np.stack([model.values(frequency) for model in self.models], axis=1)

    @property
    def undelayed_frfs(self) -> tuple[Frf, ...]:
        """The measured functions without the lag of their response channels."""
        return tuple(
            replace(frf, values=frf.values * np.exp(2j * np.pi * frf.frequency * model.delay))
            for frf, model in zip(self.frfs, self.models, strict=True)
        )

    @property
    def worst_error(self) -> float:
        """Largest relative deviation of all FRFs that are not mostly noise, as measured."""
        clear = [error.maximum for error in self.errors if error.noise < MOSTLY_NOISE]
        return max(clear or [error.maximum for error in self.errors])

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of all modes, each with its frequency."""
        return tuple(
            f"mode at {mode.frequency:.1f} Hz: {mode.warning}"
            for mode in self.identified
            if mode.warning
        )


def synthesis_error(
    frf: Frf, values: NDArray[np.complex128], noise: NDArray[np.float64]
) -> SynthesisError:
    """Deviation of synthesised values from a measured FRF on the same lines.

    The FRF has lines above 0 Hz; values (n,) in its quantity, and the standard deviation of its
    noise.
    """
    factor = (2.0 * np.pi * frf.frequency) ** -DERIVATIVE_ORDER[frf.quantity]
    rms, maximum = [], []
    for scale in (np.ones_like(factor), factor):
        deviation = np.abs(values - frf.values) * scale
        peak = float(np.max(np.abs(frf.values) * scale))
        peak = peak if peak > 0.0 else 1.0
        rms.append(float(np.sqrt(np.mean(deviation**2))) / peak)
        maximum.append(float(np.max(deviation)) / peak)
    level = float(np.sqrt(np.mean(noise**2))) / max(float(np.max(np.abs(frf.values))), 1e-300)
    return SynthesisError(rms[0], maximum[0], rms[1], maximum[1], level)
