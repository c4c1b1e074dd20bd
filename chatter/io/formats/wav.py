"""WAV files: the sound, or what else a recorder takes."""

import io
import struct
import warnings
from pathlib import Path

import numpy as np

from chatter.io.files import read_content
from chatter.io.formats.format import Format
from chatter.io.formats.named_arrays import require_size
from chatter.io.sensitivities import FULL_SCALE
from chatter.io.table import Column, Table, table_of
from dynamics.frf.container import MeasurementError


def read_sound(path: Path) -> Table:
    """Time and channels of a WAV file, whole numbers as a share of full scale.

    MeasurementError if the file is none that is read.
    """
    import scipy.io.wavfile

    try:
        with warnings.catch_warnings():
            # of chunks that are no sound, and of a length that a recorder has not written yet
            warnings.simplefilter("ignore", scipy.io.wavfile.WavFileWarning)
            rate, values = scipy.io.wavfile.read(io.BytesIO(_with_true_sizes(read_content(path))))
    except Exception as error:  # whatever the library raises on a broken file
        raise MeasurementError(f"{path}: is no WAV file that can be read: {error}") from error
    if rate <= 0 or values.size == 0:
        raise MeasurementError(f"{path}: the WAV file holds no samples")
    require_size(path, 8.0 * values.size)
    values = full_scale(values.reshape(len(values), -1))
    columns = [Column("time [s]", np.arange(len(values)) / rate)]
    columns += [Column(f"sound {k + 1}", values[:, k]) for k in range(values.shape[1])]
    return table_of(path, columns, "channels")


def _with_true_sizes(content: bytes) -> bytes:
    """Content whose header says how long it is: recorders that were cut off, and pipes, do not."""
    place = 12
    while place + 8 <= len(content):
        name, size = struct.unpack_from("<4sI", content, place)
        rest = len(content) - place - 8
        if name == b"data" and content.startswith(b"RIFF") and (size == 0 or size > rest):
            sizes = struct.pack("<4sI", b"RIFF", len(content) - 8), struct.pack("<I", rest)
            return sizes[0] + content[8 : place + 4] + sizes[1] + content[place + 8 :]
        if name == b"data":
            break
        place += 8 + size + size % 2
    return content


def full_scale(values: np.ndarray) -> np.ndarray:
    """Samples as a share of full scale; eight-bit ones have their zero in the middle."""
    if values.dtype == np.uint8:
        return (values.astype(np.float64) - 128.0) / 128.0
    if np.issubdtype(values.dtype, np.integer):
        return values.astype(np.float64) / -float(np.iinfo(values.dtype).min)
    return values.astype(np.float64)


WAV = Format(
    name="wav",
    label="sound in WAV",
    help="channels as a share of full scale, PCM or floating point",
    extensions=(".wav", ".wave"),
    read_signals=read_sound,
    own_unit=FULL_SCALE,
    recognises=lambda head: head[:4] in (b"RIFF", b"RIFX", b"RF64") and head[8:12] == b"WAVE",
)
