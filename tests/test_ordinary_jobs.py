"""Jobs of docs/ordinary-jobs.md, run as they stand there; their numbers by hand."""

import math
import re
import shlex

import numpy as np
import pytest

from tests.command_line import chatter_command
from tests.places import ROOT

PAGE = (ROOT / "docs" / "ordinary-jobs.md").read_text(encoding="utf-8")
#: lines of a job that are indented: its command, and what is printed
JOB = re.compile(r"^    (chatter .+)\n((?:    > .+\n)*)", re.MULTILINE)
#: further files of the page: their name in a comment, and their lines
FILES = re.findall(r"^    # (\S+\.toml)\n((?:    .*\n)+)", PAGE, re.MULTILINE)
JOBS = [
    (command, [line.removeprefix("    > ") for line in printed.splitlines()])
    for command, printed in JOB.findall(PAGE)
]


def case_file(folder):
    """The case of the page."""
    begin, end = PAGE.index("    title ="), PAGE.index("\n## ")
    lines = [line.removeprefix("    ") for line in PAGE[begin:end].splitlines()]
    (folder / "job.toml").write_text("\n".join(lines) + "\n", encoding="utf-8")
    for name, content in FILES:
        text = re.sub(r"^    ", "", content, flags=re.MULTILINE)
        (folder / name).write_text(text, encoding="utf-8")


@pytest.mark.parametrize(("command", "printed"), JOBS, ids=[command for command, _ in JOBS])
def test_a_job_prints_what_the_page_says(command, printed, tmp_path, monkeypatch):
    case_file(tmp_path)
    monkeypatch.chdir(tmp_path)
    result = chatter_command(*shlex.split(command)[1:])
    shown = result.stdout + result.stderr
    assert printed
    for words in printed:
        assert words in shown
    if "--exit-code" in command:
        assert result.exit_code == 3


def test_numbers_of_the_page_are_those_of_the_textbook():
    speed = 60.0 / (math.pi * 0.016)
    assert f"{speed:.2f} rpm" in PAGE
    assert f"{380.0 / (4.0 * speed):.4f} mm" in PAGE
    cutting = 1900e6 * 0.5e-3 * 8e-3 * 0.38 / 60.0
    edge = 25e3 * 0.5e-3 * 1.0
    assert f"= {cutting:.1f} W" in PAGE
    assert f"power {cutting + edge:.2f} W mean" in PAGE
    assert f"power {cutting + edge + 0.3 * 200e6 * 0.3e-3 * 0.5e-3:.2f} W mean" in PAGE
    effective = 2.0 * math.sqrt(0.5 * 9.5)
    assert f"= {effective:.3f} mm" in PAGE
    assert f"{math.degrees(math.acos(1.0 - 0.4 / (0.5 * effective))):.1f}° at the depth" in PAGE
    assert f"{90.0 - math.degrees(math.asin(30 / 40)):.2f}° to" in PAGE
    angles = [math.degrees(math.acos(y / 40)) for y in (25, -35)]
    assert f"{angles[0]:.2f}° to acos(-35/40) = {angles[1]:.2f}°" in PAGE
    width = 8.0 * (math.cos(math.radians(30.0)) - math.cos(math.radians(100.0)))
    assert f"= {width:.3f} mm across" in PAGE
    assert f"{math.pi * effective * 60.0 / (math.pi * 0.01) * 1e-3:.2f} m/min there" in PAGE


