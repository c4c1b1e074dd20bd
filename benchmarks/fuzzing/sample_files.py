"""A real file of every format that is read, as its programs write it."""

from __future__ import annotations

import shutil
import struct
import wave
from pathlib import Path

import numpy as np
import scipy.io
import scipy.sparse

REPOSITORY = Path(__file__).parents[2]
_RATE = 2048.0
_TIME = np.arange(256) / _RATE
_FORCE = 1e3 * np.exp(-((_TIME - 0.004) ** 2) / 2e-7)
_MOTION = -20.0 * np.sin(900.0 * _TIME) * np.exp(-20.0 * _TIME)
_COLUMNS = {"time [s]": _TIME, "force [N]": _FORCE, "acceleration [m/s^2]": _MOTION}
_FREQUENCY = np.linspace(100.0, 2000.0, 200)
_RECEPTANCE = 1e-2 / (900.0**2 - _FREQUENCY**2 + 40j * _FREQUENCY)

_PUNCH = """DMIG    KAAX           0       6       2       0                       4
DMIG    KAAX           8       1               8       1     4.0
               3       1    -4.0
DMIG    KAAX           3       1               3       1     4.0
"""
_TEXTS = {
    "model.pch": _PUNCH,
    "model.bdf": "GRID,3,,10.,0.5,-2.\nGRID,8,,1.,0.,2.5\nENDDATA\n",
    "job_STIF1.mtx": "8,1, 8,1,  4.0\n8,1, 3,1, -4.0\n3,1, 3,1,  4.0\n",
    "model.inp": "*HEADING\n*NODE, NSET=a\n 3, 10., .5, -2.\n 8, 1., 0., 2.5\n*ELEMENT\n1, 3, 8\n",
    "model.cdb": "/PREP7\nNBLOCK,6,SOLID,  8,  2\n(3i9,6e21.13e3)\n"
    "        3        0        0 1.0000000000000E+001 5.0000000000000E-001-2.0000000000000E+000\n"
    "        8        0        0 1.0000000000000E+000 0.0000000000000E+000 2.5000000000000E+000\n"
    "N,R5.3,LOC,       -1,\n",
    "nodes.csv": "node,x,y,z\n3,10,0.5,-2\n8,1,0,2.5\n",
}


def _rows(separator: str) -> str:
    return "\n".join(
        separator.join(f"{x:.9g}" for x in row) for row in zip(*_COLUMNS.values(), strict=True)
    )


def _lvm() -> str:
    head = "LabVIEW Measurement\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\n"
    head += "Decimal_Separator\t.\nX_Columns\tOne\n***End_of_Header***\n\nChannels\t2\n"
    head += (
        f"Samples\t{_TIME.size}\t{_TIME.size}\nX_Dimension\tTime\tTime\nY_Unit_Label\tN\tm/s^2\n"
    )
    head += f"X0\t0\t0\nDelta_X\t{1 / _RATE}\t{1 / _RATE}\n***End_of_Header***\n"
    return head + "X_Value\tForce\tAcc\tComment\n" + _rows("\t") + "\n"


def _sinumerik() -> str:
    records = "".join(
        f'<rec time="{t:.6f}" f1="{x:.9f}"/>' for t, x in zip(_TIME, _MOTION, strict=True)
    )
    signal = '<dataSignal id="f1" name="/Nck/a[u1,1]" description="Position actual value"/>'
    return (
        '<?xml version="1.0"?>\n<traceSession version="2.0"><traceData><dataFrame>'
        f'<frameHeader stopInc="0.8"/>{signal}{records}</dataFrame></traceData></traceSession>\n'
    )


def _tncscope() -> str:
    head = ["%[GLOBAL]", "%VERSION=3", "%", "%[CURVE0]", "%CHANNELTYPE=s act.", "%AXISTYPE=X"]
    head += ["%DIMENSION=mm", f"%COUNT={_TIME.size}", "%CYCLETIME=2000", "%", "%[DATA]"]
    body = [f"{2000 * k};{x:.9f};" for k, x in enumerate(_MOTION)]
    return "\n".join([*head, *body]) + "\n"


