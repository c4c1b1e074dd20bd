"""Random materials."""

from __future__ import annotations

import numpy as np

from benchmarks.contradictions.confrontation import Document
from benchmarks.contradictions.drawing.quantities import chosen, happens, log_uniform, text
from cutting.material.table import MATERIALS


def any_material(rng: np.random.Generator) -> Document:
    """Material of any law, or of the table."""
    return chosen(rng, (linear, linear, exponential, oblique, named))(rng)


def linear(rng: np.random.Generator) -> Document:
    """Linear law, with edge terms in half of the draws."""
    return {"law": "linear", **_coefficients(rng)}


def exponential(rng: np.random.Generator) -> Document:
    """Exponential law with exponents from 0.5 to 1."""
    return {
        "law": "exponential",
        **_coefficients(rng),
        "h0": text(log_uniform(rng, 0.03, 1.0), "mm"),
        "exponent": round(rng.uniform(0.5, 1.0), 3),
    }


def oblique(rng: np.random.Generator) -> Document:
    """Oblique transformation of orthogonal data."""
    material = {
        "law": "oblique",
        "shear_stress": text(rng.uniform(200.0, 900.0), "MPa"),
        "friction_angle": text(rng.uniform(15.0, 35.0), "deg"),
        "shear_angle": text(rng.uniform(18.0, 38.0), "deg"),
        "rake_angle": text(rng.uniform(-6.0, 15.0), "deg"),
    }
    if happens(rng, 0.5):
        material["Kte"] = text(rng.uniform(5.0, 50.0), "N/mm")
        material["Kre"] = text(rng.uniform(5.0, 60.0), "N/mm")
    return material


def named(rng: np.random.Generator) -> Document:
    """A row of the table of materials with the linear law; exponential laws are drawn apart."""
    linear_rows = [name for name, row in MATERIALS.items() if row.law == "linear"]
    return {"name": chosen(rng, linear_rows)}


def _coefficients(rng: np.random.Generator) -> Document:
    tangential = log_uniform(rng, 300.0, 3500.0)
    material = {
        "Ktc": text(tangential, "MPa"),
        "Krc": text(tangential * rng.uniform(0.1, 0.7), "MPa"),
        "Kac": text(tangential * rng.uniform(0.0, 0.4), "MPa"),
    }
    if happens(rng, 0.5):
        material["Kte"] = text(rng.uniform(5.0, 60.0), "N/mm")
        material["Kre"] = text(rng.uniform(5.0, 80.0), "N/mm")
        material["Kae"] = text(rng.uniform(0.0, 5.0), "N/mm")
    return material


def tangential_coefficient(material: Document) -> float:
    """About the tangential cutting coefficient, N/m^2: it scales structures."""
    if "name" in material:
        return MATERIALS[material["name"]].cutting[0]
    if "Ktc" in material:
        return 1e6 * float(material["Ktc"].split()[0])
    return 3e6 * float(material["shear_stress"].split()[0])
