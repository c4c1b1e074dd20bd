"""WAV files: the sound, or what else a recorder takes."""

import warnings
from pathlib import Path

import numpy as np

from chatter.io.formats.format import Format
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
            rate, values = scipy.io.wavfile.read(path)
    except Exception as error:  # whatever the library raises on a broken file
        raise MeasurementError(f"{path}: is no WAV file that can be read: {error}") from error
    if rate <= 0 or values.size == 0:
        raise MeasurementError(f"{path}: the WAV file holds no samples")
    values = full_scale(values.reshape(len(values), -1))
    columns = [Column("time [s]", np.arange(len(values)) / rate)]
    columns += [Column(f"sound {k + 1}", values[:, k]) for k in range(values.shape[1])]
    return table_of(path, columns, "channels")


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
    recognises=lambda head: head[:4] in (b"RIFF", b"RIFX", b"RF64") and head[8:12] == b"WAVE",
)
