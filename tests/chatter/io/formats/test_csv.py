"""FRFs from tables: layouts, separators, several functions, and every way to be wrong."""

import numpy as np
import pytest

from chatter.io.formats.format_list import read_frfs
from dynamics.frf.container import MeasurementError
from tests.places import DATA


def write(folder, text, name="frf.csv", encoding="utf-8"):
    path = folder / name
    path.write_bytes(text.encode(encoding))
    return path


def only(path):
    (frf,) = read_frfs(path)
    return frf


def test_reads_the_recordings_of_the_beam():
    frf = only(DATA / "frf-beam/point_1.csv")
    assert frf.quantity == "accelerance"
    assert frf.frequency[-1] == 1000.0
    assert frf.values[1] == pytest.approx(-1.751511549e-01 - 1.204237207e-01j, rel=1e-12)


@pytest.mark.parametrize(
    "text",
    [
        "frequency [Hz],real [um/N],imag [um/N]\n10,1,-2\n20.5,3,-4e0\n",
        "frequency [Hz];real [um/N];imag [um/N]\n10;1;-2\n20,5;3;-4,0\n",
        "Freq [Hz]\tRe [um/N]\tIm [um/N]\n10\t1\t-2\n20.5\t3\t-4\n",
        "frequency [Hz] real [um/N] imag [um/N]\n10 1 -2\n20.5 3 -4\n",
        "# made by hand\n\nFrequency (Hz),Real (um/N),Imag (um/N)\n10,1,-2\n# note\n20.5,3,-4\n",
        "# frequency [Hz],real [um/N],imag [um/N]\n10,1,-2\n20.5,3,-4\n",
        "% frequency [Hz] real [um/N] imag [um/N]\n10 1 -2\n20.5 3 -4\n",
        '"frequency [kHz]","real [nm/N]","imag [mm/N]"\r\n.010,1000,-.002\r\n.0205,3e3,-.004\r\n',
        "frequency,real,imag\nHz,um/N,um/N\n10,1,-2\n20.5,3,-4\n",
        "frequency [Hz],real [µm/N],imag [µm/N],\n10,1,-2,\n20.5,3,-4,\n",
        "frequency [Hz] real [um/N] imag [um/N]\n10,0 1,0 -2,0\n20,5 3,0 -4,0\n",
    ],
)
def test_layouts_that_mean_the_same(tmp_path, text):
    frf = only(write(tmp_path, text))
    np.testing.assert_allclose(frf.frequency, [10.0, 20.5])
    np.testing.assert_allclose(frf.values, [1e-6 - 2e-6j, 3e-6 - 4e-6j])
    assert frf.quantity == "receptance"
    assert "frf.csv" in frf.source


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252", "utf-16"])
def test_encodings(tmp_path, encoding):
    text = "frequency [Hz],real [µm/N],imag [µm/N]\n10,1,2\n20,3,4\n"
    assert only(write(tmp_path, text, encoding=encoding)).values[0] == pytest.approx(1e-6 + 2e-6j)


@pytest.mark.parametrize(("unit", "angle"), [("deg", 90.0), ("rad", np.pi / 2)])
def test_magnitude_and_phase(tmp_path, unit, angle):
    text = f"frequency [Hz],magnitude [g/N],phase [{unit}]\n10,2,{angle}\n20,2,{-angle}\n"
    frf = only(write(tmp_path, text))
    np.testing.assert_allclose(frf.values, [2j * 9.80665, -2j * 9.80665], atol=1e-12)
    assert frf.quantity == "accelerance"


def test_several_functions_with_directions_and_coherence(tmp_path):
    text = (
        "frequency [Hz],real xx [m/N],imag xx [m/N],coherence xx,"
        "Hyx real [m/s/N],Hyx imag [m/s/N],coherence Hyx [%]\n"
        "1,1,2,0.9,3,4,80\n2,5,6,1.0,7,8,90\n"
    )
    xx, yx = read_frfs(write(tmp_path, text))
    assert (xx.response.direction, xx.reference.direction) == ("x", "x")
    assert (yx.response.direction, yx.reference.direction) == ("y", "x")  # response first
    assert (xx.quantity, yx.quantity) == ("receptance", "mobility")
    np.testing.assert_array_equal(yx.values, [3 + 4j, 7 + 8j])
    np.testing.assert_allclose(yx.coherence, [0.8, 0.9])