def test_numbers_of_further_tools_by_hand():
    slot = 1900e6 * 11e-3 * 25e-3 * 0.076 / 60.0, 3 * 25e3 * 11e-3 * 25.0 / 60.0
    assert f"= {slot[0]:.1f} W" in PAGE
    assert f"each: {slot[1]:.1f} W" in PAGE
    assert f"power {sum(slot):.0f} W mean" in PAGE
    rough = 767e6 * 10e-3 * 20e-3 * 10.8 / 60.0, 1.5 * 27.7e3 * 10e-3 * math.pi * 0.02 * 400.0
    assert f"= {rough[0] / 1e3:.2f} kW" in PAGE
    assert f"each: {rough[1] / 1e3:.2f} kW" in PAGE
    assert "power 38.06 kW mean" in PAGE
    assert sum(rough) == pytest.approx(38.06e3, rel=3e-4)
    slope = 1.0 / math.tan(math.radians(17.0))
    z = 0.8e-3 * (np.arange(100000) + 0.5) / 100000
    arc = np.arccos(1.0 - (22e-3 + z * slope) / (16e-3 + z * slope))
    swept = np.mean((16e-3 + z * slope) * arc) * 0.8e-3 / math.sin(math.radians(17.0))
    area = 0.8e-3 * (22e-3 + 0.4e-3 * slope)
    high = 1900e6 * area * 0.38 / 60.0, 4.0 / (2.0 * math.pi) * 25e3 * 62.5 * swept
    assert f"{1e6 * area:.2f} mm²" in PAGE
    assert f"along it, {1e6 * swept:.2f} mm², is {high[1]:.1f} W" in PAGE
    assert f"power {sum(high):.0f} W mean" in PAGE
    z = 0.4e-3 * (np.arange(100000) + 0.5) / 100000
    lean = math.radians(10.0)
    wide = z * math.tan(math.radians(30.0) + lean) + np.minimum(z / math.tan(lean), 1e-3)
    area = 0.4e-3 * np.mean(wide)
    assert f"{1e6 * area:.4f} mm²" in PAGE
    assert f"power {1900e6 * area * 0.38 / 60.0:.2f} W mean" in PAGE


def test_numbers_of_chips_and_power_by_hand():
    speed = 1.0  # m/s, 60 m/min
    chip = 380.0 / (4.0 * 60e3 / (math.pi * 16.0))  # mm
    # Kienzle, the integral of sin^p over a quarter of a revolution
    p = 0.76
    arc = 0.5 * math.sqrt(math.pi) * math.gamma(0.5 * (p + 1.0)) / math.gamma(0.5 * p + 1.0)
    assert f"= {arc:.3f} rad" in PAGE
    kienzle = 4.0 / (2.0 * math.pi) * 1245.0 * chip**p * 0.5 * arc * speed
    assert f"power {kienzle:.2f} W mean" in PAGE
    assert f"power {1850.0 * 0.5 * 8.0 * 0.38 / 60.0:.2f} W mean" in PAGE
    assert f"= {0.1 * 4.0 * 60e3 / (math.pi * 16.0):.1f} mm/min" in PAGE
    assert f"= {(1900.0 * chip + 25.0) * 0.5:.1f} W, less" in PAGE
    assert f"= {(1900.0 * (chip + 0.01) + 25.0) * 0.5:.1f} W" in PAGE
    first, second = 80.0 / 90.0 * chip, 100.0 / 90.0 * chip
    both = 1900.0 * (first + second * math.sin(math.radians(170.0))) + 50.0
    assert f"{both * 0.5:.1f} W peak" in PAGE
    arc = math.acos(1.0 - 2.0 * 2.0 / 16.0)
    edges = 12.5 * 4.0 * arc / (2.0 * math.pi)
    assert f"power {1900.0 * 0.5 * 2.0 * 0.38 / 60.0 + edges:.2f} W mean" in PAGE
    assert f"torque {(1900.0 * 4.0 * 0.38 / 60.0 + 12.5) / 125.0:.3f} N m mean" in PAGE


def test_forces_and_surfaces_by_hand():
    chip = 380.0 / (4.0 * 60e3 / (math.pi * 16.0))  # mm
    # Altintas 2012, 2.52: N a_p = 0.8 mm
    assert f"> {-0.8 * (chip * 700.0 / 4.0 + 40.0 / math.pi):.2f}\n" in PAGE
    assert f"> {0.8 * (chip * 1900.0 / 4.0 + 25.0 / math.pi):.2f}\n" in PAGE
    assert f"> {4.0 / (2.0 * math.pi) * 500.0 * chip * 0.5:.2f}\n" in PAGE
    assert f"Rz {1e3 * chip**2 / 8.0:.3f} um" in PAGE
    cusp = 1e3 * chip**2 / (4.0 * 16.0)
    assert f"= {cusp:.4f} um" in PAGE
    assert f"of it, {cusp * 4.0 / (9.0 * math.sqrt(3.0)):.4f} um" in PAGE
    assert f"= {1e3 * (5.0 - math.sqrt(25.0 - 0.2**2)):.2f} um" in PAGE
    wide, fast = 48.1333 * 8.25 / 8.0, 12.5 * math.sqrt(2.0) * 8.25 / 8.0
    assert f"8.25/8 = {wide:.1f} W" in PAGE
    assert f"1.031 = {fast:.1f} W" in PAGE
    # 67.87 W as simulated, in slices of the inclined edge
    assert wide + fast == pytest.approx(67.87, rel=2e-3)


