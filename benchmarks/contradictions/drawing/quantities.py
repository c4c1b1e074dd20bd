"""Random numbers, and quantities as text with units."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeVar

import numpy as np

Choice = TypeVar("Choice")


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Number whose logarithm is uniform between those of two bounds."""
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def chosen(rng: np.random.Generator, options: Sequence[Choice]) -> Choice:
    """One of some options, all alike."""
    return options[int(rng.integers(len(options)))]


def happens(rng: np.random.Generator, probability: float) -> bool:
    """Whether an event of a probability happens."""
    return bool(rng.random() < probability)


def text(value: float, unit: str) -> str:
    """Quantity as case files have it, with six digits."""
    return f"{value:.6g} {unit}"


def number_of(quantity: str) -> float:
    """Number of a quantity as `text` wrote it."""
    return float(quantity.split()[0])
