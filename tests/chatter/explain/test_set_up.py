"""Tap tests and cuts of one set-up in one folder, judged together."""

import numpy as np
import pytest

import chatter
from benchmarks.blind_sets.milling_physics import TURN, Cut, arc_of, run
from chatter.description.errors import InputError
from chatter.explain.measurement_file import read_measurement
from tests.chatter.explain.records.test_records import CASE, NOISE, plant

OFFSET, ANGLE = 15e-6, 0.4
#: speed, rpm, radial depth, m, feed per tooth, m
CUTS = ((2000.0, 6e-3, 0.08e-3), (2270.0, 9e-3, 0.06e-3), (1710.0, 4.5e-3, 0.1e-3))
LINES = np.arange(300.0, 900.0, 4.0)
#: the cuts tell this little of a mass that is 8 % off, the taps all
MASS_DECLARED = 1.27


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Taps by the receptance of an oscillator, cuts by another program than the product."""
    path = tmp_path_factory.mktemp("set-up")
    declared = CASE.replace('mass = "1.2 kg"', f'mass = "{MASS_DECLARED} kg"')
    (path / "case.toml").write_text(declared, encoding="utf-8")
    random = np.random.default_rng(4)
    text = 'kind = "set-up"\ncase = "case.toml"\n[[part]]\nkind = "frf"\n'
    text += "".join(_tap(path, random, number) for number in range(6))
    text += '[[part]]\nkind = "milling"\n'
    text += "".join(_cut(path, random, number, *cut) for number, cut in enumerate(CUTS))
    (path / "measurement.toml").write_text(text, encoding="utf-8")
    return path


def _tap(path, random, number) -> str:
    axis = number % 2
    frequency, mass = ((560.0, 1.15), (600.0, 1.2))[axis]
    ratio = LINES / frequency
    exact = 1.0 / (mass * (TURN * frequency) ** 2 * (1.0 - ratio**2 + 2j * 0.03 * ratio))
    noise = 0.02 * np.abs(exact) * random.standard_normal((2, LINES.size)) / np.sqrt(2.0)
    columns = np.c_[LINES, exact.real + noise[0], exact.imag + noise[1]]
    file = f"tap{number}.csv"
    np.savetxt(
        path / file,
        columns,
        delimiter=",",
        header="frequency [Hz],real [m/N],imag [m/N]",
        comments="",
    )
    return f'[[part.run]]\nfile = "{file}"\ncondition = "idle"\ndirection = "{"xy"[axis]}"\n'


def _cut(path, random, number, rpm, radial, feed) -> str:
    true = plant()._replace(runout_offset=OFFSET, runout_angle=ANGLE)
    speed = rpm * TURN / 60.0
    cut = Cut(speed, feed, 0.6e-3, radial, *arc_of("down", radial, 10e-3), 0.0)
    made = run(true, cut, 5.0 * TURN / speed)
    rows = made.channels[:2]
    rows = rows + NOISE * rows.std(axis=1)[:, None] * random.standard_normal(rows.shape)
    columns = np.c_[made.time, rows.T]
    file = f"cut{number}.csv"
    head = "time [s],Fx [N],Fy [N]"
    np.savetxt(path / file, columns, delimiter=",", header=head, comments="")
    return (
        f'[[part.run]]\nfile = "{file}"\nspindle_speed = "{rpm} rpm"\n'
        f"radial_depth = {radial}\nfeed_per_tooth = {feed}\n"
    )


@pytest.mark.nightly
def test_runout_of_the_cuts_beside_a_mass_of_the_taps(folder, tmp_path):
    found = chatter.explain(folder)
    summary = found.summary()
    assert summary["verdict"] == "explained"
    (effect,) = summary["effects"]
    assert effect["name"] == "runout"
    assert effect["parameters"]["offset"]["value"] == pytest.approx(OFFSET, rel=0.03)
    # 2 % of scatter at each of 150 lines, of three taps: the mass to a few tenths of a percent
    assert found.case.structure.mode[1].mass == pytest.approx(1.2, rel=0.01)
    assert set(summary["error_by_channel"]) == {"real", "imag", "Fx", "Fy"}
    written = found.save(tmp_path)
    assert {"explanation.json", "report.html", "residual.png"} <= {one.name for one in written}


def test_errors_are_compared_part_by_part(folder):
    found = chatter.compare(folder)
    channels = {one.run: set() for one in found.errors}
    for one in found.errors:
        channels[one.run].add(one.channel)
    assert channels["tap0.csv"] == {"real", "imag"}
    assert channels["cut0.csv"] == {"Fx", "Fy"}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('kind = "set-up"\ncase = "case.toml"\n', "there is no [[part]]"),
        (
            'kind = "set-up"\ncase = "case.toml"\n[[part]]\nkind = "taps"\n',
            'part 1: kind: "taps" is none of milling, axis, stability, frf',
        ),
        (
            'kind = "set-up"\ncase = "case.toml"\n[[part]]\nkind = "frf"\ncase = "other.toml"\n',
            "part 1: case is not a key",
        ),
        (
            'kind = "set-up"\ncase = "case.toml"\n[[part]]\nkind = "frf"\n',
            "part 1: there is no [[run]]",
        ),
        ('kind = "set-up"\ncase = "case.toml"\n[[run]]\nfile = "a.csv"\n', "run is not a key"),
    ],
)
def test_set_ups_that_are_wrong_are_told(folder, tmp_path, text, words):
    (tmp_path / "case.toml").write_bytes((folder / "case.toml").read_bytes())
    (tmp_path / "measurement.toml").write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_measurement(tmp_path)
    assert words in str(caught.value)