def rubbed(radius, angle, length, step):
    """Integral over an edge of radius times arc, mm^2: radii, mm, over an angle of its profile."""
    kappa = (np.arange(100_000) + 0.5) / 100_000 * angle
    r = radius(kappa)
    arc = np.where(step >= 2.0 * r, np.pi, np.arccos(np.clip(1.0 - step / r, -1.0, 1.0)))
    return float(np.mean(r * arc)) * length


def test_tools_of_other_shapes_by_hand():
    teeth = 4.0 / (2.0 * math.pi)
    # a ball of 10 mm, 0.3 mm deep and beside its pass
    z = (np.arange(100_000) + 0.5) / 100_000 * 0.3
    r = np.sqrt(10.0 * z - z**2)
    area = float(np.mean(np.minimum(0.3, 2.0 * r))) * 0.3
    angle = math.acos(1.0 - 0.3 / 5.0)
    path = rubbed(lambda kappa: 5.0 * np.sin(kappa), angle, 5.0 * angle, 0.3)
    chip, edge = 1900.0 * area * 0.38 / 60.0, teeth * 25.0 * 0.2 * path
    assert f"{area:.4f} mm² · 380 mm/min = {chip:.3f} W" in PAGE
    assert f"{path:.3f} mm² with r = 5 mm sin κ: {edge:.3f} W" in PAGE
    assert f"power {chip + edge:.3f} W mean" in PAGE
    assert f"= {1e3 * (5.0 - math.sqrt(25.0 - 0.15**2)):.2f} um" in PAGE
    # a bull nose of 2 mm, 1 mm deep
    angle = math.acos(1.0 - 1.0 / 2.0)
    path = rubbed(lambda kappa: 6.0 + 2.0 * np.sin(kappa), angle, 2.0 * angle, 4.0)
    chip, edge = 1900.0 * 4.0 * 0.38 / 60.0, teeth * 25.0 * 0.125 * path
    assert f"{path:.2f} mm², is {edge:.2f} W" in PAGE
    assert f"power {chip + edge:.2f} W mean" in PAGE
    # a taper: as wide as its radius at every height, so that the arc is a quarter of a turn
    slope = math.tan(math.radians(10.0))
    wide = 4.0 + slope
    length = 2.0 / math.cos(math.radians(10.0))
    chip, edge = (
        1900.0 * 2.0 * wide * 0.38 / 60.0,
        teeth * 25.0 * 0.25 * wide * 0.5 * math.pi * length,
    )
    assert f"{wide:.3f} mm in the mean" in PAGE
    assert f"= {chip:.1f} W. The edge is" in PAGE
    assert f"the arc: {edge:.1f} W" in PAGE
    assert f"power {chip + edge:.1f} W mean" in PAGE


