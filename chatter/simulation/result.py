"""Result of a simulation: signals, verdict, surface; pictures and files."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from chatter.description.unit_system import UnitSystem, units_of
from chatter.description.units import rpm
from chatter.detection.chatter_detection import Detection
from chatter.engine.record import largest_between_steps
from chatter.io.presentation import presentation
from chatter.io.recorded_columns import write_columns
from chatter.io.result_files import (
    NotebookResult,
    as_json,
    finite_or_none,
    short_repr,
    write_results,
)
from chatter.simulation.carved_workpiece import carving_notes
from chatter.simulation.finish import Finish, finish_of, scallop_height
from chatter.simulation.setup import Setup
from cutting.chip.discrete_chip import DiscreteCut

if TYPE_CHECKING:
    from matplotlib.figure import Figure


#: means are taken over the last whole turns within this share of the run
_SETTLED_SHARE = 0.5


class OtherVerdict(Protocol):
    """Verdict on the same cut by another way."""

    def sentence(self) -> str:
        """Verdict in words."""
        ...

    def summary(self) -> dict:
        """Verdict as JSON knows it."""
        ...


@dataclass(frozen=True, repr=False)
class SimulationResult(NotebookResult):
    """Signals of a simulated cut and what follows from them.

    Parameters
    ----------
    setup : Setup
        Case, tool, slices and resolution of the run; its groups hold the final state.
    rows : (n, 7) array of float
        Record: force on the tool (x, y, z), N; displacement of the tool against the workpiece
        (x, y, z), m; torque on the spindle, N m.
    between : (n, 7) array of float
        What happens between the rows: mean force (x, y, z), N, and torque, N m, since the row
        before, less those at the row; largest size of each force since then, N. Zero where the
        rows tell all.
    energy : dict
        Work of the cutting force on the structure, energy dissipated in it and stored at the end,
        J.
    complete : bool
        False where the run was left early.
    interrupted : bool
        True where that was the user's wish.
    detection : Detection, optional
        Chatter or not; None where that cannot be told, or was not asked for (`with_verdict`).
    why_no_verdict : str
        Why there is none; empty where there is one.
    linear : OtherVerdict, optional
        What the linear analysis says of the same cut, where it was asked for
        (`chatter.stability.beside_simulation`).
    """

    setup: Setup
    rows: NDArray[np.float64]
    between: NDArray[np.float64]
    energy: dict[str, float]
    complete: bool = True
    interrupted: bool = False
    detection: Detection | None = None
    why_no_verdict: str = "chatter detection was not asked for"
    linear: OtherVerdict | None = None

    @property
    def case(self):
        """Case that was simulated."""
        return self.setup.case

    @cached_property
    def time(self) -> NDArray[np.float64]:
        """Time (n,) of the rows, s."""
        return np.arange(len(self.rows)) * (self.setup.resolution.stride * self.setup.step)

    @cached_property
    def spindle_angle(self) -> NDArray[np.float64]:
        """Angle (n,) turned by the spindle, rad."""
        return self.setup.spindle.angle_at(self.time)

    @cached_property
    def spindle_speed(self) -> NDArray[np.float64]:
        """Speed (n,) of the spindle, rad/s."""
        return self.setup.spindle.speed_at(self.time)

    @property
    def force(self) -> NDArray[np.float64]:
        """Force (n, 3) on the tool, N."""
        return self.rows[:, 0:3]

    @cached_property
    def mean_force(self) -> NDArray[np.float64]:
        """Mean force (3,) on the tool over the settled part of the run, N, between rows as well."""
        if self.case.dynamometer is not None:
            return self.force[self.settled].mean(axis=0)
        return self._since_row_before(self.between[:, 0:3], self.force).mean(axis=0)

    @cached_property
    def peak_force(self) -> NDArray[np.float64]:
        """Largest size (3,) of each force on the tool in the settled cut, N, between rows too."""
        return self._peaks(self.judged)

    def _peaks(self, rows: slice) -> NDArray[np.float64]:
        """Largest size (3,) of each force over some rows, N, between rows too."""
        if self.case.dynamometer is not None:
            return np.abs(self.force[rows]).max(axis=0)
        largest = self.between[rows, 4:7].max(axis=0)
        if self.setup.resolution.stride > 1:
            return largest
        return np.maximum(largest, largest_between_steps(self.force[rows]))

    @property
    def judged(self) -> slice:
        """Rows that peaks are taken over: the settled cut; all where the engagement changes."""
        simulation = self.case.simulation
        moves = self.case.stock is not None or (simulation is not None and simulation.has_own_path)
        return slice(0, len(self.rows)) if moves else self.settled

    def _largest(self, rows: slice) -> dict:
        """Largest forces, displacement and power over some rows."""
        names = ("Fx", "Fy", "Fz")
        force, moved = self.force[rows], self.displacement[rows]
        return {
            "peak_force_N": dict(zip(names, map(float, self._peaks(rows)), strict=True)),
            "peak_resultant_N": float(np.linalg.norm(force, axis=1).max()),
            "peak_displacement_um": float(np.linalg.norm(moved, axis=1).max() * 1e6),
            "peak_W": float(self.power[rows].max()),
        }

    def _transient(self) -> dict:
        """Largest values before the settled cut; nothing where all rows count."""
        begin = self.judged.start
        if not begin:
            return {}
        return {"transient": {"until_s": float(self.time[begin]), **self._largest(slice(0, begin))}}

    @property
    def displacement(self) -> NDArray[np.float64]:
        """Displacement (n, 3) of the tool against the workpiece, m."""
        return self.rows[:, 3:6]

    @property
    def torque(self) -> NDArray[np.float64]:
        """Torque (n,) of the cut on the spindle, N m."""
        return self.rows[:, 6]

    @cached_property
    def mean_torque(self) -> float:
        """Mean torque over the settled part of the run, N m, between rows as well."""
        return float(self._since_row_before(self.between[:, 3], self.torque).mean())

    @cached_property
    def mean_power(self) -> float:
        """Mean cutting power over the settled part of the run, W, between rows as well."""
        between = self.between[:, 3] * self.spindle_speed
        return float(self._since_row_before(between, self.power).mean())

    def _since_row_before(
        self, between: NDArray[np.float64], samples: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Means from row to row within the settled part; a run of one row has but its sample."""
        if len(self.rows) < 2:
            return samples[self.settled]
        # a row ends what lies between it and the one before
        ends = slice(self.settled.start + 1, self.settled.stop + 1)
        return samples[ends] + between[ends]

    @property
    def power(self) -> NDArray[np.float64]:
        """Cutting power (n,) drawn from the spindle, W."""
        return self.torque * self.spindle_speed

    @property
    def revolutions(self) -> float:
        """Revolutions that were simulated."""
        return float(self.spindle_angle[-1]) / (2.0 * math.pi)

    @property
    def whole_revolutions(self) -> int:
        """Revolutions that were finished."""
        # the last bit of an angle must not cost one
        return math.floor(self.revolutions + 1e-9)

    @cached_property
    def finish(self) -> Finish:
        """Surface that the cut leaves behind."""
        return finish_of(self)

    @cached_property
    def settled(self) -> slice:
        """Rows of the last whole turns, after the start has died out."""
        turns = self.whole_revolutions
        if turns < 1:
            return slice(0, len(self.rows))
        kept = max(1, math.floor(turns * _SETTLED_SHARE))
        last = 2.0 * math.pi * turns
        first, end = np.searchsorted(
            self.spindle_angle, [last - 2.0 * math.pi * kept - 1e-9, last - 1e-9]
        )
        return slice(int(first), int(max(end, first + 1)))

    @property
    def units(self) -> UnitSystem:
        """Units that the words and the picture are in: those of the case."""
        return units_of(self.case)

    def __repr__(self) -> str:
        """What the result is of: its arrays would fill the screen."""
        return short_repr(self)

    def summary(self) -> dict:
        """Return the content of summary.json."""
        cut, names = self.case.cut, ("Fx", "Fy", "Fz")
        largest = self._largest(self.judged)
        return {
            "title": self.case.title,
            **self._verdict(),
            **({} if self.linear is None else {"linear_analysis": self.linear.summary()}),
            "spindle_speed_rpm": rpm(cut.spindle_speed),
            "axial_depth_mm": cut.axial_depth * 1e3,
            "cutting_speed_m_per_min": 30.0 * self.case.tool.diameter * cut.spindle_speed,
            "feed_rate_mm_per_min": 60e3 * self.case.feed_speed,
            "peak_force_N": largest["peak_force_N"],
            "mean_force_N": dict(zip(names, map(float, self.mean_force), strict=True)),
            "peak_resultant_N": largest["peak_resultant_N"],
            "peak_displacement_um": largest["peak_displacement_um"],
            "power": {
                "mean_W": self.mean_power,
                "peak_W": largest["peak_W"],
                "mean_torque_Nm": self.mean_torque,
            },
            **self._transient(),
            **self.finish.summary(),
            **self._scallops(),
            "energy_J": self.energy,
            "revolutions": self.revolutions,
            "resolution": {
                "chip": self.case.simulation.chip if self.case.simulation else "delay",
                "steps_per_revolution": self.setup.resolution.steps_per_revolution,
                "slices": len(self.setup.slices.height),
                "time_step_us": self.setup.step * 1e6,
            },
            **self._carving(),
            "notes": list(self.notes),
        }

    @property
    def notes(self) -> tuple[str, ...]:
        """What the user should know of the run."""
        cut = self.setup.groups[0]
        carving = carving_notes(cut) if isinstance(cut, DiscreteCut) else []
        wanted = self.setup.resolution.revolutions
        stopped = f"interrupted after {self.revolutions:.4g} of {wanted:g} revolutions"
        apart, depth = self._uncut_between_passes, self.case.cut.axial_depth
        length = self.units.length
        strips = (
            f"cut.stepover: at a depth of {length.text(depth)} the ball cuts "
            f"{length.text(self.case.cut.stepover - apart)} wide; passes "
            f"{length.text(self.case.cut.stepover)} apart leave strips of "
            f"{length.text(apart, '.3g')} between them"
            if apart > 0.0
            else ""
        )
        own = [*([stopped] if self.interrupted else []), *([strips] if strips else [])]
        return (*self.setup.notes, *carving, *own)

    def _carving(self) -> dict:
        cut = self.setup.groups[0]
        if not isinstance(cut, DiscreteCut):
            return {}
        spacing = cut.stock.spacing
        return {
            "workpiece": {
                "resolution_um": spacing * 1e6,
                "layers": len(self.setup.slices.height),
                "removed_volume_mm3": float(cut.removed[0]) * 1e9,
                "memory_MB": sum(
                    part.nbytes for part in cut.stock if isinstance(part, (np.ndarray, np.generic))
                )
                / 1e6,
            }
        }

    @property
    def _uncut_between_passes(self) -> float:
        """Width, m, that a ball leaves uncut from pass to pass; 0 where the passes meet."""
        case = self.case
        if case.tool.kind != "ball" or case.cut.stepover is None:
            return 0.0
        wide = 2.0 * self.setup.cutter.radius_at(case.cut.axial_depth)
        return max(0.0, case.cut.stepover - wide)

    def _scallops(self) -> dict:
        """Height of what a ball leaves between passes; nothing for other tools and cuts."""
        tool, stepover = self.case.tool, self.case.cut.stepover
        if tool.kind != "ball" or stepover is None or self._uncut_between_passes > 0.0:
            return {}
        return {"scallop_height_um": 1e6 * scallop_height(tool.diameter, stepover)}

    def _verdict(self) -> dict:
        found = self.detection
        if found is None:
            return {
                "verdict": "not judged",
                "chatter_frequency_Hz": None,
                "reason": self.why_no_verdict,
            }
        return {
            "verdict": found.verdict,
            "chatter_frequency_Hz": finite_or_none(found.chatter_frequency),
            "bifurcation": found.bifurcation,
            "confidence": found.confidence,
            "growth_rate_per_s": finite_or_none(found.growth_rate),
            "reason": found.reason,
        }

    def plot(self) -> Figure:
        """Return the picture of the run as a matplotlib figure."""
        return presentation("plots.simulation").plot_simulation(self)

    def save(self, folder: str | Path, signals: str = "csv") -> list[Path]:
        """Write signals.csv, summary.json and simulate.png.

        Parameters
        ----------
        folder : path
        signals : str, optional
            File of the signals: "csv", "parquet" or "none".

        Returns
        -------
        list of Path
            What was written.

        Raises
        ------
        InputError
            If `signals` is none of these, or pyarrow is needed and not installed.
        """
        forms = ["%.9g", "%.9g", *["%.6g"] * 6]
        columns = write_columns(Path(folder), "signals", signals, self._signals(), forms)
        summary = {"summary.json": as_json(self.summary())}
        return [*columns, *write_results(folder, summary, {"simulate.png": self.plot()})]

    def _signals(self) -> dict[str, NDArray[np.float64]]:
        """Columns of the file of the signals, by their heading."""
        columns = {"time [s]": self.time, "spindle_angle [rad]": self.spindle_angle}
        for number, axis in enumerate("xyz"):
            columns[f"F{axis} [N]"] = self.force[:, number]
        for number, axis in enumerate("xyz"):
            columns[f"{axis} [um]"] = self.displacement[:, number] * 1e6
        return columns
