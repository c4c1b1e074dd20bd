"""FRFs from the text files of CutPro: words after the numbers, above or below them."""

import numpy as np
import pytest

from chatter.io.formats.format_list import read_frfs
from dynamics.frf.container import MeasurementError

# as written for the program: the words follow the numbers of the first line, separated by tabs
ROWS = ((0.0, 1.2e-8, 0.0), (1.0, 1.3e-8, -2e-10), (2.0, 1.4e-8, -4e-10))


def lines(first_words="", separator="\t", rows=ROWS):
    text = [separator.join(f"{number:.6e}" for number in row) + separator for row in rows]
    return "\n".join([text[0] + first_words, *text[1:]]) + "\n"


def write(folder, text):
    path = folder / "tip.frf"
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    "text",
    [
        lines("Freq\tHz\tReal\tm/N\tImag\tReal\t"),
        lines(separator="  ") + "Hz\nm/N\n",
        lines(separator=", ") + "\nFrequency Hz\nReal m/N Imag m/N\n",
        "CutPro measurement 12\nHz m/N m/N\n" + lines(),
        lines("Freq\tHz\tReal\tm/N").replace(".", ","),
        "3\n" + lines("Freq\tHz\tReal\tm/N"),
    ],
)
def test_words_name_the_unit_wherever_they_stand(tmp_path, text):
    (frf,) = read_frfs(write(tmp_path, text))
    np.testing.assert_allclose(frf.frequency, [0, 1, 2])
    np.testing.assert_allclose(frf.values, [a + 1j * b for _, a, b in ROWS])
    assert frf.quantity == "receptance"


@pytest.mark.parametrize(
    ("unit", "quantity", "factor"),
    [
        ("um/N", "receptance", 1e-6),
        ("(m/s^2)/N", "accelerance", 1.0),
        ("g/N", "accelerance", 9.80665),
    ],
)
def test_units_are_converted(tmp_path, unit, quantity, factor):
    (frf,) = read_frfs(write(tmp_path, lines(f"Freq\tHz\tReal\t{unit}\tImag")))
    assert frf.quantity == quantity
    np.testing.assert_allclose(frf.values, [factor * (a + 1j * b) for _, a, b in ROWS])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (lines("Freq\tHz\tReal\tImag"), "no word in the file names the unit"),
        (lines("Hz\tm/N\tg/N"), "several units: m/N, g/N"),
        (lines("m/N") + "3.0\t1e-8\n", "line 4 has 2 numbers"),
        (lines("m/N") + "1.0\t1e-8\t0\n", "line 4: frequency 1 after 2"),
        (lines("m/N") + "3.0\tnan\t0\n", "line 4.*not finite"),
        ("words m/N only\n", "0 lines"),
        ("1 2 3 4\n2 3 4 5\n", "line 1 has 4 numbers"),
    ],
)
def test_wrong_files_are_refused(tmp_path, text, said):
    with pytest.raises(MeasurementError, match=f"tip.frf.*{said}"):
        read_frfs(write(tmp_path, text))
