"""Traces of drives as the programs of controls write them: the same signals from each layout."""

from pathlib import Path

import numpy as np
import pytest

from chatter.drive_friction.drive_records import DriveSettings, drive_records
from chatter.io.formats.format_list import format_of
from chatter.io.stated_columns import read_signal_table
from dynamics.frf.container import MeasurementError

COUNT, CYCLE = 400, 0.002
TIME = CYCLE * np.arange(COUNT)
#: mm, mm/min, A
POSITION = 30.0 * (1.0 - np.cos(2.0 * np.pi * TIME))
VELOCITY = 60.0 * 30.0 * 2.0 * np.pi * np.sin(2.0 * np.pi * TIME)
CURRENT = np.round(3.0 * np.sign(VELOCITY) + VELOCITY / 4000.0, 2)


def sinumerik(path: Path, *, frames=1, before="") -> Path:
    """A saved session; a current that did not change is not repeated."""
    records, last = [], None
    for time, position, velocity, current in zip(TIME, POSITION, VELOCITY, CURRENT, strict=True):
        repeated = "" if current == last else f' f3="{current:.6f}"'
        last = current
        records.append(
            f'<rec time="{time:.6f}" f1="{position:.9f}" f2="{velocity:.9f}"{repeated}/>'
        )
    signals = (
        '<dataSignal id="f1" name="/Nck/a[u1,1]" description="Position actual value" '
        f'interval="{CYCLE}" unitsType="position"/>'
        '<dataSignal id="f2" name="/Nck/b[u1,1]" description="Velocity actual value"/>'
        '<dataSignal id="f3" name="/Nck/c[u1,1]" description="Torque-generating current i(q)"/>'
    )
    frame = f'<dataFrame><frameHeader stopInc="0.8"/>{signals}{"".join(records)}</dataFrame>'
    text = f'<?xml version="1.0"?>\n{before}<traceSession version="2.0"><traceData>{frame * frames}'
    path.write_text(f"{text}</traceData></traceSession>\n", encoding="utf-8")
    return path


def tncscope(path: Path, *, cycles=(2000, 2000, 2000)) -> Path:
    kinds = (("s act.", "mm"), ("v act.", "mm/min"), ("i act.", "A"))
    head = ["%[GLOBAL]", "%VERSION=3", "%"]
    for k, (kind, unit) in enumerate(kinds):
        head += [f"%[CURVE{k}]", f"%CHANNELTYPE={kind}", "%AXISTYPE=X", f"%DIMENSION={unit}"]
        head += [f"%COUNT={COUNT}", f"%CYCLETIME={cycles[k]}", "%"]
    rows = zip(1e6 * TIME, POSITION, VELOCITY, CURRENT, strict=True)
    body = [";".join(f"{value:.9f}" for value in row) + ";" for row in rows]
    path.write_text("\n".join([*head, "%[DATA]", *body]) + "\n", encoding="cp1252")
    return path


def mr_configurator(path: Path) -> Path:
    head = [
        "Axis1",
        f"Number of sampling data,{COUNT}",
        "Sampling time interval(ms),2.000",
        "Time,Analog 1,Analog 2,Analog 3,Digital 1",
        "ms,Servo motor speed,Not selected,Torque,Not selected",
    ]
    rows = zip(1e3 * TIME, VELOCITY / 10.0, CURRENT, strict=True)
    body = [f"{time:.6f},{speed:.9f},0.0,{torque:.6f},0.0" for time, speed, torque in rows]
    path.write_text("\n".join([*head, *body, ""]), encoding="utf-8")
    return path


def starter(path: Path) -> Path:
    """A table with semicolons and decimal commas, as drive programs export it in Germany."""
    rows = zip(1e3 * TIME, VELOCITY / 10.0, VELOCITY, CURRENT, strict=True)
    body = [";".join(f"{value:.9f}".replace(".", ",") for value in row) for row in rows]
    names = "Zeit [ms];Drehzahlistwert [1/min];Drehzahlsollwert [1/min];Momentenistwert [Nm]"
    path.write_text("\n".join([names, *body]) + "\n", encoding="cp1252")
    return path


STATED = {"position": "Position actual value [mm]", "velocity": "Velocity actual value [mm/min]"}
CONSTANT = {"force_constant": 50.0}
CASES = [
    (sinumerik, "t.xml", "sinumerik-trace", {**STATED, "effort": "Torque-generating current i q "
                                             "[A]", **CONSTANT}, 50.0),
    (tncscope, "t.sco", "tncscope", CONSTANT, 50.0),
    (
        mr_configurator,
        "t.csv",
        "mr-configurator",
        {
            "velocity": "Servo motor speed [r/min]",
            "effort": "Torque [%]",
            "rated_torque": 2.0,
            "lead": 0.01,
        },
        0.01 * 2.0 * 2.0 * np.pi / 0.01,
    ),
    (starter, "t.csv", "csv", {"lead": 0.01}, 2.0 * np.pi / 0.01),
]  # fmt: skip


