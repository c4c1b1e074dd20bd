"""Modal identification of measured FRFs, from band to real modes, with no hand tuning."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dynamics.frf.container import Frf, MeasurementError
from dynamics.identification.band import Band, widened
from dynamics.identification.beyond_band import modes_beyond
from dynamics.identification.condensed import SearchRecords
from dynamics.identification.delay import channel_delay, without_delay
from dynamics.identification.mode_quality import LEAST_MISFIT
from dynamics.identification.polynomial import polyreference_poles
from dynamics.identification.prepare import (
    FrfSet,
    Measurement,
    prepare,
    response_reference_matrix,
    sets_with_common_poles,
    tool_point_records,
)
from dynamics.identification.refinement import ModalModel, fit_residues, refine, refine_poles
from dynamics.identification.report import (
    complex_frf_model,
    identified_complex_modes,
    identified_real_modes,
    mode_of,
    real_frf_model,
)
from dynamics.identification.residues import ALL_TERMS, CURVATURE_TERMS, Records
from dynamics.identification.result import (
    BeyondBand,
    FrfModel,
    IdentifiedMode,
    ModalFit,
    SynthesisError,
    synthesis_error,
)
from dynamics.identification.selection import add_missing, drop_unsupported, with_mode_count
from dynamics.identification.stabilisation import (
    FREQUENCY_TOLERANCE,
    StabilisationDiagram,
    stabilisation_diagram,
    stable_poles,
)
from dynamics.identification.tool_point import ToolPointFit, fit_tool_point
from dynamics.least_squares import PRECISE, ROUGH

#: largest order of the pLSCF model unless there are few lines
HIGHEST_ORDER = 80

#: delay between force and response that is mentioned, as phase at the highest mode, rad
NOTED_DELAY_PHASE = 0.01


@dataclass(frozen=True)
class _SetFit:
    """Everything found for one set of FRFs with common poles."""

    frf_set: FrfSet
    diagram: StabilisationDiagram
    complex_model: ModalModel
    tool: ToolPointFit | None
    records: Records  # without the delay
    delay: float  # of the response channels, found before the residues, s

    @property
    def real_delay(self) -> float:
        """Delay taken off the records of the real modes, s."""
        return self.delay + (self.tool.delay if self.tool is not None else 0.0)


def identify_modes(
    frfs: Sequence[Frf],
    *,
    band: tuple[float, float] | None = None,
    mode_count: int | None = None,
    max_order: int | None = None,
    tool_point: str | None = None,
    poles: Sequence[tuple[float, float]] | None = None,
) -> ModalFit:
    """Identify the modes of a structure from one or several measured FRFs.

    The usable band is found from the noise, poles of all model orders come from the
    poly-reference least-squares complex frequency-domain estimator (Peeters et al. 2004), those
    that stay put are kept as far as the data support them, missing ones are added where the
    residual has structure, and all are refined by weighted nonlinear least squares over all
    FRFs. Where FRFs of a drive point are among them, real modes with positive mass at the tool
    point follow, with direction where cross terms were measured.

    Parameters
    ----------
    frfs : sequence of Frf
        Any quantity. FRFs linked by a common degree of freedom are fitted with common poles.
        A single FRF without point information counts as a drive point.
    band : (float, float), optional
        Lowest and highest frequency to fit, Hz; found from the data where not given.
    mode_count : int, optional
        Number of modes of each set of FRFs with common poles; found from the data where not
        given.
    max_order : int, optional
        Largest order of the stabilisation diagram.
    tool_point : str, optional
        Node at which the modal masses are wanted; that of the first drive point where not given.
    poles : sequence of (float, float), optional
        Natural frequencies, Hz, and damping ratios of the modes, as picked in the stabilisation
        diagram: these are refined, none is added or dropped. A set of FRFs takes those that its
        own diagram has.

    Raises
    ------
    MeasurementError
        For input that cannot be used, or where no mode was found.
    """
    if mode_count is not None and mode_count < 1:
        raise MeasurementError(f"mode_count = {mode_count}; at least 1 mode is needed")
    for frequency, damping in poles or ():
        if not (frequency > 0.0 and 0.0 < damping < 1.0):
            raise MeasurementError(
                f"pole {frequency:g} Hz, damping {damping:g}: a frequency above 0 and a damping "
                "ratio between 0 and 1 are required"
            )
    if max_order is not None and max_order < 4:
        raise MeasurementError(f"max_order = {max_order}; at least 4 is needed")
    measurement = prepare(frfs, band)
    sets = sets_with_common_poles(measurement.frfs, tool_point)
    if poles is None:
        found = [_search(measurement, frf_set, mode_count, max_order) for frf_set in sets]
    else:
        found = [_from_poles(measurement, frf_set, poles, max_order) for frf_set in sets]
    in_hertz = [model.poles_in_hertz for _, model in found]
    fitted = widened(
        measurement.clean,
        measurement.searched,
        np.concatenate([frequency for frequency, _ in in_hertz]),
        np.concatenate([damping for _, damping in in_hertz]),
        float(np.median(np.diff(measurement.records.frequency))),
    )
    fewest = mode_count or len(poles or ())
    fits = [
        _fit_set(frf_set, diagram, model, measurement.of(frf_set.members, fitted), fewest)
        for frf_set, (diagram, model) in zip(sets, found, strict=True)
    ]
    result = _assemble(measurement, fitted, fits)
    if not result.identified:
        raise MeasurementError(_nothing_found(measurement, sets[0], max_order))
    if mode_count is not None and len(result.identified) != mode_count * len(sets):
        note = (
            f"{mode_count} modes were asked for; the data bear {len(result.identified)} in the "
            f"{len(sets)} set(s) of FRFs with common poles"
        )
        result = replace(result, notes=(*result.notes, note))
    return result


def delay_between_channels(frf: Frf) -> float:
    """Lag of the response behind the force in an FRF of a drive point, s; 0 where it shows none.

    From the stable poles of its own stabilisation diagram, which need no refinement for it.
    MeasurementError for input that cannot be used.
    """
    measurement = prepare([frf], None)
    frf_set = sets_with_common_poles(measurement.frfs, None)[0]
    records = measurement.of(frf_set.members, measurement.searched)
    frequency, damping = stable_poles(_diagram(records, measurement.frfs, None))
    model = fit_residues(records, 2.0 * np.pi * frequency, damping, ALL_TERMS)
    return channel_delay(records, model, np.array([True]))


def _nothing_found(measurement: Measurement, frf_set: FrfSet, max_order: int | None) -> str:
    """Say why there may be no mode: noise, or a spectrum of the other time convention."""
    source = measurement.frfs[0].source or "FRF"
    lowest, highest = measurement.searched.lowest, measurement.searched.highest
    records = measurement.of(frf_set.members, measurement.searched)
    frfs = [measurement.frfs[i] for i in frf_set.members]
    mirrored = _diagram(replace(records, values=records.values.conj()), frfs, max_order)
    said = f"{source}: no mode found between {lowest:g} and {highest:g} Hz"
    if stable_poles(mirrored)[0].size:
        said += (
            "; all resonances have negative damping, as when the imaginary part has the wrong "
            "sign (time convention exp(-i omega t))"
        )
    return said


def _search(
    measurement: Measurement, frf_set: FrfSet, mode_count: int | None, max_order: int | None
) -> tuple[StabilisationDiagram, ModalModel]:
    """Complex modes that the lines searched support."""
    records = measurement.of(frf_set.members, measurement.searched)
    frfs = [measurement.frfs[i] for i in frf_set.members]
    diagram = _diagram(records, frfs, max_order)
    frequency, damping = stable_poles(diagram)
    search = SearchRecords.of(records)
    start = refine_poles(search.fewer, 2.0 * np.pi * frequency, damping, ALL_TERMS)
    kept = drop_unsupported(search, start)
    model = add_missing(search, add_curvature(search, kept))
    if model is not kept:
        model = drop_unsupported(search, model)
    if mode_count is not None:
        model = with_mode_count(search, model, mode_count)
    return diagram, model


def _from_poles(
    measurement: Measurement,
    frf_set: FrfSet,
    poles: Sequence[tuple[float, float]],
    max_order: int | None,
) -> tuple[StabilisationDiagram, ModalModel]:
    """Complex modes at the poles given, as far as the diagram of the set has them."""
    records = measurement.of(frf_set.members, measurement.searched)
    diagram = _diagram(records, [measurement.frfs[i] for i in frf_set.members], max_order)
    chosen = [pole for pole in sorted(poles) if _has_pole(diagram, *pole)]
    frequency, damping = np.array(chosen, dtype=np.float64).reshape(-1, 2).T
    search = SearchRecords.of(records)
    start = refine_poles(search.fewer, 2.0 * np.pi * frequency, damping, ALL_TERMS)
    return diagram, add_curvature(search, start)


def _has_pole(diagram: StabilisationDiagram, frequency: float, damping: float) -> bool:
    """Whether any order has a pole within the bandwidth of one given."""
    reach = max(damping, FREQUENCY_TOLERANCE) * frequency
    return bool(np.any(np.abs(diagram.frequency - frequency) <= reach))


def _fit_set(
    frf_set: FrfSet, diagram: StabilisationDiagram, model: ModalModel, records: Records, fewest: int
) -> _SetFit:
    """Refine the complex modes on the lines of the band, then real ones."""
    drives = np.array([pair is not None and pair[0] == pair[1] for pair in frf_set.pairs])
    delay = channel_delay(records, model, drives)
    records = without_delay(records, delay)
    search = SearchRecords.of(records)
    model = refine_poles(search.fewer, model.natural_frequency, model.damping, model.terms)
    model = choose_terms(search, model)
    if search.fewer is not records:
        model = refine(records, model)
    tool = None
    if not frf_set.reason and model.count:
        tool = fit_tool_point(tool_point_records(records, frf_set), model, fewest)
    return _SetFit(frf_set, diagram, model, tool, records, delay)


def _diagram(records: Records, frfs: Sequence[Frf], max_order: int | None) -> StabilisationDiagram:
    """Poles of all orders."""
    matrix = response_reference_matrix(records, frfs)
    relative = records.noise / np.median(records.noise, axis=0)
    weight = 1.0 / np.sqrt(np.mean(relative**2, axis=1))
    references = matrix.shape[2]
    highest = max_order or HIGHEST_ORDER // references
    highest = max(6, min(highest, records.frequency.size // 3))
    orders = polyreference_poles(records.frequency, matrix, weight, range(4, highest + 1, 2))
    if records.added_decay:
        orders = [replace(o, poles=o.poles + records.added_decay) for o in orders]
    return stabilisation_diagram(orders, records.frequency[0], records.frequency[-1])


def _assemble(measurement: Measurement, band: Band, fits: Sequence[_SetFit]) -> ModalFit:
    """Put the sets together in the order of the FRFs given."""
    count = len(measurement.frfs)
    models: list[FrfModel | None] = [None] * count
    complex_models: list[FrfModel | None] = [None] * count
    identified: list[IdentifiedMode] = []
    notes: list[str] = []
    reasons: list[str] = []
    beyond: list[BeyondBand] = []
    for fit in fits:
        senses = measurement.senses[list(fit.frf_set.members)]
        for k, i in enumerate(fit.frf_set.members):
            complex_models[i] = models[i] = complex_frf_model(
                fit.records, fit.complex_model, k, senses[k], fit.delay
            )
        found = identified_complex_modes(fit.records, fit.complex_model)
        if fit.tool is not None:
            notes += fit.tool.notes
        if fit.tool is not None and fit.tool.model is not None:
            for k, i in enumerate(fit.frf_set.members):
                models[i] = real_frf_model(
                    fit.tool.tool, fit.tool.model, k, senses[k] * fit.tool.senses[k], fit.real_delay
                )
            found = identified_real_modes(fit.tool.tool, fit.tool.model)
            beyond.append(modes_beyond(fit.tool.tool, fit.tool.model))
        else:
            reasons.append(fit.frf_set.reason if fit.tool is None else fit.tool.reason)
        notes += _delay_note(fit)
        identified += [_spread(mode, fit.frf_set, senses, count) for mode in found]
    identified.sort(key=lambda mode: mode.frequency)
    modes = tuple(mode_of(mode) for mode in identified if mode.mass is not None)
    ready = [model for model in models if model is not None]
    ready_complex = [model for model in complex_models if model is not None]
    inside = [f.band(band.lowest, band.highest) for f in measurement.frfs]
    lines = measurement.records.frequency
    noise = [
        np.interp(f.frequency, lines, column)
        for f, column in zip(inside, measurement.records.noise.T, strict=True)
    ]
    return ModalFit(
        frfs=measurement.frfs,
        band=band,
        identified=tuple(identified),
        modes=modes,
        no_mass_reason="" if modes else "; ".join(dict.fromkeys(reasons)),
        models=tuple(ready),
        complex_models=tuple(ready_complex),
        errors=_errors(inside, ready, noise, FrfModel.values),
        complex_errors=_errors(inside, ready_complex, noise, FrfModel.values),
        mode_errors=_errors(inside, ready, noise, FrfModel.values_of_modes),
        diagrams=tuple(fit.diagram for fit in fits),
        notes=tuple(dict.fromkeys(notes)),
        beyond=BeyondBand(
            tuple(mode for one in beyond for mode in one.modes),
            max((one.misfit for one in beyond), default=0.0),
        ),
    )


def _errors(
    frfs: Sequence[Frf],
    models: Sequence[FrfModel],
    noise: Sequence[NDArray[np.float64]],
    values: Callable[[FrfModel, NDArray[np.float64]], NDArray[np.complex128]],
) -> tuple[SynthesisError, ...]:
    return tuple(
        synthesis_error(frf, values(model, frf.frequency), level)
        for frf, model, level in zip(frfs, models, noise, strict=True)
    )


def _spread(
    mode: IdentifiedMode, frf_set: FrfSet, senses: NDArray[np.float64], count: int
) -> IdentifiedMode:
    """Place the residues of a set at the positions of its FRFs among all."""
    residues = np.full(count, np.nan + 0j)
    residues[list(frf_set.members)] = mode.residues * senses
    return replace(mode, residues=residues)


def _delay_note(fit: _SetFit) -> list[str]:
    """Say what lag was taken off, where its phase at the highest mode matters."""
    delay, highest = fit.real_delay, float(np.max(fit.complex_model.natural_frequency, initial=0.0))
    if fit.tool is not None and fit.tool.model is not None:
        delay += fit.tool.model.delay or 0.0
        highest = float(np.max(fit.tool.model.natural_frequency))
    if abs(delay) * highest < NOTED_DELAY_PHASE:
        return []
    return [f"the response lags the force by {delay * 1e6:.2f} us; this was taken off the modes"]


def add_curvature(records: SearchRecords, model: ModalModel) -> ModalModel:
    """Add the next residual terms of the modes beyond the lines where the data support them."""
    for power in CURVATURE_TERMS:
        grown = _with_terms(records.fewer, model, (*model.terms, power), ROUGH)
        if _supports(records.lines, grown, model):
            model = refine(records.fewer, grown)
    return model


def choose_terms(records: SearchRecords, model: ModalModel) -> ModalModel:
    """Leave out the residual terms that the data do not support (Schwarz 1978)."""
    for power in model.terms:
        terms = tuple(p for p in model.terms if p != power)
        lesser = _with_terms(records.fewer, model, terms, PRECISE)
        if not _supports(records.lines, model, lesser):
            model = lesser
    return model


def _supports(records: Records, larger: ModalModel, smaller: ModalModel) -> bool:
    """True where one more residual term an FRF is worth its unknowns."""
    misfit = max(larger.chi_square / (2.0 * records.values.size), LEAST_MISFIT)
    price = records.count * np.log(2.0 * records.values.size)
    return bool((smaller.chi_square - larger.chi_square) / misfit > price)


def _with_terms(
    records: Records, model: ModalModel, terms: tuple[int, ...], least_gain: float
) -> ModalModel:
    return refine_poles(records, model.natural_frequency, model.damping, terms, least_gain)
