"""Modal identification: known structures, real recordings, wrong input."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dynamics.frf.container import Frf, MeasurementError, Point
from dynamics.identification.fit import identify_modes
from dynamics.modal.modes import Mode, receptance_matrix
from tests.dynamics.frf.hammer import hammer_records as hammer
from tests.dynamics.identification import made_up_frfs as made_up
from tests.places import DATA

LINES = np.arange(1.0, 2001.0)
THREE = (Mode(310.0, 0.02, 0.8), Mode(905.0, 0.035, 0.35), Mode(1490.0, 0.012, 0.2))


def drive_point(modes, quantity="receptance", noise=0.0, frequency=LINES, seed=0):
    """FRF in x at the tool point, even noise relative to the peak of the accelerance."""
    receptance = receptance_matrix(modes, frequency)[:, 0, 0]
    accelerance = receptance * (2j * np.pi * frequency) ** 2
    rng = np.random.default_rng(seed)
    random = rng.standard_normal(frequency.size) + 1j * rng.standard_normal(frequency.size)
    accelerance = accelerance + noise * np.max(np.abs(accelerance)) * random / np.sqrt(2.0)
    return Frf(frequency, accelerance, "accelerance").as_quantity(quantity)


def assert_modes(found, expected, frequency=1e-8, damping=1e-6, mass=1e-6):
    assert len(found) == len(expected)
    for mode, true in zip(found, expected, strict=True):
        assert mode.frequency == pytest.approx(true.frequency, rel=frequency)
        assert mode.damping == pytest.approx(true.damping, rel=damping)
        assert mode.mass == pytest.approx(true.mass, rel=mass)


@pytest.mark.parametrize("quantity", ["receptance", "mobility", "accelerance"])
def test_noise_free_drive_point_is_recovered_in_any_quantity(quantity):
    fit = identify_modes([drive_point(THREE, quantity)])
    assert_modes(fit.modes, THREE)
    assert fit.no_mass_reason == ""
    assert not fit.warnings
    assert max(error.maximum for error in fit.errors) < 1e-9
    assert max(error.maximum_receptance for error in fit.mode_errors) < 1e-9


def test_synthesis_is_the_receptance_matrix_of_the_modes():
    fit = identify_modes([drive_point(THREE, "accelerance", noise=2e-3)])
    omega2 = (2.0 * np.pi * LINES) ** 2
    direct = -omega2 * receptance_matrix(fit.modes, LINES)[:, 0, 0]
    synthesis = fit.models[0].values_of_modes(LINES)
    inside = (fit.band.lowest <= LINES) & (fit.band.highest >= LINES)
    rest = np.abs(synthesis - direct)[inside]
    assert np.max(rest) < 5e-3 * np.max(np.abs(direct))  # nothing outside the band: no residual


def test_residual_terms_stand_for_modes_outside_the_band():
    beyond = (Mode(40.0, 0.03, 0.5), Mode(6000.0, 0.02, 0.05))
    full = drive_point((*THREE, *beyond)).band(150.0, 2000.0)
    fit = identify_modes([full])
    assert_modes(fit.modes, THREE, frequency=1e-6, damping=1e-5, mass=1e-5)
    assert fit.errors[0].maximum < 1e-6


def test_units_are_not_mixed_up():
    """A millimetre taken for a metre or a degree for a radian shows in the mass."""
    fit = identify_modes([drive_point(THREE)])
    scaled = replace(drive_point(THREE), values=1e3 * drive_point(THREE).values)
    other = identify_modes([scaled])
    for mode, wrong in zip(fit.modes, other.modes, strict=True):
        assert wrong.mass == pytest.approx(1e-3 * mode.mass, rel=1e-6)
        assert wrong.frequency == pytest.approx(mode.frequency, rel=1e-9)


def test_sensor_turned_round_is_noticed():
    turned = drive_point(THREE, "accelerance", noise=1e-3)
    turned = replace(turned, values=-turned.values)
    fit = identify_modes([turned])
    assert_modes(fit.modes, THREE, frequency=1e-3, damping=1e-2, mass=1e-2)
    assert any("turned round" in note for note in fit.notes)
    assert fit.errors[0].maximum < 0.01  # the synthesis keeps the sign of the measurement


def test_declared_sense_of_the_sensor_is_applied():
    frf = drive_point(THREE, "accelerance", noise=1e-3)
    end, start = Point("1", "x", -1), Point("1", "x", 1)
    declared = replace(frf, values=-frf.values, response=end, reference=start)
    fit = identify_modes([declared])
    assert_modes(fit.modes, THREE, frequency=1e-3, damping=1e-2, mass=1e-2)
    assert not fit.notes
    assert fit.errors[0].maximum < 0.01


def test_delay_between_channels_is_taken_off():
    delay = 20e-6
    frf = drive_point(THREE, "accelerance", noise=1e-3)
    late = replace(frf, values=frf.values * np.exp(-2j * np.pi * LINES * delay))
    fit = identify_modes([late])
    assert_modes(fit.modes, THREE, frequency=1e-3, damping=1e-2, mass=1e-2)
    assert fit.models[0].delay == pytest.approx(delay, rel=0.02)
    assert any("lags" in note for note in fit.notes)


def test_exponential_window_is_corrected_for():
    """A window exp(-a t) moves the argument of the function from i omega to a + i omega."""
    decay = 15.0
    s = decay + 2j * np.pi * LINES
    values = sum(
        s**2 / m.mass / (s**2 + 2 * m.damping * m.natural_frequency * s + m.natural_frequency**2)
        for m in THREE
    )
    frf = Frf(LINES, values, "accelerance")
    object.__setattr__(frf, "added_decay", decay)
    fit = identify_modes([frf])
    assert_modes(fit.modes, THREE, frequency=1e-6, damping=1e-5, mass=1e-5)
    plain = identify_modes([Frf(LINES, values, "accelerance")])
    assert plain.identified[0].damping > 1.2 * THREE[0].damping  # what is left uncorrected


def test_transfer_function_has_no_mass():
    frf = drive_point(THREE, "accelerance")
    far = replace(frf, response=Point("2", "x"), reference=Point("1", "x"))
    fit = identify_modes([far])
    assert fit.modes == ()
    assert "no drive point" in fit.no_mass_reason
    assert [m.frequency for m in fit.identified] == pytest.approx([m.frequency for m in THREE])
    residues = [m.residues[0] for m in fit.identified]
    assert np.real(residues) == pytest.approx([1.0 / m.mass for m in THREE], rel=1e-6)


def test_function_with_residues_of_both_signs_is_refused_as_drive_point():
    first, second, third = THREE
    values = drive_point((first, third)).values - drive_point((second,)).values
    fit = identify_modes([Frf(LINES, values, source="tap.uff")])
    assert fit.modes == ()
    assert "not a drive point" in fit.no_mass_reason
    assert fit.errors[0].maximum < 1e-6


def matrix_frfs(modes, pairs, noise=0.0, seed=0):
    rng = np.random.default_rng(seed)
    h = receptance_matrix(modes, LINES) * ((2j * np.pi * LINES) ** 2)[:, None, None]
    level = noise * np.max(np.abs(h)) / np.sqrt(2.0)
    frfs = []
    for a, b in pairs:
        values = h[:, "xyz".index(a), "xyz".index(b)]
        random = rng.standard_normal(LINES.size) + 1j * rng.standard_normal(LINES.size)
        ends = Point("tip", a), Point("tip", b)
        frfs.append(Frf(LINES, values + level * random, "accelerance", *ends))
    return frfs


def test_directions_come_from_cross_terms():
    modes = (
        Mode(400.0, 0.03, 0.7, (np.cos(0.3), np.sin(0.3), 0.0)),
        Mode(430.0, 0.025, 1.1, (-np.sin(0.3), np.cos(0.3), 0.0)),
        Mode(1200.0, 0.02, 0.3, (0.8, -0.6, 0.0)),
    )
    fit = identify_modes(matrix_frfs(modes, ("xx", "xy", "yx", "yy"), noise=1e-3))
    assert_modes(fit.modes, modes, frequency=1e-3, damping=1e-2, mass=1e-2)
    for found, true in zip(fit.modes, modes, strict=True):
        assert abs(np.dot(found.direction, true.direction)) == pytest.approx(1.0, abs=1e-3)
        assert np.linalg.norm(found.direction) == pytest.approx(1.0)


def test_two_modes_at_one_frequency_are_told_apart_by_direction():
    modes = (Mode(600.0, 0.02, 0.5, (1.0, 0.0, 0.0)), Mode(600.0, 0.03, 0.9, (0.0, 1.0, 0.0)))
    fit = identify_modes(matrix_frfs(modes, ("xx", "xy", "yy"), noise=1e-3))
    assert len(fit.modes) == 2
    by_axis = sorted(fit.modes, key=lambda mode: -abs(mode.direction[0]))
    for found, true in zip(by_axis, modes, strict=True):
        assert found.frequency == pytest.approx(true.frequency, rel=1e-3)
        assert found.damping == pytest.approx(true.damping, rel=0.02)
        assert found.mass == pytest.approx(true.mass, rel=0.02)


def test_directions_without_cross_terms_have_modes_of_their_own():
    modes = (Mode(600.0, 0.02, 0.5), Mode(612.0, 0.02, 0.9, (0.0, 1.0, 0.0)))
    fit = identify_modes(matrix_frfs(modes, ("xx", "yy"), noise=1e-3))
    assert [mode.direction for mode in fit.modes] == [mode.direction for mode in modes]
    assert_modes(fit.modes, modes, frequency=1e-3, damping=1e-2, mass=1e-2)
    assert len(fit.diagrams) == 2


def test_number_of_modes_and_band_can_be_given():
    frf = drive_point(THREE, "accelerance", noise=1e-3)
    two = identify_modes([frf], mode_count=2)
    assert len(two.identified) == 2
    part = identify_modes([frf], band=(700.0, 1100.0))
    assert (part.band.lowest, part.band.highest) == (700.0, 1100.0)
    assert_modes(part.modes, THREE[1:2], frequency=1e-3, damping=1e-2, mass=2e-2)


def test_standard_deviations_tell_the_scatter():
    """Over many noises the errors over their reported deviations have unit variance."""
    ratios = []
    lines = np.arange(4.0, 2001.0, 4.0)
    for seed in range(15):
        frf = drive_point(THREE, "accelerance", noise=5e-3, frequency=lines, seed=seed)
        fit = identify_modes([frf])
        for found, true in zip(fit.identified, THREE, strict=True):
            ratios += [
                (found.frequency - true.frequency) / found.frequency_std,
                (found.damping - true.damping) / found.damping_std,
                (found.mass - true.mass) / found.mass_std,
            ]
    assert 0.75 < np.sqrt(np.mean(np.square(ratios))) < 1.35


def test_mode_buried_in_noise_gets_a_warning_or_is_not_reported():
    weak = Mode(1200.0, 0.004, 60.0)
    fit = identify_modes([drive_point((*THREE, weak), "accelerance", noise=5e-3)])
    near = [m for m in fit.identified if abs(m.frequency - weak.frequency) < 20.0]
    assert all(mode.warning for mode in near)
    assert not [m for m in fit.identified if m not in near and m.warning]


def test_low_end_full_of_noise_is_left_out_of_the_band():
    frf = drive_point(THREE, "receptance", noise=2e-3)
    fit = identify_modes([frf])
    peak = np.max(np.abs(drive_point(THREE).values))
    low = frf.frequency < 20.0
    assert np.max(np.abs(frf.values[low])) > peak  # noise over omega squared towers above all
    assert 20.0 < fit.band.lowest < 300.0
    assert "noise" in fit.band.reason or "receptance" in fit.band.reason
    assert_modes(fit.modes, THREE, frequency=1e-3, damping=1e-2, mass=1e-2)


@pytest.mark.parametrize("kind", list(made_up.KINDS))
def test_made_up_structures(kind):
    """A seeded part of benchmarks/modal_identification.py."""
    attainable = accurate = false = 0
    for seed in (501, 502):
        case = made_up.made_up_case(kind, seed)
        score = made_up.score(case, identify_modes(case.frfs))
        attainable += score.attainable
        accurate += score.accurate
        false += score.false
    assert attainable > 0
    assert accurate >= 0.95 * attainable
    assert false == 0


BEAM_FREQUENCIES = (52.0, 142.0, 279.0, 460.0, 687.0, 959.0)  # from the README of the data


def beam_frfs():
    frfs = []
    for i in (1, 2, 3):
        table = np.loadtxt(DATA / "frf-beam" / f"point_{i}.csv", delimiter=",", skiprows=1)
        ends = Point("1", "z"), Point(str(i), "z")
        frfs.append(Frf(table[:, 0], table[:, 1] + 1j * table[:, 2], "accelerance", *ends))
    return frfs


def test_beam_has_six_modes_and_is_described_within_five_percent_of_the_peak():
    fit = identify_modes(beam_frfs())
    found = [mode.frequency for mode in fit.identified]
    assert found == pytest.approx(BEAM_FREQUENCIES, rel=0.01)
    assert all(error.maximum < 0.05 for error in fit.errors)
    assert all(error.maximum_receptance < 0.05 for error in fit.errors)
    # free-free beam of Euler and Bernoulli: (beta L)^2 of the first six bending modes
    ratios = np.array([4.7300, 7.8532, 10.9956, 14.1372, 17.2788, 20.4204]) ** 2
    assert np.array(found) / found[0] == pytest.approx(ratios / ratios[0], rel=0.01)


@pytest.mark.parametrize("index", [0, 1, 2])
def test_single_function_of_the_beam(index):
    fit = identify_modes([beam_frfs()[index]])
    strong = [mode.frequency for mode in fit.identified if mode.weight > 0.02]
    assert strong == pytest.approx(BEAM_FREQUENCIES, rel=0.01)
    assert fit.worst_error < 0.05


def h1_of(records) -> Frf:
    blows = [np.fft.rfft(record.force) for record in records]
    answers = [np.fft.rfft(record.response) for record in records]
    cross = sum(f.conj() * a for f, a in zip(blows, answers, strict=True))
    power = sum(np.abs(f) ** 2 for f in blows)
    step = 1.0 / records[0].sampling_rate
    return Frf(np.fft.rfftfreq(records[0].force.size, step), cross / power, "accelerance")


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_hammer_average_separates_close_modes(seed):
    rng = np.random.default_rng(seed)
    hits = [hammer.random_hit(rng) for _ in range(6)]
    noise = hammer.Noise()
    frf = h1_of([hammer.record_of(rng, hammer.CLOSE, [hit], noise, "tap") for hit in hits])
    fit = identify_modes([frf])
    assert len(fit.modes) == len(hammer.CLOSE.modes)
    for found, (frequency, damping, mass) in zip(fit.modes, hammer.CLOSE.modes, strict=True):
        assert found.frequency == pytest.approx(frequency, rel=2e-3)
        assert found.damping == pytest.approx(damping, rel=5e-2)
        assert found.mass == pytest.approx(mass, rel=5e-2)
    assert not fit.warnings
    assert fit.worst_error < 0.05


@pytest.mark.parametrize(
    ("frfs", "options", "said"),
    [
        ([], {}, "no FRF"),
        ([drive_point(THREE).band(1.0, 15.0)], {}, "at least 16"),
        ([Frf(LINES, np.zeros(LINES.size))], {}, "zero on every line"),
        ([drive_point(THREE)], {"band": (5000.0, 6000.0)}, "holds 0 lines"),
        ([drive_point(THREE)], {"mode_count": 0}, "at least 1"),
        ([drive_point(THREE)], {"max_order": 2}, "at least 4"),
        ([Frf(LINES, np.full(LINES.size, 1e-7 + 0j))], {}, "no mode found"),
        ([Frf(LINES, drive_point(THREE).values.conj())], {}, "negative damping"),
    ],
)
def test_wrong_input_is_named(frfs, options, said):
    with pytest.raises(MeasurementError, match=said):
        identify_modes(frfs, **options)


def test_noise_alone_has_no_modes():
    rng = np.random.default_rng(3)
    noise = rng.standard_normal(1000) + 1j * rng.standard_normal(1000)
    with pytest.raises(MeasurementError, match="no mode found"):
        identify_modes([Frf(np.arange(1.0, 1001.0), noise)])