def test_further_power_and_angles_by_hand():
    """Chip 1900 MPa times the removal rate, edges 25 N/mm times their length and speed."""

    def power(depth, area_of_edge, teeth, turns, rate):
        edge = teeth * turns / 60.0 * 25.0 * area_of_edge / 1e3
        return 1900.0 * depth * rate / 60.0 / 1e3, edge

    def turns(speed, diameter):
        return speed * 1e3 / (math.pi * diameter)

    inch = turns(200 * 0.3048, 12.7)
    slot = power(0.508 * 12.7, 6.35 * math.pi * 0.508, 3, inch, 15 * 25.4)
    of_saw = turns(60.0, 80.0)
    feed = of_saw * 18 * 0.03
    saw = power(3.0 * 5.0, 40.0 * 3.0 * math.acos(1.0 - 5.0 / 40.0), 18, of_saw, feed)
    fly = power(0.5 * 100.0, 62.5 * 0.5 * 2.0 * math.asin(0.8), 1, turns(60.0, 125.0), 100.0)
    chamfer = power(1.5, 1.5 * math.sqrt(2.0) * 0.5 * math.pi, 4, turns(30.0, 2.0), 380.0)
    for chip, edge in (slot, saw, fly, chamfer):
        assert f"{chip:.2f} W" in PAGE
        assert f"{edge:.2f} W" in PAGE
        assert f"{chip + edge:.4g} W" in PAGE
    for chip, edge in (saw, fly, chamfer):
        assert f"power {chip + edge:.4g} W mean" in PAGE
    assert f"power {sum(slot) / 745.69987:.4g} hp mean" in PAGE
    assert f"feed rate {feed:.4g} mm/min" in PAGE
    ends = [math.degrees(math.acos(y / 31.5)) for y in (20.0, -30.0)]
    assert f"{ends[0]:.4g} to {ends[1]:.4g} deg" in PAGE
    assert f"{180.0 - math.degrees(math.acos(1.0 - 0.16)):.4g} to 180 deg" in PAGE
    lead, tilt = math.radians(15.0), math.radians(10.0)
    leaning = math.acos(math.cos(lead) * math.cos(tilt))
    wide = 6.0 * math.sin(leaning + math.acos(1.0 - 0.1))
    assert f"{wide:.4g} mm, {math.pi * wide * turns(60.0, 6.0) / 1e3:.4g} m/min there" in PAGE


def test_further_materials_and_edges_by_hand():
    chip = 380.0 / (4.0 * 60e3 / (math.pi * 16.0))  # mm

    def mean_of_arc(p):
        """Integral of sin^p over a quarter of a revolution, rad."""
        x = (np.arange(200_000) + 0.5) / 200_000 * 0.5 * math.pi
        return float(np.mean(np.sin(x) ** p)) * 0.5 * math.pi

    tool_steel = 4.0 / (2.0 * math.pi) * 2450.0 * chip**0.77 * 0.5 * mean_of_arc(0.77)
    iron = 4.0 / (2.0 * math.pi) * 1350.0 * chip**0.72 * 0.5 * 2.0 * mean_of_arc(0.72)
    for power in (tool_steel, iron):
        assert f"at 1 m/s = {power:.1f} W" in PAGE
        assert f"power {power:.1f} W mean" in PAGE
    pitch = math.pi * 16.0 / (4.0 * math.tan(math.radians(40.0)))
    assert f"= {pitch:.3f} mm. As deep" in PAGE
    even = (1900.0 * 8.0 * 0.38 / 60.0 + 25.0) * pitch  # at 1 m/s one tooth of four is in the cut
    assert f"power {even:.4g} W mean, {even:.4g} W peak" in PAGE
    assert f"= {15.0 * 2.0 ** (1.0 / 0.25):.0f} min at 60 m/min" in PAGE


def test_limits_by_hand():
    stiffness, damping = 12e3, 0.03  # N/mm
    ratio = np.linspace(0.9, 1.3, 400001)
    response = 1.0 / stiffness / (1.0 - ratio**2 + 2j * damping * ratio)
    lowest = math.inf
    for sign in (1j, -1j):
        eigenvalue = -1.0 / (math.pi * (-700.0 / 1900.0 + sign) * response)
        share = eigenvalue.imag / eigenvalue.real
        depth = -2.0 * math.pi * eigenvalue.real * (1.0 + share**2) / (4.0 * 1900.0)
        lowest = min(lowest, depth[depth > 0.0].min())
    assert f"lowest limit {lowest:.4g} mm" in PAGE
    assert f"= {60 * 900 // 4} rpm" in PAGE
    assert f"1.1 mm -> {1.1 / 8.0:.4g} mm" in PAGE
    tool = 3.0 * math.pi * 650e9 * 0.016**4 / (64.0 * 0.08**3)
    assert f"= {1e-6 * tool:.1f} N/um" in PAGE


def test_there_are_jobs():
    assert len(JOBS) >= 50
    assert PAGE.count("\n## ") >= 37