@pytest.mark.parametrize(("write", "name", "kind", "settings", "force"), CASES)
def test_the_same_move_from_every_program(tmp_path, write, name, kind, settings, force):
    """A motor at 10 mm a revolution: 1 r/min is 10 mm/min, 1 N m is 2 pi / 0.01 m = 628 N."""
    path = write(tmp_path / name)
    assert format_of(path, "signals").name == kind
    found = drive_records([path], DriveSettings(**settings))
    record = found.records[0]
    assert not found.rotary
    assert record.sample_time == pytest.approx(CYCLE, rel=1e-9)
    np.testing.assert_allclose(record.velocity, VELOCITY / 60e3, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(record.effort, force * CURRENT, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(record.position, 1e-3 * POSITION, atol=2e-6)


def test_headings_carry_what_the_files_tell(tmp_path):
    scope = read_signal_table(tncscope(tmp_path / "a.sco"))
    assert [column.heading for column in scope.columns] == [
        "time [s]", "s act. X [mm]", "v act. X [mm/min]", "i act. X [A]",
    ]  # fmt: skip
    trace = read_signal_table(sinumerik(tmp_path / "a.xml"))
    assert [column.unit for column in trace.columns] == ["s", "", "", ""]
    graph = read_signal_table(mr_configurator(tmp_path / "a.csv"))
    assert [column.heading for column in graph.columns] == [
        "time [ms]", "Servo motor speed", "Torque",
    ]  # fmt: skip


def test_signals_of_one_description_are_told_apart_by_their_names(tmp_path):
    path = sinumerik(tmp_path / "a.xml")
    text = path.read_text(encoding="utf-8").replace("Velocity actual", "Position actual")
    path.write_text(text, encoding="utf-8")
    headings = [column.heading for column in read_signal_table(path).columns]
    assert headings[1:3] == [
        "Position actual value /Nck/a u1,1", "Position actual value /Nck/b u1,1",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("write", "name", "change", "told"),
    [
        (sinumerik, "a.xml", ("</traceSession>", ""), "is no whole XML file"),
        (sinumerik, "a.xml", ("traceData", "traceSetup"), "holds 0 frames of data"),
        (sinumerik, "a.xml", ("<rec ", "<row "), "the trace holds no samples"),
        (sinumerik, "a.xml", (' f3="', ' g3="'), "has no value at the start of the trace"),
        (sinumerik, "a.xml", ('time="0.002000"', 'time="soon"'), "'soon' is not a number"),
        (tncscope, "a.sco", ("%[DATA]", "%[ROWS]"), "no %[DATA]"),
        (tncscope, "a.sco", (f"%COUNT={COUNT}", "%COUNT=500"), "400 rows where COUNT says 500"),
        (tncscope, "a.sco", ("%CYCLETIME=2000", "%CYCLETIME=0"), "both must be above 0"),
        (tncscope, "a.sco", ("\n0.000000000;", "\n0.000000000;1;"), "line 26 has 5 columns"),
        (mr_configurator, "a.csv", ("\nTime,", "\nTicks,"), 'that begins with "Time"'),
        (mr_configurator, "a.csv", ("\n2.000000,", "\n2.000000,x"), "line 7: "),
    ],
)
def test_damaged_files_are_refused_in_a_sentence(tmp_path, write, name, change, told):
    path = write(tmp_path / name)
    text = path.read_text(encoding="cp1252")
    assert change[0] in text
    path.write_text(text.replace(*change), encoding="cp1252")
    with pytest.raises(MeasurementError) as refused:
        read_signal_table(path)
    assert str(path) in str(refused.value)
    assert told in str(refused.value)


def test_two_frames_and_entities_are_refused(tmp_path):
    with pytest.raises(MeasurementError, match="holds 2 frames"):
        read_signal_table(sinumerik(tmp_path / "two.xml", frames=2))
    laughs = '<!DOCTYPE t [<!ENTITY a "ha">]>\n'
    with pytest.raises(MeasurementError, match="declares entities"):
        read_signal_table(sinumerik(tmp_path / "entities.xml", before=laughs))


def test_curves_at_different_cycles_are_refused(tmp_path):
    path = tncscope(tmp_path / "a.sco", cycles=(2000, 2000, 3000))
    with pytest.raises(MeasurementError, match=r"sampled differently \(400 every 2000 us, 400 ev"):
        read_signal_table(path)
