"""`assemble`: tool point, modes and lobes of a tool at many stick-outs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from chatter.assembly.assembly_file import AssemblyFile
from chatter.assembly.library import HolderEntry, Library, ToolEntry, shipped_library
from chatter.assembly.spindle import measured_spindle, modelled_spindle
from chatter.assembly.tool_point import (
    Base,
    tool_point_frf,
    tool_point_modes,
    tool_point_receptance,
)
from chatter.description.case import Case, load
from chatter.description.errors import InputError
from chatter.description.progress import Progress, no_progress
from chatter.description.unit_system import METRIC, UnitSystem, units_of, units_of_content
from chatter.description.units import rpm
from chatter.description.wording import nearest
from chatter.io.presentation import presentation
from chatter.io.result_files import NotebookResult, as_json, finite_or_none, write_results
from chatter.io.result_tables import Column, csv_text
from chatter.stability.lobes import lobes
from dynamics.identification.result import ModalFit
from dynamics.modal.modes import Mode

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class StickOutLobes:
    """Limits over stick-out and spindle speed.

    Parameters
    ----------
    spindle_speed : (n,) array of float
        rad/s.
    critical_depth : (k, n) array of float
        m; nan where there is none up to the depth searched.
    usable_depth : (k, n) array of float
        The same with what the flutes allow, m.
    removal_rate : (k,) array of float
        Highest at each stick-out, m^3/s.
    best_speed : (k,) array of float
        Where that is, rad/s.
    """

    spindle_speed: NDArray[np.float64]
    critical_depth: NDArray[np.float64]
    usable_depth: NDArray[np.float64]
    removal_rate: NDArray[np.float64]
    best_speed: NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class Assembly(NotebookResult):
    """Tool point of an assembly over the stick-out.

    Parameters
    ----------
    file : AssemblyFile
    stick_out : (k,) array of float
        m.
    frequency : (m,) array of float
        Hz.
    receptance : (k, m) array of complex
        At the tool point, m/N, alike in x and y.
    fits : tuple of ModalFit
        Modes of each stick-out.
    lobes : StickOutLobes or None
        Where the assembly names a case.
    notes : tuple of str
        Assumptions of the result.
    units : UnitSystem
        That the words and the picture are in: those of the case, or of the stick-out without one.
    """

    file: AssemblyFile
    stick_out: NDArray[np.float64]
    frequency: NDArray[np.float64]
    receptance: NDArray[np.complex128]
    fits: tuple[ModalFit, ...]
    lobes: StickOutLobes | None
    notes: tuple[str, ...]
    units: UnitSystem = METRIC

    def __repr__(self) -> str:
        """Short: what it holds would fill the screen."""
        name = self.file.title or self.file.name
        return f"<Assembly {name!r}, {len(self.stick_out)} stick-outs>"

    @property
    def best(self) -> int:
        """Index of the stick-out of the highest removal rate; without lobes the stiffest."""
        if self.lobes is not None:
            return int(np.argmax(self.lobes.removal_rate))
        return int(np.argmin(np.max(np.abs(self.receptance), axis=1)))

    def summary(self) -> dict[str, Any]:
        """Content of summary.json."""
        peaks = np.max(np.abs(self.receptance), axis=1)
        rows = [
            {
                "stick_out_mm": 1e3 * float(self.stick_out[k]),
                "peak_receptance_m_per_N": float(peaks[k]),
                "modes": [
                    {"frequency_Hz": m.frequency, "damping": m.damping, "mass_kg": m.mass}
                    for m in self.fits[k].modes
                ],
            }
            | self._of_lobes(k)
            for k in range(self.stick_out.size)
        ]
        return {
            "title": self.file.title,
            "stick_outs": rows,
            "best_stick_out_mm": 1e3 * float(self.stick_out[self.best]),
            "best_by": "removal rate" if self.lobes is not None else "lowest peak receptance",
            "notes": list(self.notes),
        }

    def _of_lobes(self, k: int) -> dict[str, Any]:
        if self.lobes is None:
            return {}
        return {
            "lowest_critical_depth_mm": finite_or_none(
                1e3 * float(np.min(np.nan_to_num(self.lobes.critical_depth[k], nan=np.inf)))
            ),
            "removal_rate_cm3_per_min": 6e7 * float(self.lobes.removal_rate[k]),
            "at_spindle_speed_rpm": float(rpm(self.lobes.best_speed[k])),
        }

    def plot(self) -> Figure:
        """Return the picture: tool point, and lobes over the stick-out."""
        return presentation("plots.assembly").plot_assembly(self)

    def save(self, folder: str | Path) -> list[Path]:
        """Write tool-point.csv, modes.toml, summary.json, assemble.png and lobes-stick-out.csv."""
        best = self.receptance[self.best]
        texts = {
            "tool-point.csv": csv_text(
                {
                    "frequency [Hz]": Column(self.frequency, ".8g"),
                    "real [m/N]": Column(best.real, ".8e"),
                    "imag [m/N]": Column(best.imag, ".8e"),
                }
            ),
            "modes.toml": modes_as_toml(
                self.fits[self.best].modes,
                f"tool point at a stick-out of {1e3 * self.stick_out[self.best]:.4g} mm",
            ),
            "summary.json": as_json(self.summary()),
        }
        if self.lobes is not None:
            count = self.lobes.spindle_speed.size
            texts["lobes-stick-out.csv"] = csv_text(
                {
                    "stick-out [mm]": Column(np.repeat(1e3 * self.stick_out, count), ".5g"),
                    "spindle_speed [rpm]": Column(
                        np.tile(rpm(self.lobes.spindle_speed), self.stick_out.size), ".8g"
                    ),
                    "critical_depth [mm]": Column(1e3 * self.lobes.critical_depth.ravel(), ".6g"),
                }
            )
        return write_results(folder, texts, {"assemble.png": self.plot()})


def modes_as_toml(modes: Sequence[Mode], title: str) -> str:
    """Modes alike in x and y as tables of a case file."""
    tables = [
        f'\n[[structure.mode]]\nfrequency = "{mode.frequency:.8g} Hz"\n'
        f'damping = {mode.damping:.6g}\nmass = "{mode.mass:.7g} kg"\n'
        f'direction = {direction}\nside = "tool"\n'
        for direction in ("[1, 0, 0]", "[0, 1, 0]")
        for mode in modes
    ]
    return f"# {title}\n" + "".join(tables)


def assemble(
    path: str | Path | AssemblyFile, method: str | None = None, progress: Progress = no_progress
) -> Assembly:
    """Put a tool, a holder and a spindle together, at each stick-out.

    Parameters
    ----------
    path : str, Path or AssemblyFile
        The assembly file.
    method : str, optional
        Stability method of the lobes, as in `lobes`.
    progress : callable, optional
        Called with (done, total) stick-outs.

    Returns
    -------
    Assembly

    Raises
    ------
    InputError
        If the file, an entry that it names or a measured FRF cannot be used.
    RunError
        If a computed response shows no mode.
    """
    file = path if isinstance(path, AssemblyFile) else AssemblyFile.from_file(path)
    shipped = shipped_library()
    own = Library.from_file(file.library) if file.library is not None else shipped
    entries = own.over(shipped)
    tool = _entry(entries, "tool", file.tool.name, file)
    holder = _entry(entries, "holder", file.holder.name, file) if file.holder else None
    base = _base(file, entries, holder)
    case = load(file.case) if file.case is not None else None
    if case is not None:
        case.require("tool", "material", "cut")
    stick_outs = np.linspace(file.stick_out.shortest, file.stick_out.longest, file.stick_out.count)
    _check_stick_outs(file, tool, holder)
    receptance, fits, limits = [], [], []
    for done, stick_out in enumerate(stick_outs):
        progress(done, stick_outs.size)
        found = tool_point_receptance(file, base, tool, holder, float(stick_out))
        source = f"{file.name}: stick-out {1e3 * stick_out:.4g} mm"
        fit = tool_point_modes(tool_point_frf(base, found, source))
        receptance.append(found)
        fits.append(fit)
        if case is not None:
            limits.append(_limits(case, fit.modes, method))
    progress(stick_outs.size, stick_outs.size)
    return Assembly(
        file,
        stick_outs,
        base.frequency,
        np.stack(receptance),
        tuple(fits),
        _over_stick_out(case, tool, limits) if case is not None else None,
        tuple(_notes(case, tool, holder, file)),
        _units(case, file),
    )


def _units(case: Case | None, file: AssemblyFile) -> UnitSystem:
    if case is not None:
        return units_of(case)
    return units_of_content({"tool": file.stated.get("stick_out", {})})


def _entry(entries: Mapping[str, Mapping[str, Any]], kind: str, name: str, file: Any) -> Any:
    known = entries[kind]
    if name not in known:
        raise InputError(
            f'{file.name}: {kind}.name = "{name}" is not in the library; '
            f"{nearest(name, sorted(known))}"
        )
    return known[name]


def _base(
    file: AssemblyFile, entries: Mapping[str, Mapping[str, Any]], holder: HolderEntry | None
) -> Base:
    spindle = file.spindle
    if spindle.frf is not None:
        standard = spindle.standard_holder
        entry = _entry(entries, "holder", standard, file) if standard is not None else None
        return Base(*measured_spindle(spindle, entry, file.loss_factor))
    entry = _entry(entries, "spindle", str(spindle.name), file)
    if holder is None:
        raise InputError(
            f"{file.name}: holder is missing; a spindle of the library needs one, such as "
            f'[holder] name = "{next(iter(entries["holder"]))}"'
        )
    if holder.taper != entry.taper:
        raise InputError(
            f'{file.name}: holder.name = "{file.holder.name if file.holder else ""}" has taper '
            f'{holder.taper}; the spindle "{spindle.name}" takes {entry.taper}'
        )
    step, highest = file.frequencies.step, file.frequencies.to
    frequency = step * np.arange(1, int(highest / step + 1e-9) + 1)
    return Base(frequency, modelled_spindle(entry, frequency, file.loss_factor))


def _check_stick_outs(file: AssemblyFile, tool: ToolEntry, holder: HolderEntry | None) -> None:
    """Refuse stick-outs at which flutes are clamped or the shank is not held."""
    if file.stick_out.shortest < tool.flute_length:
        raise InputError(
            f"{file.name}: stick_out.shortest = {1e3 * file.stick_out.shortest:.4g} mm; the flutes "
            f"of the tool are {1e3 * tool.flute_length:.4g} mm long and must be outside"
        )
    held = holder.clamping_length if holder is not None else 0.0
    longest = tool.length - held
    if file.stick_out.longest > longest + 1e-9:
        raise InputError(
            f"{file.name}: stick_out.longest = {1e3 * file.stick_out.longest:.4g} mm; the tool is "
            f"{1e3 * tool.length:.4g} mm long, of which {1e3 * held:.4g} mm must be in the holder: "
            f"{1e3 * longest:.4g} mm at most"
        )
    if holder is not None and abs(holder.bore - tool.shank_diameter) > 1e-5:
        raise InputError(
            f"{file.name}: the shank of the tool is {1e3 * tool.shank_diameter:.4g} mm, the bore "
            f"of the holder {1e3 * holder.bore:.4g} mm"
        )


def _limits(
    case: Case, modes: Sequence[Mode], method: str | None
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Spindle speeds, critical depths and depths searched of a case on these modes."""
    tables = [
        {
            "frequency": mode.frequency,
            "damping": mode.damping,
            "mass": mode.mass,
            "direction": direction,
        }
        for direction in ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
        for mode in modes
    ]
    diagram = lobes(case.patch({"structure": {"mode": tables}}), method)
    speeds = diagram.axis.values * (2.0 * np.pi / 60.0)
    return speeds, diagram.limits.critical_depth, np.asarray(diagram.max_depth)


