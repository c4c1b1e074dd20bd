"""Modal test: measured FRFs or a folder of hammer records to modal parameters at the tool point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from chatter.compile.measured_frf import with_direction, with_magnitudes
from chatter.description.errors import InputError
from chatter.description.given_path import paths_given
from chatter.description.given_values import whole_number_given
from chatter.io.formats.format_list import read_frfs
from chatter.io.hammer_records import (
    HammerFolder,
    StatedRecord,
    is_hammer_record,
    read_hammer_folder,
    read_hammer_records,
)
from chatter.io.presentation import presentation
from chatter.io.result_files import NotebookResult, as_json, write_results
from dynamics.frf.container import Frf, MeasurementError
from dynamics.frf.hammer.averaging import HammerTest, hammer_test
from dynamics.frf.hammer.record import Finding
from dynamics.identification.fit import identify_modes
from dynamics.identification.mode_indicators import modal_assurance, mode_indicator_function
from dynamics.identification.result import IdentifiedMode, ModalFit
from dynamics.modal.modes import Side

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: most modes that one may ask for
_MOST_MODES = 1000


@dataclass(frozen=True, repr=False)
class ModalTest(NotebookResult):
    """Modal parameters of a measured structure.

    Parameters
    ----------
    title : str
    fit : ModalFit
    side : str
    hammer : HammerTest or None
        Records used and left out, where hammer records were given.
    notes : tuple of str
        What a person should know.
    """

    title: str
    fit: ModalFit
    side: Side
    hammer: HammerTest | None = None
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        """Short: what it holds would fill the screen."""
        return f"<ModalTest {self.title!r}, {len(self.fit.identified)} modes>"

    def summary(self) -> dict:
        """Return the content of summary.json."""
        errors = self.fit.errors
        indicator = mode_indicator_function(self.fit.undelayed_frfs)
        return {
            "title": self.title,
            "band_Hz": [self.fit.band.lowest, self.fit.band.highest],
            "band_reason": self.fit.band.reason,
            "modes": [
                _mode_summary(mode, float(np.interp(mode.frequency, *indicator)))
                for mode in self.fit.identified
            ],
            "channel_delay_s": [model.delay for model in self.fit.models],
            "modal_assurance": _modal_assurance(self.fit),
            "fit_error": {
                "metric": "deviation of fitted from measured over the band, relative to the peak",
                "maximum": max(error.maximum for error in errors),
                "rms": max(error.rms for error in errors),
                "maximum_as_receptance": max(error.maximum_receptance for error in errors),
                "rms_as_receptance": max(error.rms_receptance for error in errors),
            },
            "frfs": [
                {"source": frf.source, "quantity": frf.quantity, "lines": int(frf.frequency.size)}
                | {"maximum": error.maximum, "rms": error.rms}
                for frf, error in zip(self.fit.frfs, errors, strict=True)
            ],
            "records": _records_summary(self.hammer),
            "notes": [*self.notes, *self.fit.warnings],
        }

    def to_toml(self) -> str:
        """Return the modes as ``[[structure.mode]]`` tables for a case file."""
        return f"# {self.title}\n" + "".join(
            _mode_table(mode, self.side) for mode in self.fit.identified
        )

    def sentences(self) -> list[str]:
        """Return the title, and a line for each mode that was identified."""
        return [self.title] + [
            f"{mode.frequency:.4g} Hz, damping {mode.damping:.2%}, "
            + (f"{mode.mass:.4g} kg" if mode.mass else "no mass")
            for mode in self.fit.identified
        ]

    def plot(self) -> Figure:
        """Return the picture of measured against fitted."""
        return presentation("plots.modes").plot_fit(self.fit, self.title)

    def plot_stabilisation(self) -> Figure:
        """Return the stabilisation diagram."""
        return presentation("plots.modes").plot_stabilisation(self.fit, self.title)

    def save(self, folder: str | Path) -> list[Path]:
        """Write modes.toml, summary.json, modes.png and stabilisation.png; return their paths."""
        return write_results(
            folder,
            {"modes.toml": self.to_toml(), "summary.json": as_json(self.summary())},
            {"modes.png": self.plot(), "stabilisation.png": self.plot_stabilisation()},
        )


def _modal_assurance(fit: ModalFit) -> list[list[float]] | None:
    """MAC between the modes; None of one FRF, where all shapes are alike."""
    if len(fit.frfs) < 2 or not fit.identified:
        return None
    return modal_assurance(np.stack([mode.residues for mode in fit.identified])).tolist()


def _mode_summary(mode: IdentifiedMode, indicator: float) -> dict:
    return {
        "frequency_Hz": mode.frequency,
        "mode_indicator": indicator,
        "damping": mode.damping,
        "mass_kg": mode.mass,
        "direction": None if mode.direction is None else list(mode.direction),
        "frequency_std_Hz": mode.frequency_std,
        "damping_std": mode.damping_std,
        "mass_std_kg": mode.mass_std,
        "fit_error": mode.fit_error,
        "warning": mode.warning,
    }


def _records_summary(hammer: HammerTest | None) -> dict:
    if hammer is None:
        return {"used": [], "excluded": [], "remarks": []}
    return {
        "used": list(hammer.used),
        "excluded": [_finding(finding) for finding in hammer.excluded],
        "remarks": [_finding(finding) for finding in hammer.remarks],
    }


def _finding(finding: Finding) -> dict:
    return {"record": finding.record, "fault": finding.fault, "reason": finding.reason}


def _mode_table(mode: IdentifiedMode, side: Side) -> str:
    if mode.mass is None:
        where = f"mode at {mode.frequency:.6g} Hz, damping {mode.damping:.5g}"
        return f"\n# {where}: no drive point, so no mass\n"
    direction = ", ".join(f"{part:.7g}" for part in mode.direction)
    warning = f"# doubtful: {mode.warning}\n" if mode.warning else ""
    return (
        f"\n{warning}[[structure.mode]]\n"
        f'frequency = "{mode.frequency:.8g} Hz"    # +- {mode.frequency_std:.2g} Hz\n'
        f"damping = {mode.damping:.6g}    # +- {mode.damping_std:.2g}\n"
        f'mass = "{mode.mass:.7g} kg"{_spread(mode.mass_std)}\n'
        f"direction = [{direction}]\n"
        f'side = "{side}"\n'
    )


def _spread(deviation: float | None) -> str:
    return "" if deviation is None else f"    # +- {deviation:.2g} kg"


def modes(
    paths: Sequence[str | Path] | str | Path,
    *,
    keep: Sequence[str] = (),
    direction: str | None = None,
    side: Side = "tool",
    band: tuple[float, float] | None = None,
    mode_count: int | None = None,
    columns: str | StatedRecord | None = None,
    poles: Sequence[tuple[float, float]] | None = None,
) -> ModalTest:
    """Identify modal parameters from measured FRFs, or from hammer records.

    Parameters
    ----------
    paths : path or sequence of paths
        FRF files, hammer records, or one folder of hammer records, of any format.
    keep : sequence of str
        Names of hammer records that are used in spite of their faults.
    direction : str, optional
        ``"x"``, ``"y"`` or ``"z"``, where the files do not say.
    side : {"tool", "workpiece"}
    band : (float, float), optional
        Hz; found from the data where not given.
    mode_count : int, optional
        Found from the data where not given.
    columns : str or StatedRecord, optional
        Names and units of the columns of hammer records that have no heading, such as
        ``"time [s], force [N], acceleration [m/s^2]"``; or with the sampling rate, Hz, of records
        that have no time.
    poles : sequence of (float, float), optional
        Frequencies, Hz, and damping ratios picked in the stabilisation diagram: these modes are
        refined, none is added or dropped.

    Returns
    -------
    ModalTest

    Raises
    ------
    InputError
        If the files cannot be read or used.
    """
    given = paths_given(paths, "an FRF file or a hammer record")
    if side not in ("tool", "workpiece"):
        raise InputError(f'side "{side}" is not known; there are "tool" and "workpiece"')
    if direction is not None and direction not in ("x", "y", "z"):
        raise InputError(f'direction "{direction}" is not known; there are "x", "y" and "z"')
    if not given:
        raise InputError("a file of FRFs or of a hammer record is required; none is given")
    if mode_count is not None:
        whole_number_given(mode_count, "--mode-count", 1, _MOST_MODES)
    stated = columns if isinstance(columns, StatedRecord) else StatedRecord(columns)
    try:
        frfs, hammer, notes = _read(given, keep, stated)
        frfs, assumed = _with_default_direction(frfs, direction)
        fit = with_magnitudes(identify_modes(frfs, band=band, mode_count=mode_count, poles=poles))
    except MeasurementError as error:
        raise InputError(str(error)) from error
    notes += assumed
    if fit.no_mass_reason:
        notes.append(f"no modal masses: {fit.no_mass_reason}")
    title = ", ".join(path.name or str(path) for path in given[:3])
    return ModalTest(title, fit, side, hammer, (*notes, *fit.notes))


def _read(
    paths: Sequence[Path], keep: Sequence[str], stated: StatedRecord
) -> tuple[list[Frf], HammerTest | None, list[str]]:
    """Read FRF files or hammer records, one folder or files; the notes hold the remarks."""
    folders = [path for path in paths if path.is_dir()]
    if folders and len(paths) > 1:
        raise InputError(f"{folders[0]}: is a folder; a folder of hammer records is given alone")
    folder = _records(paths, stated)
    if folder is not None:
        test = hammer_test(folder.records, keep=keep, unreadable=folder.unreadable)
        notes = [f"{finding.record}: {finding.reason}" for finding in test.remarks]
        return list(test.frfs), test, notes
    if keep:
        raise InputError("--keep names hammer records; FRF files were given")
    return [frf for path in paths for frf in read_frfs(path)], None, []


def _records(paths: Sequence[Path], stated: StatedRecord) -> HammerFolder | None:
    """Hammer records of a folder, or of files that are time records; None of FRF files."""
    columns, rate = stated.columns, stated.sampling_rate
    if paths[0].is_dir():
        return read_hammer_folder(paths[0], columns, rate)
    if columns is None and not all(is_hammer_record(p) and not _holds_frfs(p) for p in paths):
        return None
    read = [read_hammer_records(path, columns, rate) for path in paths]
    return HammerFolder(
        tuple(record for one in read for record in one.records),
        tuple(named for one in read for named in one.unreadable),
    )


def _holds_frfs(path: Path) -> bool:
    try:
        return bool(read_frfs(path))
    except MeasurementError:
        return False


def _with_default_direction(
    frfs: Sequence[Frf], direction: str | None
) -> tuple[list[Frf], list[str]]:
    """Give FRFs without a direction the one asked for, else x, and say so."""
    unnamed = [not (frf.response.direction and frf.reference.direction) for frf in frfs]
    if direction is not None:
        return [with_direction(frf, direction, direction) for frf in frfs], []
    if not any(unnamed):
        return list(frfs), []
    note = "the files name no direction: x is written; --direction says otherwise"
    return [
        with_direction(frf, "x", "x") if bare else frf
        for frf, bare in zip(frfs, unnamed, strict=True)
    ], [note]
