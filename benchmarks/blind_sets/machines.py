"""Tools on machines of four classes, drawn at random: from a small end mill to a face mill."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Range = tuple[float, float]


@dataclass(frozen=True)
class MachineClass:
    """Ranges that a tool, its work and its machine are drawn from; SI but for rpm."""

    teeth: int
    diameter: float
    helix_deg: float
    Ktc: Range
    radial_share: Range  # Krc over Ktc
    Kte: Range
    Kre: Range
    modes: tuple[tuple[str, Range, Range, Range], ...]  # direction, Hz, damping, kg
    rpm: Range
    feed: Range
    depth: Range
    radial_depth: Range


@dataclass(frozen=True)
class Machine:
    """One drawn tool and machine."""

    kind: MachineClass
    Ktc: float
    Krc: float
    Kte: float
    Kre: float
    frequency: np.ndarray
    damping: np.ndarray
    mass: np.ndarray
    direction: np.ndarray  # (M, 2)


_SMALL = MachineClass(
    2, 12e-3, 30.0, (640e6, 860e6), (0.22, 0.3), (11e3, 17e3), (9e3, 14e3),
    (("x", (820.0, 980.0), (0.02, 0.032), (0.11, 0.14)),
     ("y", (820.0, 980.0), (0.02, 0.032), (0.11, 0.14))),
    (8000.0, 14000.0), (0.04e-3, 0.12e-3), (0.3e-3, 1.3e-3), (3e-3, 11e-3),
)  # fmt: skip
_MIDDLE = MachineClass(
    4, 16e-3, 30.0, (760e6, 960e6), (0.17, 0.26), (21e3, 31e3), (26e3, 39e3),
    (("x", (640.0, 770.0), (0.025, 0.04), (0.5, 0.64)),
     ("y", (640.0, 770.0), (0.025, 0.04), (0.5, 0.64))),
    (2800.0, 9000.0), (0.04e-3, 0.15e-3), (0.5e-3, 3.0e-3), (4e-3, 14e-3),
)  # fmt: skip
_STEEL = MachineClass(
    3, 20e-3, 30.0, (1450e6, 1900e6), (0.35, 0.52), (18e3, 30e3), (36e3, 50e3),
    (("x", (510.0, 630.0), (0.022, 0.036), (1.0, 1.3)),
     ("y", (510.0, 630.0), (0.022, 0.036), (1.0, 1.3))),
    (800.0, 2400.0), (0.05e-3, 0.12e-3), (0.5e-3, 2.3e-3), (3e-3, 14e-3),
)  # fmt: skip
_FACE = MachineClass(
    5, 50e-3, 14.0, (1850e6, 2150e6), (0.33, 0.4), (38e3, 48e3), (42e3, 54e3),
    (("y", (49.0, 54.0), (0.037, 0.043), (390.0, 500.0)),
     ("x", (200.0, 215.0), (0.037, 0.048), (60.0, 70.0)),
     ("y", (250.0, 265.0), (0.038, 0.046), (49.0, 60.0))),
    (510.0, 820.0), (0.08e-3, 0.25e-3), (0.5e-3, 2.8e-3), (8e-3, 29e-3),
)  # fmt: skip
CLASSES = {"small": _SMALL, "middle": _MIDDLE, "steel": _STEEL, "face": _FACE}


def draw_machine(rng: np.random.Generator, names: tuple[str, ...] = tuple(CLASSES)) -> Machine:
    """A machine of one of the classes."""
    kind = CLASSES[str(rng.choice(names))]
    Ktc = float(rng.uniform(*kind.Ktc))
    count = len(kind.modes)
    frequency, damping, mass = np.zeros(count), np.zeros(count), np.zeros(count)
    direction = np.zeros((count, 2))
    for m, (axis, frequencies, dampings, masses) in enumerate(kind.modes):
        frequency[m] = rng.uniform(*frequencies)
        damping[m] = rng.uniform(*dampings)
        mass[m] = rng.uniform(*masses)
        direction[m, "xy".index(axis)] = 1.0
    return Machine(
        kind, Ktc, Ktc * float(rng.uniform(*kind.radial_share)), float(rng.uniform(*kind.Kte)),
        float(rng.uniform(*kind.Kre)), frequency, damping, mass, direction,
    )  # fmt: skip


def tool_table(kind: MachineClass, helix_deg: float | None = None) -> dict[str, object]:
    """[tool] of a case."""
    return {
        "kind": "end mill",
        "teeth": kind.teeth,
        "diameter": f"{kind.diameter * 1e3:g} mm",
        "helix": f"{kind.helix_deg if helix_deg is None else helix_deg:g} deg",
    }
