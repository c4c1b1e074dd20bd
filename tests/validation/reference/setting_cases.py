"""Random milling cases of teeth set off along the axis, and of serrated edges.

Each tooth of the first kind sits too far down or up, which thickens or thins its chip on corners,
cones and balls; each edge of the second kind is a wave along the axis, so that tooth after tooth
takes what the earlier ones left standing, some of it a turn ago. Runout, unequal pitch and helix
and a size effect come along as in `dense_cases`.
"""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np

from . import dense_cases
from .dense_cases import converged_radius
from .general_cases import _crosses

SEED = 20261123
COUNTS = {"axial": 16, "serrated": 24, "sized": 4}
STORE = Path(__file__).with_name("setting_cases.json")
#: agreement of two resolutions of the reference, relative to max(1, |mu|)
_AGREEMENT = 3e-5
_PATIENCE = 90


def axial_cut(rng):
    """One cut of a tool with a corner or a cone, its teeth set off along the axis."""
    cut = dense_cases.random_cut(rng)
    size = cut.feed * 10.0 ** rng.uniform(-1.2, 0.7)
    axial = tuple(float(part) for part in size * rng.uniform(-1.0, 1.0, cut.teeth))
    return replace(cut, axial=axial)


def serrated_cut(rng):
    """One cut of a serrated edge, from shallow fine waves to deep coarse ones."""
    cut = dense_cases.random_cut(rng)
    deepest = 0.5 * cut.diameter if cut.corner_radius == 0.5 * cut.diameter else cut.diameter
    waves = float(10.0 ** rng.uniform(-0.3, 0.5))
    depth = float(min(cut.depth, deepest))
    wavelength = depth / waves
    # what matters is the depth of a wave against the feed in a turn
    feed = cut.feed * cut.teeth
    wave = float(min(feed * 10.0 ** rng.uniform(-1.0, 1.0), 0.35 * wavelength))
    upright = rng.random() < 0.6
    if upright:
        cut = replace(cut, corner_radius=0.0, edge_angle=0.5 * np.pi)
    if rng.random() < 0.5:
        cut = replace(cut, helix=(cut.helix[0],) * cut.teeth)
    if rng.random() < 0.5:
        cut = replace(cut, offsets=())
    if rng.random() < 0.7:
        cut = replace(cut, exponent=1.0)
    return replace(cut, depth=depth, serration=(wave, wavelength), variation=None)


def sized_cut(rng):
    """One cut of an upright serrated edge in a material of a size effect: few waves, few teeth."""
    cut = serrated_cut(rng)
    depth = min(cut.depth, 1.2 * cut.serration[1])
    return replace(
        cut, depth=depth, corner_radius=0.0, edge_angle=0.5 * np.pi, offsets=(),
        helix=(cut.helix[0],) * cut.teeth, exponent=float(rng.uniform(0.65, 0.95)),
    )  # fmt: skip


def axial_cuts(rng):
    """Yield cuts whose chips the axial errors change."""
    while True:
        cut = axial_cut(rng)
        if (cut.corner_radius or cut.edge_angle < 1.5) and not _crosses(cut):
            yield cut


def serrated_cuts(rng):
    """Yield serrated cuts whose flutes do not run into each other."""
    while True:
        cut = serrated_cut(rng)
        if not _crosses(cut):
            yield cut


def sized_cuts(rng):
    """Yield serrated cuts with a size effect, of two or three teeth."""
    while True:
        cut = sized_cut(rng)
        if cut.teeth < 4 and any(cut.helix):
            yield cut


def case_dict(cut):
    """Return the case that describes the same problem."""
    case = dense_cases.case_dict(cut)
    if cut.axial:
        case["tool"]["axial_error"] = list(cut.axial)
    if cut.serration:
        depth, wavelength = cut.serration
        case["tool"]["serration"] = {"depth": depth, "wavelength": wavelength}
    return case


_KINDS = {"axial": axial_cuts, "serrated": serrated_cuts, "sized": sized_cuts}


def make(path=STORE, counts=None, seed=SEED):
    """Write the cases with converged multipliers; run as a module to make the file anew."""
    counts = counts or COUNTS
    rows = []
    for kind, cuts in _KINDS.items():
        wanted = len(rows) + counts[kind]
        for cut in cuts(np.random.default_rng(seed)):
            if len(rows) >= wanted:
                break
            found = converged_radius(cut, _PATIENCE)
            if found is None or found[1] > _AGREEMENT * max(1.0, found[0]):
                continue
            rows.append({"cut": asdict(cut), "spectral_radius": found[0], "change": found[1]})
            print(kind, len(rows), *found, flush=True)
            lines = ",\n".join(json.dumps(row) for row in rows)
            path.write_text(f'{{"seed": {seed}, "cases": [\n{lines}\n]}}\n', "utf-8")


if __name__ == "__main__":
    make()
