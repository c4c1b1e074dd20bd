"""Result of a simulation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class SimulationResult:
    setup: object
    rows: np.ndarray
    energy: dict
    complete: bool
    @property
    def force(self): return self.rows[:, :3]
    @property
    def displacement(self): return self.rows[:, 3:6]
    @property
    def time(self): return np.arange(len(self.rows))*self.setup.resolution.stride*self.setup.step
