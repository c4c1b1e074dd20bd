"""Which residual terms the data support."""

from __future__ import annotations

import numpy as np

from dynamics.identification.mode_quality import LEAST_MISFIT
from dynamics.identification.refinement import ModalModel, fit_residues, refine
from dynamics.identification.residues import CURVATURE_TERMS, Records
from dynamics.least_squares import ROUGH


def add_curvature(records: Records, model: ModalModel) -> ModalModel:
    """Add the next residual terms of the modes beyond the lines where the data support them."""
    for power in CURVATURE_TERMS:
        grown = refine(records, _with_terms(records, model, (*model.terms, power)), ROUGH)
        if _supports(records, grown, model):
            model = refine(records, grown)
    return model


def choose_terms(records: Records, model: ModalModel) -> ModalModel:
    """Leave out the residual terms that the data do not support (Schwarz 1978)."""
    for power in model.terms:
        terms = tuple(p for p in model.terms if p != power)
        lesser = refine(records, _with_terms(records, model, terms))
        if not _supports(records, model, lesser):
            model = lesser
    return model


def _supports(records: Records, larger: ModalModel, smaller: ModalModel) -> bool:
    """True where one more residual term an FRF is worth its unknowns."""
    misfit = max(larger.chi_square / (2.0 * records.values.size), LEAST_MISFIT)
    price = records.count * np.log(2.0 * records.values.size)
    return bool((smaller.chi_square - larger.chi_square) / misfit > price)


def _with_terms(records: Records, model: ModalModel, terms: tuple[int, ...]) -> ModalModel:
    return fit_residues(records, model.natural_frequency, model.damping, terms)