HEAD = "frequency [Hz],real [m/N],imag [m/N]\n"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("1,2,3\n2,3,4\n", "heading"),
        ("frequency,real,imag\n1,2,3\n2,3,4\n", "frequency .Hz.,real"),
        ("just some words\nand more\n", "text only"),
        ("   \n\n", "no text"),
        (HEAD, "no line of numbers"),
        (HEAD + "1,2,3\n", "at least 2"),
        (HEAD + "1,2,3\n2,nan,4\n", "line 3.*'nan'.*finite"),
        (HEAD + "1,2,3\n2,inf,4\n", "line 3"),
        (HEAD + "1,2,3\n2,4\n", "line 3 has 2 columns"),
        (HEAD + "1,2,3\n2,,4\n", "line 3.*not a number"),
        (HEAD + "1,2,3\n2,x,4\n", "line 3, real: 'x' is not a number"),
        (HEAD + "2,2,3\n1,3,4\n", "line 3.*must rise"),
        (HEAD + "1,2,3\n1,3,4\n", "must rise"),
        ("frequency [Hz],real [N/m],imag [N/m]\n1,2,3\n2,3,4\n", "'real'.*N/m"),
        ("frequency [Hz],real [m/N],imag [g/N]\n1,2,3\n2,3,4\n", "different quantities"),
        ("frequency [Hz],real [m/N],phase [deg]\n1,2,3\n2,3,4\n", "make no FRF"),
        ("frequency [Hz],real [m/N],real [m/N]\n1,2,3\n2,3,4\n", "two columns"),
        ("frequency [Hz],magnitude [dB],phase [deg]\n1,2,3\n2,3,4\n", "decibels"),
        ("frequency [Hz],magnitude [m/N],phase [s]\n1,2,3\n2,3,4\n", "deg and rad"),
        ("frequency [Hz],real [m/N],imag [m/N],coherence\n1,2,3,0.5\n2,3,4,1.5\n", "line 3.*1.5"),
        ("frequency [Hz],real [m/N],imag [m/N],depth [mm]\n1,2,3,4\n2,3,4,5\n", "'depth'"),
        ("force [N],real [m/N],imag [m/N]\n1,2,3\n2,3,4\n", "must be a frequency"),
        ("time [s],force [N],acceleration [m/s^2]\n0,2,3\n1,3,4\n", "time record"),
    ],
)
def test_wrong_tables_are_refused(tmp_path, text, said):
    with pytest.raises(MeasurementError, match=f"(?s)frf.csv.*{said}"):
        read_frfs(write(tmp_path, text))


def test_things_that_are_no_file(tmp_path):
    with pytest.raises(MeasurementError, match="no such file"):
        read_frfs(tmp_path / "none.csv")
    with pytest.raises(MeasurementError, match="is a folder"):
        read_frfs(tmp_path)
    (tmp_path / "empty.csv").touch()
    with pytest.raises(MeasurementError, match="empty"):
        read_frfs(tmp_path / "empty.csv")


@pytest.mark.parametrize("name", ["junk.csv", "junk.frf", "junk.uff", "junk.txt", "junk"])
def test_binary_junk(tmp_path, name):
    path = tmp_path / name
    path.write_bytes(np.random.default_rng(0).bytes(5000))
    with pytest.raises(MeasurementError, match=name):
        read_frfs(path)


def test_an_unknown_suffix_lists_the_known(tmp_path):
    with pytest.raises(MeasurementError, match=r"\.md.*\.uff.*\.frf.*\.csv"):
        read_frfs(write(tmp_path, "words\n", name="notes.md"))


def test_a_file_too_large_is_not_read(tmp_path, monkeypatch):
    monkeypatch.setattr("chatter.io.files.LARGEST_FILE", 10)
    with pytest.raises(MeasurementError, match="MB"):
        read_frfs(write(tmp_path, HEAD + "1,2,3\n2,3,4\n"))
