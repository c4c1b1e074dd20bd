"""The portal of machine.toml as its head travels: natural frequencies, a move and a slot.

The crossbeam is the super-element of this folder. Beside it stands the same machine with a round
tube in its place, of the same mass, section and mean bending stiffness: what beams miss. The move
and the slot of case.toml run with a structure that follows the head, and with one that stays as at
the start.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import numpy as np
import tomlkit
from numpy.typing import NDArray

import chatter
from chatter.compile.machine_parts import assembled_machine
from chatter.description.machine.machine_file import MachineFile
from chatter.plots.style import BLUE, ORANGE, finish, new_figure
from chatter.simulation.result import SimulationResult
from dynamics.reduction.modal_truncation import undamped_modes

HERE = Path(__file__).parent
# Places of the head from the middle of the beam, m.
PLACES = (-0.45, 0.0, 0.45)
# A tube with the box's area (156 cm^2) and the mean of its two second moments (17 640 cm^4).
TUBE = """
[beam.crossbeam]
origin = ["0 mm", "125 mm", "150 mm"]
axis = [1, 0, 0]
material = { young = "210 GPa", density = "11310 kg/m^3" } # with ribs, rails and flanges: 352.9 kg
segments = [{ length = "2000 mm", outer = "316.5 mm", inner = "283.4 mm", elements = 16 }]
"""


def machine_of_beams(folder: Path) -> MachineFile:
    """Read the machine with a tube for its crossbeam, written to a folder."""
    document = tomlkit.parse((HERE / "machine.toml").read_text(encoding="utf-8"))
    del document["imported"]
    path = folder / "machine-of-beams.toml"
    path.write_text(tomlkit.dumps(document) + TUBE, encoding="utf-8")
    return chatter.load_machine(path)


def frequencies(file: MachineFile, place: float) -> NDArray[np.float64]:
    """Natural frequencies below 300 Hz with the head at a place, m; Hz."""
    found = undamped_modes(assembled_machine(file, positions={"X": place}).structure, 300.0)
    return found.frequency[found.frequency > 0.0]


def print_frequencies(file: MachineFile) -> None:
    """Print natural frequencies of both machines along the beam."""
    with tempfile.TemporaryDirectory() as folder:
        for name, one in (("solid", file), ("tube", machine_of_beams(Path(folder)))):
            for place in PLACES:
                shown = ", ".join(f"{value:.1f}" for value in frequencies(one, place))
                print(f"{name}, head at {1e3 * place:+4.0f} mm: {shown} Hz")


def run_cut(positions: int | None, duration: str) -> tuple[SimulationResult, float]:
    """Run the slot with a structure at so many positions, and take its time, s."""
    changes: dict[str, str | int] = {"simulation.duration": duration}
    if positions is not None:
        changes["structure.travel_positions"] = positions
    begun = time.process_time()
    result = chatter.simulate(chatter.load(HERE / "case.toml"), changes)
    return result, time.process_time() - begun


def print_energy(what: str, energy: dict[str, float]) -> None:
    """Print the energy of a run, and what is missing in its balance."""
    missing = energy["work"] + energy["travel"] - energy["dissipated"] - energy["stored"]
    listed = ", ".join(f"{key} {1e3 * value:.4g} mJ" for key, value in energy.items())
    print(f"{what}: {listed}; missing {1e3 * missing:.2g} mJ")


def main(out: Path, duration: str = "2.5 s") -> list[Path]:
    """Print frequencies, energies and times, draw the slot, return the picture."""
    file = chatter.load_machine(HERE / "machine.toml")
    print_frequencies(file)
    move = chatter.move(file, "across")
    print_energy("move of 0.8 m", move.energy)
    run_cut(1, "0.05 s"), run_cut(None, "0.05 s")  # compiled before they are timed
    still, time_still = run_cut(1, duration)
    following, time_following = run_cut(None, duration)
    print_energy("slot", following.energy)
    print(f"slot: {time_still:.1f} s with the structure as at the start, {time_following:.1f} s")
    figure = new_figure(7.5, 4.0)
    panel = figure.subplots()
    for result, colour, label in (
        (still, ORANGE, "structure as at the start"),
        (following, BLUE, "structure that follows the head"),
    ):
        panel.plot(result.time, 1e6 * result.displacement[:, 1], color=colour, lw=0.6, label=label)
    panel.set_xlabel("time [s]")
    panel.set_ylabel("tool across the slot [um]")
    panel.set_title("Slot along the crossbeam of solid elements")
    panel.legend(frameon=False, fontsize=9)
    finish(panel)
    out.mkdir(parents=True, exist_ok=True)
    picture = out / "slot-along-the-beam.png"
    figure.savefig(picture)
    return [picture]


if __name__ == "__main__":
    main(Path("out"))
