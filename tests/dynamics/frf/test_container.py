"""The FRF container: conversions of quantity, senses of sensors, windows, wrong content."""

import numpy as np
import pytest

from dynamics.frf.container import (
    Frf,
    MeasurementError,
    Point,
    on_common_lines,
    without_added_decay,
)

FREQUENCY = np.linspace(0.0, 1000.0, 201)


def oscillator(s, frequency=300.0, damping=0.02, mass=0.5):
    natural = 2 * np.pi * frequency
    return 1 / (mass * (s**2 + 2 * damping * natural * s + natural**2))


def receptance(**fields):
    return Frf(FREQUENCY, oscillator(2j * np.pi * FREQUENCY), **fields)


def test_accelerance_is_minus_omega_squared_times_receptance():
    omega = 2 * np.pi * FREQUENCY
    accelerance = receptance().as_quantity("accelerance")
    assert accelerance.quantity == "accelerance"
    np.testing.assert_allclose(accelerance.values, -(omega**2) * receptance().values, rtol=1e-14)


def test_mobility_is_i_omega_times_receptance():
    omega = 2 * np.pi * FREQUENCY
    mobility = receptance().as_quantity("mobility")
    np.testing.assert_allclose(mobility.values, 1j * omega * receptance().values, rtol=1e-14)


def test_static_receptance_is_the_compliance():
    # k = m omega_n^2
    assert receptance().values[0] == pytest.approx(1 / (0.5 * (2 * np.pi * 300.0) ** 2))


@pytest.mark.parametrize("through", ["mobility", "accelerance"])
def test_conversion_there_and_back_drops_only_the_line_at_zero(through):
    back = receptance(coherence=np.ones(FREQUENCY.size)).as_quantity(through).receptance()
    np.testing.assert_array_equal(back.frequency, FREQUENCY[1:])
    np.testing.assert_allclose(back.values, receptance().values[1:], rtol=1e-13)
    assert back.coherence.shape == back.frequency.shape


def test_windowed_function_converts_off_the_imaginary_axis():
    decay = 12.0
    s = decay + 2j * np.pi * FREQUENCY
    windowed = Frf(FREQUENCY, s**2 * oscillator(s), "accelerance", added_decay=decay)
    back = windowed.receptance()
    # s is nowhere zero: the line at 0 Hz stays
    np.testing.assert_allclose(back.values, oscillator(s), rtol=1e-13)
    assert back.added_decay == decay


def test_damping_is_freed_of_the_added_decay():
    natural, damping, added = 2 * np.pi * 250.0, 0.012, 35.0
    pole = -damping * natural + 1j * natural * np.sqrt(1 - damping**2) - added
    fitted_frequency, fitted_damping = abs(pole) / (2 * np.pi), -pole.real / abs(pole)
    assert fitted_damping > 2 * damping
    assert without_added_decay(fitted_frequency, fitted_damping, added) == pytest.approx(
        (250.0, 0.012), rel=1e-12
    )


def test_a_sensor_against_its_axis_turns_the_sign():
    turned = receptance(response=Point("1", "x", -1), reference=Point("1", "x", 1)).along_axes()
    np.testing.assert_array_equal(turned.values, -receptance().values)
    assert turned.response.sign == 1
    assert turned.is_drive_point


def test_band_keeps_its_ends():
    inside = receptance().band(100.0, 200.0)
    assert (inside.frequency[0], inside.frequency[-1]) == (100.0, 200.0)


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"frequency": [1.0, 2.0, 3.0], "values": [1.0, 2.0]}, "same length"),
        ({"frequency": [1.0], "values": [1.0]}, "at least 2"),
        ({"frequency": [1.0, 2.0], "values": [1.0, np.nan]}, "line 2"),
        ({"frequency": [1.0, np.inf], "values": [1.0, 1.0]}, "line 2"),
        ({"frequency": [2.0, 1.0], "values": [1.0, 1.0]}, "rise"),
        ({"frequency": [-1.0, 1.0], "values": [1.0, 1.0]}, "negative"),
        ({"frequency": [1.0, 2.0], "values": [1.0, 1.0], "quantity": "speed"}, "receptance"),
        ({"frequency": [1.0, 2.0], "values": [1.0, 1.0], "coherence": [1.0]}, "coherence"),
        ({"frequency": [1.0, 2.0], "values": [1.0, 1.0], "added_decay": -1.0}, "decay"),
    ],
)
def test_wrong_content_is_refused_with_the_source(fields, said):
    with pytest.raises(MeasurementError, match=f"tip.csv.*{said}"):
        Frf(**fields, source="tip.csv")


def test_functions_on_different_lines_meet_on_the_common_range():
    coarse = Frf(np.array([50.0, 150.0, 250.0]), np.array([1.0, 2.0, 3.0]))
    fine = Frf(np.array([100.0, 150.0, 200.0, 400.0]), np.array([0.5, 1.0, 1.5, 3.5]))
    axis, columns = on_common_lines([fine, coarse])
    np.testing.assert_array_equal(axis, [100.0, 150.0, 200.0])
    np.testing.assert_allclose(columns[:, 1], [1.5, 2.0, 2.5])


def test_different_windows_or_quantities_are_not_stacked():
    with pytest.raises(MeasurementError, match="exponential"):
        on_common_lines([receptance(), receptance(added_decay=3.0)])
    with pytest.raises(MeasurementError, match="quantities"):
        on_common_lines([receptance(), receptance(quantity="mobility")])
