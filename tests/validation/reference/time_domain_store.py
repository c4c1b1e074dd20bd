"""Random cuts with reference signals of the whole run, made once and stored.

python -m tests.validation.reference.time_domain_store

Only cuts whose signals stand when the steps of the reference are halved and its slices doubled are
kept: a cut that chatters chaotically has no signals to compare with.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from tests.validation.reference.time_domain import (
    ReferenceCut,
    ReferenceMode,
    nrmse,
    random_cut,
    simulate,
    suggested_steps,
)

STORE = Path(__file__).with_name("time_domain_cuts.npz")
SEED = 20261121
COUNT = 16
REVOLUTIONS = 12
SAMPLES = 101  # a revolution; no divisor of a turn, so that jumps are rarely met
PHASE = 0.37
SIGNALS = ("Fx", "Fy", "Fz", "x", "y")
LARGEST_CHANGE = 2e-3


def as_dict(cut: ReferenceCut) -> dict:
    """Plain data of a cut."""
    data = {name: getattr(cut, name) for name in cut.__dataclass_fields__}
    data["modes"] = [list(mode.__dict__.values()) for mode in cut.modes]
    return data


def from_dict(data: dict) -> ReferenceCut:
    """Cut from its plain data."""
    modes = tuple(ReferenceMode(f, z, m, tuple(d), side) for f, z, m, d, side in data["modes"])
    lists = {name: tuple(data[name]) for name in ("pitch", "helix")}
    return ReferenceCut(**{**data, **lists, "modes": modes})


def signals_of(cut: ReferenceCut, refine: int) -> np.ndarray:
    """Signals (samples, 5) of the reference, its steps and slices refined."""
    steps = refine * suggested_steps(cut)
    record = simulate(cut, REVOLUTIONS, SAMPLES, steps, 150 * refine, phase=PHASE)
    return np.stack([getattr(record, name) for name in SIGNALS], axis=1)


def sample_times(cut: ReferenceCut) -> np.ndarray:
    """Times of the samples, s."""
    return (np.arange(REVOLUTIONS * SAMPLES) + PHASE) * (cut.period / SAMPLES)


def make(path: Path = STORE) -> None:
    """Draw the cuts and write them with their signals."""
    rng = np.random.default_rng(SEED)
    cuts, stored = [], []
    while len(cuts) < COUNT:
        cut = random_cut(rng)
        coarse, fine = signals_of(cut, 1), signals_of(cut, 2)
        change = max(nrmse(coarse[:, i], fine[:, i]) for i in range(len(SIGNALS)))
        print(f"{len(cuts):2d} {change:.1e} {cut}"[:150], flush=True)
        if change < LARGEST_CHANGE:
            cuts.append(as_dict(cut))
            stored.append(fine.astype(np.float32))
    np.savez_compressed(path, cuts=np.array(json.dumps(cuts)), signals=np.stack(stored))


def load(path: Path = STORE) -> list[tuple[ReferenceCut, np.ndarray]]:
    """Stored cuts, each with its signals (samples, 5) in N and m."""
    with np.load(path, allow_pickle=False) as content:
        cuts = [from_dict(data) for data in json.loads(str(content["cuts"]))]
        return list(zip(cuts, content["signals"].astype(float), strict=True))


if __name__ == "__main__":
    make()
