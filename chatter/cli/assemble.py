"""`chatter assemble ASSEMBLY`: tool, holder and spindle put together, over the stick-out."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from chatter.cli import options
from chatter.cli.progress import progress_bar
from chatter.cli.results import present
from chatter.description.errors import InputError
from chatter.report.console import print_answer, print_line, print_table

if TYPE_CHECKING:
    from chatter.assembly.assemble import Assembly
    from chatter.description.usual_units import UsualUnit


def assemble(
    assembly: Annotated[
        Path | None, typer.Argument(metavar="ASSEMBLY", help="Assembly file (TOML).")
    ] = None,
    assignments: options.Assignments = None,
    method: Annotated[
        str | None, typer.Option("--method", help="Stability method of the lobes.")
    ] = None,
    library: Annotated[
        bool, typer.Option("--library", help="List the entries that an assembly may name.")
    ] = False,
    catalogue: Annotated[
        Path | None,
        typer.Option("--import", metavar="CSV", help="Make a library of the rows of a catalogue."),
    ] = None,
    out: options.OutputFolder = None,
    json: options.Json = False,
) -> None:
    """Tool point, modes and lobes of a tool in a holder on a spindle, over the stick-out."""
    if library:
        _print_library()
        return
    if catalogue is not None:
        _import(catalogue, options.output_folder(out, catalogue.stem))
        return
    if assembly is None:
        raise InputError("assemble needs an ASSEMBLY file, --library or --import CSV")
    from chatter.assembly.assemble import assemble as run_assemble
    from chatter.assembly.assembly_file import AssemblyFile

    file = options.patched(AssemblyFile.from_file(assembly), assignments)
    folder = options.output_folder(out, assembly.stem)
    with progress_bar("stick-outs") as progress:
        found = run_assemble(file, method, progress)
    present(found, folder, json=json, words=_print_assembly, notes=found.notes)


def _print_assembly(found: Assembly) -> None:
    summary = found.summary()
    length, removal = found.units.instead_of("mm"), found.units.instead_of("cm³/min")
    rows = []
    for one in summary["stick_outs"]:
        stiffest = max(one["modes"], key=lambda m: 1 / (m["mass_kg"] * m["damping"]))
        rows.append(
            [
                f"{one['stick_out_mm'] * length.factor:.4g}",
                f"{1e6 * one['peak_receptance_m_per_N']:.3g}",
                f"{stiffest['frequency_Hz']:.0f}",
                _shown(one.get("lowest_critical_depth_mm"), length),
                _shown(one.get("removal_rate_cm3_per_min"), removal),
                "" if found.lobes is None else f"{one['at_spindle_speed_rpm']:.0f}",
            ]
        )
    headers = [
        f"stick-out [{length.name}]",
        "peak [um/N]",
        "mode [Hz]",
        f"lowest limit [{length.name}]",
        f"removal [{removal.name}]",
        "at [rpm]",
    ]
    print_table(found.file.title or found.file.name, headers, rows)
    best = length.text(summary["best_stick_out_mm"])
    print_answer(f"best stick-out {best} by {summary['best_by']}")


def _shown(value: float | None, unit: UsualUnit) -> str:
    return "" if value is None else f"{value * unit.factor:.3g}"


def _print_library() -> None:
    from chatter.assembly.library import shipped_library

    shipped = shipped_library()
    for kind in ("tool", "holder", "spindle"):
        rows = [[name, entry.source] for name, entry in getattr(shipped, kind).items()]
        print_table(kind, ["name", "source"], rows)


def _import(catalogue: Path, folder: Path) -> None:
    from chatter.assembly.catalogue import library_of_catalogue

    text, names = library_of_catalogue(catalogue)
    folder.mkdir(parents=True, exist_ok=True)
    written = folder / "library.toml"
    written.write_text(text, encoding="utf-8")
    listed = ", ".join(names[:5]) + (", ..." if len(names) > 5 else "")
    print_line(f"{len(names)} {'tool' if len(names) == 1 else 'tools'}: {listed}")
    print_line(f"wrote {written}")