def _mr_configurator() -> str:
    head = ["Axis1", f"Number of sampling data,{_TIME.size}", "Sampling time interval(ms),2.000"]
    head += ["Time,Analog 1,Analog 2", "ms,Servo motor speed,Torque"]
    body = [f"{2 * k},{x:.9f},{x:.6f}" for k, x in enumerate(_MOTION)]
    return "\n".join([*head, *body, ""])


def _wav(path: Path) -> None:
    with wave.open(str(path), "wb") as file:
        file.setparams((1, 2, 8000, 0, "NONE", ""))
        samples = (2e4 * np.sin(0.3 * np.arange(4000))).astype(int)
        file.writeframes(struct.pack(f"<{samples.size}h", *samples))


def _with_libraries(folder: Path) -> None:
    import h5py
    import nptdms
    import openpyxl
    import pyarrow
    import pyarrow.parquet

    book = openpyxl.Workbook()
    for row in (list(_COLUMNS), *zip(*(one.tolist() for one in _COLUMNS.values()), strict=True)):
        book.active.append(row)
    book.save(folder / "tap.xlsx")
    pyarrow.parquet.write_table(pyarrow.table(_COLUMNS), folder / "tap.parquet")
    with h5py.File(folder / "tap73.mat", "w", userblock_size=512) as file:
        for name, values in {"force_N": _FORCE, "acc_ms2": _MOTION}.items():
            file[name] = values.reshape(1, -1)
        file["fs"] = [[_RATE]]
    with (folder / "tap73.mat").open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")
    with nptdms.TdmsWriter(folder / "tap.tdms") as writer:
        units = {"force": "N", "acceleration": "m/s^2"}
        step = {"wf_increment": 1.0 / _RATE, "wf_start_offset": 0.0, "wf_samples": _TIME.size}
        writer.write_segment(
            [
                nptdms.ChannelObject("tap", name, values, {**step, "unit_string": units[name]})
                for name, values in {"force": _FORCE, "acceleration": _MOTION}.items()
            ]
        )


def write_samples(folder: Path) -> list[Path]:
    """Write a file of every format into a folder; their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    texts = {
        **_TEXTS,
        "tap.lvm": _lvm(),
        "trace.xml": _sinumerik(),
        "trace.sco": _tncscope(),
        "mr.csv": _mr_configurator(),
        "tap.csv": ",".join(_COLUMNS) + "\n" + _rows(",") + "\n",
        "tap.txt": "\t".join(_COLUMNS) + "\n" + _rows("\t") + "\n",
    }
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    shutil.copy(REPOSITORY / "examples/flexible-workpiece/beam.uff", folder / "beam.uff")
    shutil.copy(REPOSITORY / "tests/data/frf-beam/point_1.csv", folder / "beam.csv")
    cutpro = [
        f"{f:.6g}\t{h.real:.9g}\t{h.imag:.9g}" for f, h in zip(_FREQUENCY, _RECEPTANCE, strict=True)
    ]
    (folder / "tool.frf").write_text("\n".join(["Freq\tHz\tReal\tm/N\tImag", *cutpro]) + "\n")
    np.savez_compressed(folder / "tap.npz", **_COLUMNS)
    frf = {"frequency_Hz": _FREQUENCY, "receptance [um/N]": 1e6 * _RECEPTANCE}
    scipy.io.savemat(folder / "frf.mat", frf, do_compression=True)
    scipy.io.savemat(
        folder / "tap.mat", {"tap": {"t_s": _TIME, "force_N": _FORCE, "acc_ms2": _MOTION}}
    )
    matrix = scipy.sparse.coo_array(np.array([[4.0, -4.0], [-4.0, 4.0]]))
    scipy.io.mmwrite(folder / "stiffness.mtx", matrix)
    scipy.sparse.save_npz(folder / "matrix.npz", scipy.sparse.csr_matrix(matrix))
    _wav(folder / "cut.wav")
    _with_libraries(folder)
    return sorted(folder.iterdir())
