"""What keeps a search from finding anything: which limits exclude how much of the coarse grid."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from chatter.description.unit_system import units_of
from chatter.studies.optimisation.limits import LIMITED
from chatter.studies.optimisation.speed_depth_slice import STABILITY, SpeedDepthSlice

#: quantity that is limited -> factor from SI, and unit
_UNIT = {
    "power": (1e-3, "kW"),
    "torque": (1.0, "N m"),
    "deflection": (1e6, "um"),
    "surface_error": (1e6, "um"),
}


@dataclass(frozen=True)
class Exclusion:
    """What one limit does to the coarse grid."""

    limit: str  # key of [optimum], or "stability"
    excluded: float  # share of all points that it excludes
    alone: int  # points that hold every other limit, and not this one
    smallest: str  # smallest value found where the cut is stable; empty for stability

    @property
    def excludes_all(self) -> bool:
        """Whether no point holds this limit."""
        return self.excluded >= 1.0


def exclusions(grid_slices: Sequence[SpeedDepthSlice]) -> tuple[Exclusion, ...]:
    """What each limit excludes of the coarse grid."""
    held = {
        name: np.stack([grid_slice.satisfied[name] for grid_slice in grid_slices])
        for name in grid_slices[0].satisfied
    }
    return tuple(
        Exclusion(
            limit=name,
            excluded=float(1.0 - here.mean()),
            alone=int((_all_but(held, name) & ~here).sum()),
            smallest=_smallest(grid_slices, name),
        )
        for name, here in held.items()
    )


def _all_but(held: dict[str, np.ndarray], name: str) -> np.ndarray:
    others = [values for key, values in held.items() if key != name]
    return np.logical_and.reduce(others) if others else np.ones_like(held[name])


def _smallest(grid_slices: Sequence[SpeedDepthSlice], name: str) -> str:
    if name == STABILITY:
        return ""
    factor, unit = _UNIT[LIMITED[name]]
    found = [np.abs(getattr(grid_slice.cuts, LIMITED[name])) for grid_slice in grid_slices]
    values = np.stack(found)
    known = values[np.isfinite(values)]
    read = units_of(grid_slices[0].case).instead_of(unit)
    return read.text(known.min() * factor) if known.size else ""


def why_nothing(found: Sequence[Exclusion]) -> str:
    """Say in a sentence or two what excludes everything."""
    alone = [one for one in found if one.excludes_all]
    if alone:
        report = "; ".join(
            f"{one.limit} is held nowhere"
            + (f" (smallest where the cut is stable: {one.smallest})" if one.smallest else "")
            for one in alone
        )
        return f"no cut of the grid keeps all limits: {report}"
    near = max(found, key=lambda one: one.alone)
    shares = ", ".join(f"{one.limit} excludes {one.excluded:.1%}" for one in found)
    hint = f"; without {near.limit}, {near.alone} points would be left" if near.alone else ""
    return f"no cut of the grid keeps all limits together: {shares}{hint}"
