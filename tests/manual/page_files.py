"""Files that the commands of a page of the manual name, made in the working folder."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import numpy as np
import scipy.io.wavfile

import chatter
from tests.chatter.assembly.test_assemble import ASSEMBLY
from tests.chatter.cutting_coefficients.test_coefficients import UP_CUT, records, waveform
from tests.chatter.detection.made_recordings import RATE
from tests.chatter.drive_friction.test_identified_friction import stroke
from tests.chatter.io.formats.test_compressed_sound import encode
from tests.chatter.monitoring.test_detect import made
from tests.places import EXAMPLES, ROOT

#: of the case of few speeds: studies are quick
_FEW = "5000..25000 rpm:40"
#: Hz
_RATE_OF_TELEPHONES = 48000


def case(name="case.toml"):
    """Two degrees of freedom, few speeds."""
    text = (EXAMPLES / "two-degrees-of-freedom" / "case.toml").read_text(encoding="utf-8")
    Path(name).write_text(text.replace("5000..25000 rpm:400", _FEW), encoding="utf-8")


def first_toml_of_readme():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    lines = re.search(r"^ +title = .*?(?=\n {3}or your tap test)", text, re.MULTILINE | re.DOTALL)
    Path("case.toml").write_text(re.sub(r"^ {7}", "", lines[0], flags=re.MULTILINE))


def assembly():
    case()
    Path("maker.csv").write_text(
        "Order code;DC [mm];DCON [mm];APMX [mm];OAL [mm];ZEFP;Substrate\nA-1;12,0;12;26;83;4;VHM\n"
    )
    Path("assembly.toml").write_text(ASSEMBLY)


def measurement():
    shutil.copytree(EXAMPLES / "explain-milling" / "measurement", "measurement")


def cuts_with_forces():
    folder = Path("records")
    folder.mkdir()
    records(folder, **UP_CUT, feeds=(0.05, 0.06, 0.08, 0.12))
    text = (folder / "measurement.toml").read_text()
    for feed in ("0.06", "0.12"):
        name = f"f{round(1e4 * float(feed))}.csv"
        (folder / f"feed_{feed}.csv").rename(folder / name)
        text = text.replace(f"feed_{feed}.csv", name)
    (folder / "measurement.toml").write_text(text)
    shutil.copy(folder / "case.toml", "case.toml")
    time = np.arange(0.0, 0.4, 1e-4)
    parts = [waveform(time, 1e-3 * feed, UP_CUT["arc"]) for feed in (0.04, 0.08, 0.12)]
    rate = np.repeat([0.04, 0.08, 0.12], time.size) * 3 * 3000.0  # mm/min
    table = np.c_[np.arange(rate.size) * 1e-4, np.concatenate(parts), rate]
    heading = "time [s],Fx [N],Fy [N],Fz [N],feed_rate [mm/min]"
    np.savetxt("cut.csv", table, delimiter=",", comments="", header=heading)
    np.savetxt("cut.txt", table)


def recordings():
    time, values = made()
    loud = (values / np.abs(values).max() * 2**15 * 0.9).astype(np.int16)
    scipy.io.wavfile.write("cut.wav", round(RATE), loud)
    encode("recording.m4a", [loud / 2**15], "aac", rate=_RATE_OF_TELEPHONES)
    np.savetxt("cut.csv", np.c_[time, values], delimiter=",", header="time [s],a [m/s^2]",
               comments="")  # fmt: skip
    np.savetxt("forces.csv", np.c_[values, values], delimiter=",", header="Fx [N],Fy [N]",
               comments="")  # fmt: skip
    case()


def moves():
    stroke(Path("stroke.csv"))
    table = np.loadtxt("stroke.csv", delimiter=",", skiprows=1)
    back = table * [1.0, -1.0, -1.0, -1.0]
    heading = "time [s],position [mm],velocity [mm/s],force [N]"
    for name, one in (("move1.csv", table), ("move2.csv", back)):
        np.savetxt(name, one, delimiter=",", comments="", header=heading)
    shutil.copytree(EXAMPLES / "explain-axis" / "measurement", "moves")
    # the same stroke at the motor: 10 mm a revolution, 1.2 N m/A
    motor = np.c_[table[:, 0], table[:, 2] * 6.0, table[:, 3] * 0.01 / (2.0 * np.pi) / 1.2]
    np.savetxt("trace.csv", motor, delimiter=",", comments="",
               header="time [s],speed [rpm],current [A]")  # fmt: skip


def cutting_tests():
    case()
    page = (ROOT / "docs" / "learning.md").read_text(encoding="utf-8")
    table = re.search(r"^    spindle_speed \[rpm\].*\n(    .*\n)+", page, re.MULTILINE)
    Path("cuts.csv").write_text(re.sub(r"^ +", "", table[0], flags=re.MULTILINE))


def optimum_and_pitch():
    best = (EXAMPLES / "best-cut" / "case.toml").read_text(encoding="utf-8")
    Path("CASE").write_text(best, encoding="utf-8")


def sheets():
    for name in ("case.toml", "rough.toml", "finish.toml"):
        case(name)


def machine():
    text = (EXAMPLES / "machine-coupled-milling" / "machine.toml").read_text(encoding="utf-8")
    # its first FRF and its shortest move
    begin, end = text.index("[frf.moving]"), text.index("[move.speed]")
    Path("machine.toml").write_text(text[:begin] + text[end:], encoding="utf-8")
    cut = (EXAMPLES / "face-mill-chatter" / "case.toml").read_text(encoding="utf-8")
    few = (
        cut.replace('duration = "4 s"', 'duration = "0.3 s"')
        + '\n[lobes]\nspeeds = "500..1200 rpm:20"\n'
    )
    Path("case.toml").write_text(few, encoding="utf-8")


def nothing():
    """The commands of the page make what they need."""


def shipped_examples():
    Path("examples").symlink_to(EXAMPLES)


def given_case():
    case("CASE")
    case()


def loaded_case():
    """Names that pages take as known."""
    return {"chatter": chatter, "np": np, "frequency": np.array([50.0])}
