"""Forces over the revolution by a rigid tool with runout, seen by a dynamometer.

Everything is in Fourier coefficients of the revolution (`RigidCut`): a start angle turns their
phases, a resonance of the dynamometer scales them. Coefficients of the law and offsets are linear.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from chatter.compile.cutter import cutter_of
from chatter.cutting_coefficients.laws import TriedLaw, unit_laws
from chatter.cutting_coefficients.revolution_average import RevolutionAverage
from chatter.description.arrays import Array
from cutting.force.force_spectrum import RigidCut
from cutting.tool.cutter import Cutter

Complex = NDArray[np.complex128]
#: unit of the runout among the parameters, m: they should be of a size
RUNOUT_UNIT = 1e-5


@dataclass(frozen=True)
class WaveformModel:
    """What is fitted to the waveforms.

    Parameters
    ----------
    law : TriedLaw
    teeth : int
    runout : bool
        Of the teeth; of two teeth only the difference of their radii shows, its angle stays 0.
    offsets : bool
        An offset of every channel in every cut.
    helix : bool
        Whether the helix is fitted, one for all teeth.
    resonant : tuple of str
        Channels with a resonance of the dynamometer.
    low_pass : bool
        Butterworth filter of second order before all channels.
    signs : dict of str to float
        Of channels whose sense is not known.
    """

    law: TriedLaw
    teeth: int
    signs: Mapping[str, float]
    runout: bool = False
    offsets: bool = True
    helix: bool = False
    resonant: tuple[str, ...] = ()
    low_pass: bool = False

    @property
    def runout_count(self) -> int:
        """Numbers that describe the runout."""
        return min(self.teeth - 1, 2) if self.runout else 0

    def split(self, parameters: Array, runs: int) -> dict[str, Array]:
        """Parameters by what they are: start, runout, exponent, helix, resonance."""
        sizes = {
            "start": runs,
            "runout": self.runout_count,
            "exponent": self.law.exponent_count,
            "helix": int(self.helix),
            "resonance": 2 * len(self.resonant),
            "low_pass": int(self.low_pass),
        }
        edges = np.cumsum([0, *sizes.values()])
        return {
            name: parameters[low:high]
            for name, low, high in zip(sizes, edges[:-1], edges[1:], strict=True)
        }

    def names(self, averages: Sequence[RevolutionAverage]) -> list[str]:
        """Names of the parameters."""
        found = [f"start angle of {one.run}" for one in averages]
        found += ["runout along the first tooth", "runout across it"][: self.runout_count]
        found += [
            f"exponent, {' and '.join(self.law.directions_of(number))}"
            for number in range(self.law.exponent_count)
        ]
        found += ["helix"] * self.helix
        for name in self.resonant:
            found += [f"resonance of {name}", f"damping of {name}"]
        found += ["low-pass"] * self.low_pass
        return found

    def cutter(self, one: RevolutionAverage, parts: Mapping[str, Array]) -> Cutter:
        """Tool of a cut, with the runout and the helix of the parameters."""
        cutter = cutter_of(one.case)
        if self.runout_count:
            along, across = RUNOUT_UNIT * np.append(parts["runout"], 0.0)[:2]
            cutter = replace(
                cutter, runout_offset=math.hypot(along, across),
                runout_angle=math.atan2(across, along),
            )  # fmt: skip
        if self.helix:
            cutter = replace(cutter, helix=(float(parts["helix"][0]),) * cutter.teeth)
        return cutter

    def forces(self, one: RevolutionAverage, parts: Mapping[str, Array]) -> Complex:
        """Fourier coefficients (k, 3, n) of the force on the tool by each coefficient of 1."""
        cutter, cut, harmonic = self.cutter(one, parts), one.case.cut, one.harmonic
        laws = unit_laws(self.law, parts["exponent"])
        rigid = RigidCut(
            cutter, [laws[0]] * cutter.teeth, one.case.uncut_band, cut.feed_per_tooth,
            cut.axial_depth, int(harmonic[-1]),
        )  # fmt: skip
        found = []
        for law in laws:
            # the chip is the same for every law
            rigid.laws = (law,) * cutter.teeth
            found.append(rigid.force(harmonic).force)
        return np.stack(found, axis=-1)

    def seen(
        self, one: RevolutionAverage, parts: Mapping[str, Array], forces: Complex, start: float
    ) -> Complex:
        """Fourier coefficients (channels, k, n) as the dynamometer shows them."""
        turned = forces * np.exp(1j * start * one.harmonic)[:, None, None]
        found = np.einsum("ca,kan->ckn", one.directions, turned)
        for row, name in enumerate(one.channels):
            found[row] *= self.signs.get(name, 1.0)
            if name in self.resonant:
                place = 2 * self.resonant.index(name)
                frequency, damping = np.exp(parts["resonance"][place : place + 2])
                ratio = one.speed * one.harmonic / (2.0 * math.pi * frequency)
                found[row] /= (1.0 - ratio**2 + 2j * damping * ratio)[:, None]
        if self.low_pass:
            cut_off = float(np.exp(parts["low_pass"][0]))
            ratio = one.speed * one.harmonic / (2.0 * math.pi * cut_off)
            found /= (1.0 - ratio**2 + 1j * math.sqrt(2.0) * ratio)[:, None]
        return found