def _over_stick_out(
    case: Case, tool: ToolEntry, limits: Sequence[tuple[Any, Any, Any]]
) -> StickOutLobes:
    """Limits, usable depths and removal rates of all stick-outs."""
    speed = limits[0][0]
    critical = np.stack([one[1] for one in limits])
    searched = np.stack([np.broadcast_to(one[2], speed.shape) for one in limits])
    usable = np.minimum(np.where(np.isfinite(critical), critical, searched), tool.flute_length)
    cut, cutter = case.cut, case.tool
    if cut is None or cutter is None:
        raise InputError(f"{case.name}: [cut] and [tool] are needed for lobes")
    radial = cut.radial_depth if cut.radial_depth is not None else cutter.diameter
    rate = usable * radial * cut.feed_per_tooth * cutter.teeth * speed / (2.0 * np.pi)
    best = np.argmax(rate, axis=1)
    return StickOutLobes(speed, critical, usable, np.max(rate, axis=1), speed[best])


def _notes(
    case: Case | None, tool: ToolEntry, holder: HolderEntry | None, file: AssemblyFile
) -> list[str]:
    notes = ["the response is taken as alike in x and y: round sections, no gyroscopic terms"]
    if file.joint is None:
        notes.append(
            "the shank is one with the holder: no [joint] is given; damping is that of loss_factor "
            f"= {file.loss_factor:g} alone, to which limits are in proportion"
        )
    if holder is None:
        notes.append("the shank in the holder is part of what was measured")
    if file.spindle.frf is not None and file.spindle.behind_frf is None:
        notes.append(
            "the slope by a moment follows from one ruling mode; spindle.behind_frf measures it"
        )
    if case is not None and case.tool is not None:
        if abs(case.tool.diameter - tool.diameter) > 1e-5:
            notes.append(
                f"the case cuts with {1e3 * case.tool.diameter:.4g} mm, the tool of the assembly "
                f"has {1e3 * tool.diameter:.4g} mm"
            )
        if case.tool.teeth != tool.teeth:
            notes.append(f"the case has {case.tool.teeth} teeth, the tool {tool.teeth}")
    return notes
