"""Regenerative milling integrated in time, written apart from the package.

Shares no code and no numerical method with ``chatter``, ``cutting`` or ``dynamics``: classical
Runge-Kutta on the modal equations, the whole history kept and interpolated with cubic Hermite
polynomials, the cutting edge in many slices whose engaged part is weighed exactly.  Everything is
in SI units; angles are in rad.  The equations are those of DESIGN.md, "Conventions".

    time step    a uniform grid in spindle angle, refined by the angles at which an end of an edge
                 enters or leaves the cut, so that no step straddles such an event
    history      u(t) = 0 before t = 0; earlier teeth did pass then, with their runout and the feed
    forces       at a sample that falls on an entry or exit, the limit from the right
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numba import njit

TWO_PI = 2.0 * np.pi
NUDGE = 1e-9  # rad; which side of an entry or exit a stage at the end of a step belongs to


@dataclass(frozen=True)
class ReferenceMode:
    """A mode: frequency in Hz, damping ratio, modal mass in kg, unit vector, side."""

    frequency: float
    damping: float
    mass: float
    direction: tuple[float, float, float]
    side: str = "tool"


@dataclass(frozen=True)
class ReferenceCut:
    """One milling cut in SI units.

    ``pitch`` lists the angle from each tooth to the next (N values that add up to 2 pi); ``helix``
    holds one angle for each tooth.  ``exponent`` of ``None`` means the linear law.  ``passes`` is
    how many earlier passes the chip looks back on, 0 for the number of teeth: one revolution, as
    the sets in shared/measurements were made.  ``runout_follows_helix`` takes
    the runout at the angle of the tooth at height z instead of at the tip; it is no convention of
    the package, only a variant to hold against measurements (which refute it).
    """

    radius: float
    pitch: tuple[float, ...]
    helix: tuple[float, ...]
    modes: tuple[ReferenceMode, ...]
    spindle_speed: float  # rad/s
    feed_per_tooth: float
    axial_depth: float
    radial_depth: float
    mode: str = "down"  # "up", "down", "slot"
    Ktc: float = 0.0
    Krc: float = 0.0
    Kac: float = 0.0
    Kte: float = 0.0
    Kre: float = 0.0
    Kae: float = 0.0
    h0: float = 1e-4
    exponent: float | None = None
    runout_offset: float = 0.0
    runout_angle: float = 0.0
    damping_coefficient: float = 0.0  # N/m
    damping_friction: float = 0.0
    passes: int = 0
    runout_follows_helix: bool = False

    @property
    def teeth(self) -> int:
        """Number of teeth."""
        return len(self.pitch)

    @property
    def period(self) -> float:
        """Time of one revolution in s."""
        return TWO_PI / self.spindle_speed

    @property
    def arc(self) -> tuple[float, float]:
        """Entry and exit angle."""
        if self.mode == "slot":
            return 0.0, np.pi
        swept = float(np.arccos(np.clip(1.0 - self.radial_depth / self.radius, -1.0, 1.0)))
        if self.mode == "up":
            return 0.0, swept
        if self.mode == "down":
            return np.pi - swept, np.pi
        raise ValueError(f"mode is {self.mode!r}, not 'up', 'down' or 'slot'")


@dataclass(frozen=True)
class ReferenceRecord:
    """Signals at the sample times: forces on the tool (N), tool relative to workpiece (m).

    ``tool`` and ``workpiece`` (each n x 3, m) are the two parts of the displacement, each as it
    adds to the relative one: the workpiece itself moves by minus ``workpiece``.
    """

    time: np.ndarray
    spindle_angle: np.ndarray
    Fx: np.ndarray
    Fy: np.ndarray
    Fz: np.ndarray
    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    tool: np.ndarray = field(repr=False)
    workpiece: np.ndarray = field(repr=False)


@njit(cache=True)
def _locate(psi, grid, table):
    """Index of the step that holds the angle ``psi`` >= 0, and where in the revolution it is."""
    turn = int(np.floor(psi / (2.0 * np.pi)))
    rest = psi - turn * 2.0 * np.pi
    cells = table.shape[0]
    cell = min(max(int(rest / (2.0 * np.pi) * cells), 0), cells - 1)
    i = table[cell]
    last = grid.shape[0] - 2
    while i < last and grid[i + 1] <= rest:
        i += 1
    return turn * (last + 1) + i, i, rest


@njit(cache=True)
def _relative_at(psi, grid, table, omega, u, v, out):
    """Displacement at the earlier spindle angle ``psi``, by cubic Hermite interpolation."""
    if psi <= 0.0:
        out[:] = 0.0
        return
    n, i, rest = _locate(psi, grid, table)
    width = grid[i + 1] - grid[i]
    s = (rest - grid[i]) / width
    dt = width / omega
    b = s * s * (3.0 - 2.0 * s)
    a = 1.0 - b
    c = s * (1.0 - s) * (1.0 - s) * dt
    d = -s * s * (1.0 - s) * dt
    for axis in range(3):
        out[axis] = a * u[n, axis] + b * u[n + 1, axis] + c * v[n, axis] + d * v[n + 1, axis]


@njit(cache=True)
def _forces(
    psi, side, now, speed, tooth_angle, slope, runout, arc, law, motion, slices, passes,
    same_helix, grid, table, u, v, tau, shift, offset, force,
):  # fmt: skip
    """Force on the tool at spindle angle ``psi``, displacement ``now``, velocity ``speed``."""
    omega, radius, depth, feed_speed = motion[0], motion[1], motion[2], motion[3]
    ktc, krc, kac, kte, kre, kae = law[0], law[1], law[2], law[3], law[4], law[5]
    h0, exponent, damping, friction = law[6], law[7], law[8], law[9]
    e, lam, follows = runout[0], runout[1], runout[2]
    teeth = tooth_angle.shape[0]
    dz = depth / slices
    force[:] = 0.0
    delayed = np.empty(3)
    for j in range(teeth):
        filled = False
        for s in range(slices):
            top = psi + side + tooth_angle[j] - s * dz * slope[j]
            low = top - dz * slope[j]
            if low > top:
                low, top = top, low
            turn = np.floor((top - arc[0]) / (2.0 * np.pi)) * 2.0 * np.pi
            if top == low:
                begin, end = low, top
                fraction = 1.0 if top - turn < arc[1] else 0.0
            else:  # the slice is far shorter than a turn, so one or two arcs can meet it
                begin, end = max(low, arc[0] + turn), min(top, arc[1] + turn)
                fraction = (end - begin) / (top - low)
                if fraction <= 0.0:
                    turn -= 2.0 * np.pi
                    begin, end = max(low, arc[0] + turn), min(top, arc[1] + turn)
                    fraction = (end - begin) / (top - low)
            if fraction <= 0.0:
                continue
            phi = 0.5 * (begin + end)
            z = (s + 0.5) * dz
            if slope[j] != 0.0:
                z = (psi + side + tooth_angle[j] - phi) / slope[j]
            sine, cosine = np.sin(phi), np.cos(phi)
            if not (same_helix and filled):
                for k in range(1, passes + 1):
                    m = (j + k) % teeth
                    turns = (j + k) // teeth
                    behind = tooth_angle[m] - tooth_angle[j] + turns * 2.0 * np.pi
                    behind -= z * (slope[m] - slope[j])
                    tau[k] = behind / omega
                    _relative_at(psi - behind, grid, table, omega, u, v, delayed)
                    shift[k, 0] = feed_speed * tau[k] + now[0] - delayed[0]
                    shift[k, 1] = now[1] - delayed[1]
                    offset[k] = 0.0
                    if m != j:
                        mine = lam - tooth_angle[j] + follows * z * slope[j]
                        other = lam - tooth_angle[m] + follows * z * slope[m]
                        offset[k] = e * (np.cos(mine) - np.cos(other))
                filled = True
            h = np.inf
            for k in range(1, passes + 1):
                gap = offset[k]
                if follows != 0.0 and k % teeth != 0:
                    m = (j + k) % teeth
                    mine = lam - tooth_angle[j] + z * slope[j]
                    other = lam - tooth_angle[m] + z * slope[m]
                    gap = e * (np.cos(mine) - np.cos(other))
                h = min(h, shift[k, 0] * sine + shift[k, 1] * cosine + gap)
            if h <= 0.0:
                continue
            effective = h if exponent == 1.0 else h0 * (h / h0) ** exponent
            plough = damping / (omega * radius) * (speed[0] * sine + speed[1] * cosine)
            ft = ktc * effective + kte + friction * plough
            fr = krc * effective + kre + plough
            fa = kac * effective + kae
            width = dz * fraction
            force[0] += width * (-ft * cosine - fr * sine)
            force[1] += width * (ft * sine - fr * cosine)
            force[2] += width * fa


@njit(cache=True)
def _relative(q, w, direction, now, speed):
    now[:] = 0.0
    speed[:] = 0.0
    for i in range(direction.shape[0]):
        for axis in range(3):
            now[axis] += direction[i, axis] * q[i]
            speed[axis] += direction[i, axis] * w[i]


@njit(cache=True)
def _integrate(
    revolutions, grid, table, natural, damping, mass, direction, tooth_angle, slope, runout, arc,
    law, motion, slices, passes, same_helix, u, v, q, w,
):  # fmt: skip
    """Classical Runge-Kutta over all steps; fills the histories of u, u' (n x 3) and q, q'."""
    steps = grid.shape[0] - 1
    modes = natural.shape[0]
    tau, offset = np.empty(passes + 1), np.empty(passes + 1)
    shift = np.empty((passes + 1, 2))
    now, speed, force = np.empty(3), np.empty(3), np.empty(3)
    a, b = np.empty(modes), np.empty(modes)
    rate_q, rate_w = np.empty((4, modes)), np.empty((4, modes))
    for n in range(revolutions * steps):
        turn, i = n // steps, n % steps
        start = turn * 2.0 * np.pi + grid[i]
        width = grid[i + 1] - grid[i]
        dt = width / motion[0]
        for stage in range(4):
            part = 0.0 if stage == 0 else (1.0 if stage == 3 else 0.5)
            side = NUDGE if stage == 0 else (-NUDGE if stage == 3 else 0.0)
            for m in range(modes):
                a[m], b[m] = q[n, m], w[n, m]
                if stage > 0:
                    a[m] += part * dt * rate_q[stage - 1, m]
                    b[m] += part * dt * rate_w[stage - 1, m]
            _relative(a, b, direction, now, speed)
            _forces(
                start + part * width, side, now, speed, tooth_angle, slope, runout, arc, law,
                motion, slices, passes, same_helix, grid, table, u, v, tau, shift, offset, force,
            )  # fmt: skip
            for m in range(modes):
                push = 0.0
                for axis in range(3):
                    push += direction[m, axis] * force[axis]
                rate_q[stage, m] = b[m]
                rate_w[stage, m] = (
                    push / mass[m]
                    - 2.0 * damping[m] * natural[m] * b[m]
                    - natural[m] * natural[m] * a[m]
                )
        for m in range(modes):
            q[n + 1, m] = q[n, m] + dt / 6.0 * (
                rate_q[0, m] + 2.0 * rate_q[1, m] + 2.0 * rate_q[2, m] + rate_q[3, m]
            )
            w[n + 1, m] = w[n, m] + dt / 6.0 * (
                rate_w[0, m] + 2.0 * rate_w[1, m] + 2.0 * rate_w[2, m] + rate_w[3, m]
            )
        _relative(q[n + 1], w[n + 1], direction, u[n + 1], v[n + 1])


@njit(cache=True)
def _sample(
    angles, limit, grid, table, direction, sides, tooth_angle, slope, runout, arc, law, motion,
    slices, passes, same_helix, u, v, q, w, forces, tool, work,
):  # fmt: skip
    """Interpolates the histories at spindle angles ``angles``, evaluates the forces there."""
    modes = direction.shape[0]
    tau, offset = np.empty(passes + 1), np.empty(passes + 1)
    shift = np.empty((passes + 1, 2))
    now, speed = np.empty(3), np.empty(3)
    for row in range(angles.shape[0]):
        n, i, rest = _locate(angles[row], grid, table)
        width = grid[i + 1] - grid[i]
        s = (rest - grid[i]) / width
        if n >= limit:
            n, s = limit - 1, 1.0
        dt = width / motion[0]
        now[:] = 0.0
        speed[:] = 0.0
        for m in range(modes):
            b = s * s * (3.0 - 2.0 * s)
            value = (1.0 - b) * q[n, m] + b * q[n + 1, m]
            value += dt * s * (1.0 - s) * ((1.0 - s) * w[n, m] - s * w[n + 1, m])
            rate = 6.0 * s * (1.0 - s) * (q[n + 1, m] - q[n, m]) / dt
            rate += (1.0 - s) * (1.0 - 3.0 * s) * w[n, m] + s * (3.0 * s - 2.0) * w[n + 1, m]
            for axis in range(3):
                now[axis] += direction[m, axis] * value
                speed[axis] += direction[m, axis] * rate
                if sides[m]:
                    tool[row, axis] += direction[m, axis] * value
                else:
                    work[row, axis] += direction[m, axis] * value
        _forces(
            angles[row], NUDGE, now, speed, tooth_angle, slope, runout, arc, law, motion, slices,
            passes, same_helix, grid, table, u, v, tau, shift, offset, forces[row],
        )  # fmt: skip


def _angle_grid(cut: ReferenceCut, steps: int, tooth_angle: np.ndarray, slope: np.ndarray):
    """Angles of the steps in a revolution; for each of ``steps`` cells, a step not after it."""
    events = [
        arc - angle + z * lag
        for arc in cut.arc
        for angle, lag in zip(tooth_angle, slope, strict=True)
        for z in (0.0, cut.axial_depth)
    ]
    grid = np.arange(steps) / steps * TWO_PI
    close = 1e-3 * TWO_PI / steps
    for event in np.mod(events, TWO_PI):
        nearest = np.argmin(np.abs(grid - event))
        if abs(grid[nearest] - event) > 1e-9 and TWO_PI - event > 1e-9:
            if nearest > 0 and abs(grid[nearest] - event) < close:
                grid[nearest] = event  # no sliver of a step
            else:
                grid = np.sort(np.append(grid, event))
    grid = np.append(grid, TWO_PI)
    cells = np.arange(steps) / steps * TWO_PI
    table = np.clip(np.searchsorted(grid, cells, side="right") - 2, 0, len(grid) - 2)
    return grid, table


def suggested_steps(cut: ReferenceCut, per_period: int = 80, least: int = 2000) -> int:
    """Steps a revolution that resolve the fastest mode by ``per_period`` steps a period."""
    fastest = max((mode.frequency for mode in cut.modes), default=0.0)
    return max(least, int(np.ceil(per_period * fastest * cut.period)))


def simulate_at(
    cut: ReferenceCut, times: np.ndarray, steps_per_revolution: int, slices: int
) -> ReferenceRecord:
    """Integrates the cut from rest at t = 0 and returns the signals at ``times`` (s, >= 0)."""
    times = np.ascontiguousarray(times, dtype=float)
    teeth = cut.teeth
    if len(cut.helix) != teeth or abs(sum(cut.pitch) - TWO_PI) > 1e-9:
        raise ValueError("one helix angle a tooth, and pitch angles that add up to 2 pi")
    tooth_angle = np.concatenate([[0.0], np.cumsum(cut.pitch)[:-1]])
    slope = np.tan(np.array(cut.helix, dtype=float)) / cut.radius
    grid, table = _angle_grid(cut, steps_per_revolution, tooth_angle, slope)
    steps = len(grid) - 1
    angles = times * cut.spindle_speed
    revolutions = max(1, int(np.ceil(angles.max() / TWO_PI - 1e-9)))
    count = revolutions * steps
    passes = cut.passes or teeth
    same_helix = bool(np.all(slope == slope[0]))
    shortest = min(cut.pitch) - cut.axial_depth * float(np.ptp(slope))
    if shortest <= 2.0 * TWO_PI / steps_per_revolution:
        raise ValueError("two edges nearly meet: the delay is shorter than two steps")
    natural = TWO_PI * np.array([mode.frequency for mode in cut.modes], dtype=float)
    damping = np.array([mode.damping for mode in cut.modes], dtype=float)
    mass = np.array([mode.mass for mode in cut.modes], dtype=float)
    direction = np.array([mode.direction for mode in cut.modes], dtype=float).reshape(-1, 3)
    sides = np.array([mode.side == "tool" for mode in cut.modes], dtype=bool)
    feed_speed = teeth * cut.feed_per_tooth * cut.spindle_speed / TWO_PI
    runout = np.array([cut.runout_offset, cut.runout_angle, float(cut.runout_follows_helix)])
    exponent = 1.0 if cut.exponent is None else cut.exponent
    law = np.array([cut.Ktc, cut.Krc, cut.Kac, cut.Kte, cut.Kre, cut.Kae, cut.h0, exponent,
                    cut.damping_coefficient, cut.damping_friction])  # fmt: skip
    motion = np.array([cut.spindle_speed, cut.radius, cut.axial_depth, feed_speed])
    u, v = np.zeros((count + 1, 3)), np.zeros((count + 1, 3))
    q, w = np.zeros((count + 1, len(natural))), np.zeros((count + 1, len(natural)))
    edge = (tooth_angle, slope, runout, np.array(cut.arc), law, motion, slices, passes, same_helix)
    _integrate(revolutions, grid, table, natural, damping, mass, direction, *edge, u, v, q, w)
    forces, tool, work = (np.zeros((len(times), 3)) for _ in range(3))
    _sample(angles, count, grid, table, direction, sides, *edge, u, v, q, w, forces, tool, work)
    relative = tool + work
    return ReferenceRecord(times, angles, *forces.T, *relative.T, tool, work)


def simulate(
    case: ReferenceCut,
    revolutions: float,
    samples_per_revolution: int,
    steps_per_revolution: int,
    slices: int,
    phase: float = 0.0,
) -> ReferenceRecord:
    """Signals at t = 0, T/samples, ... up to, but not including, ``revolutions`` T.

    ``phase`` moves all samples by this part of the sample interval.  With a straight edge, edge
    forces and no phase, samples fall on the very entry into an up-milling cut or slot, where the
    chip thickness is zero but for rounding, and the force there says nothing.
    """
    count = round(revolutions * samples_per_revolution)
    times = (np.arange(count) + phase) * (case.period / samples_per_revolution)
    return simulate_at(case, times, steps_per_revolution, slices)


def nrmse(signal: np.ndarray, reference: np.ndarray) -> float:
    """Root mean square of the difference over that of the reference."""
    scale = float(np.sqrt(np.mean(np.square(reference))))
    return float(np.sqrt(np.mean(np.square(signal - reference)))) / scale if scale else 0.0


def restlessness(record: ReferenceRecord, revolutions: int) -> tuple[float, float]:
    """How much a revolution differs from the one before, early and late in the cut.

    Root mean square of the difference of displacement over that of the displacement's alternating
    part in the last revolution.  Late well below early means stable; late not below, chatter (or a
    mode too slow for the time).
    """
    turns = np.stack([record.x, record.y], axis=-1).reshape(revolutions, -1, 2)
    change = np.sqrt(np.mean(np.square(np.diff(turns, axis=0)), axis=(1, 2)))
    size = float(np.std(turns[-1] - turns[-1].mean(axis=0)))
    third = max(1, len(change) // 3)
    return float(change[:third].mean()) / size, float(change[-third:].mean()) / size


def random_cut(rng: np.random.Generator) -> ReferenceCut:
    """A random but plausible cut; most are stable, about a fifth chatter (see ``restlessness``)."""
    teeth = int(rng.integers(2, 7))
    radius = rng.uniform(3e-3, 16e-3)
    helix = rng.choice([0.0, rng.uniform(5.0, 45.0), rng.uniform(20.0, 45.0)], p=[0.15, 0.35, 0.5])
    pitch = np.full(teeth, TWO_PI / teeth)
    if rng.random() < 1 / 3:
        pitch = pitch * (1.0 + rng.uniform(-0.12, 0.12, teeth))
        pitch *= TWO_PI / pitch.sum()
    offset = rng.uniform(2e-6, 20e-6) if rng.random() < 0.5 else 0.0
    speed = float(np.exp(rng.uniform(np.log(800.0), np.log(15000.0)))) * TWO_PI / 60.0
    feed = rng.uniform(0.03e-3, 0.25e-3)
    mode = str(rng.choice(["up", "down", "slot"], p=[0.4, 0.4, 0.2]))
    radial = 2.0 * radius if mode == "slot" else radius * rng.uniform(0.1, 1.8)
    modes = []
    number = int(rng.integers(1, 5))
    angles = [0.0, 0.5 * np.pi]
    rng.shuffle(angles)
    for i in range(number):
        angle = angles[i % 2]
        if rng.random() < 0.3:
            angle = rng.uniform(0.0, np.pi)
        frequency = float(np.exp(rng.uniform(np.log(80.0), np.log(3000.0))))
        stiffness = float(np.exp(rng.uniform(np.log(1e7), np.log(1e8))))
        direction = (float(np.cos(angle)), float(np.sin(angle)), 0.0)
        side = "workpiece" if rng.random() < 0.25 else "tool"
        mass = stiffness / (TWO_PI * frequency) ** 2
        modes.append(ReferenceMode(frequency, rng.uniform(0.01, 0.05), mass, direction, side))
    ktc = rng.uniform(600e6, 2200e6)
    krc = ktc * rng.uniform(0.15, 0.6)
    kac = ktc * rng.uniform(0.05, 0.25)
    kte, kre, kae = rng.uniform(5e3, 45e3), rng.uniform(5e3, 50e3), rng.uniform(0.0, 5e3)
    exponent, h0 = (None, 1e-4)
    if rng.random() < 1 / 3:
        exponent, h0 = rng.uniform(0.65, 0.95), float(rng.choice([1e-4, 1e-3]))
        if h0 == 1e-3:  # the same force at 0.1 mm
            ktc, krc, kac = (k * 10.0 ** -(1.0 - exponent) for k in (ktc, krc, kac))
    ploughing = rng.uniform(2e4, 3e5) if rng.random() < 1 / 3 else 0.0
    friction = rng.uniform(0.0, 0.5) if ploughing else 0.0
    cut = ReferenceCut(
        radius, tuple(map(float, pitch)), (float(np.radians(helix)),) * teeth, tuple(modes), speed,
        feed, 1e-3, radial, mode, ktc, krc, kac, kte, kre, kae, h0, exponent, offset,
        rng.uniform(0.0, TWO_PI) if offset else 0.0, ploughing, friction,
    )  # fmt: skip
    limit = averaged_limit(cut)
    depth = float(np.clip(limit * rng.uniform(0.2, 1.3), 0.05e-3, min(2.0 * radius, 12e-3)))
    return replace(cut, axial_depth=depth)


def averaged_limit(cut: ReferenceCut) -> float:
    """Depth at the limit of stability with the directional matrix averaged over the revolution.

    An estimate to draw depths by, not a reference: equal pitch, no helix, no process damping.  With
    dF = b D du averaged, 1 = b (1 - exp(-i w T)) lambda for an eigenvalue lambda of G(iw) D, so
    that b = 1/(2 Re lambda), where the phase fits.
    """
    exponent = 1.0 if cut.exponent is None else cut.exponent
    secant = exponent * (0.5 * cut.feed_per_tooth / cut.h0) ** (exponent - 1.0)
    phi = np.linspace(*cut.arc, 401)
    sine, cosine = np.sin(phi), np.cos(phi)
    ktc, krc = cut.Ktc * secant, cut.Krc * secant
    pull = np.array([-ktc * cosine - krc * sine, ktc * sine - krc * cosine])
    mean = pull @ np.array([sine, cosine]).T / len(phi) * (cut.arc[1] - cut.arc[0])
    mean *= cut.teeth / TWO_PI
    frequencies = np.array([mode.frequency for mode in cut.modes])
    w = TWO_PI * np.geomspace(0.7 * frequencies.min(), 1.6 * frequencies.max(), 20000)
    response = np.zeros((len(w), 2, 2), dtype=complex)
    for mode in cut.modes:
        d = np.array(mode.direction[:2])
        natural = TWO_PI * mode.frequency
        dynamic = mode.mass * (natural**2 - w**2 + 2j * mode.damping * natural * w)
        response += np.outer(d, d) / dynamic[:, None, None]
    limit = np.inf
    for root in np.sort_complex(np.linalg.eigvals(response @ mean)).T:
        with np.errstate(divide="ignore", invalid="ignore"):
            depth = 0.5 / root.real
            error = np.angle((1.0 - 1.0 / (depth * root)) * np.exp(1j * w * cut.period / cut.teeth))
        fits = (root.real[1:] > 0) & (root.real[:-1] > 0) & (error[1:] * error[:-1] <= 0)
        fits &= np.abs(error[1:] - error[:-1]) < 1.0
        limit = min(limit, depth[1:][fits].min(initial=np.inf))
    return limit


def to_case_dict(cut: ReferenceCut, title: str = "reference cut") -> dict:
    """The cut as a case-file dictionary (DESIGN.md, "Case file")."""

    def degrees(values):
        return [f"{float(np.degrees(value))!r} deg" for value in values]

    tool: dict = {
        "kind": "end mill",
        "teeth": cut.teeth,
        "diameter": f"{float(2e3 * cut.radius)!r} mm",
    }
    helix = degrees(cut.helix)
    tool["helix"] = helix[0] if len(set(helix)) == 1 else helix
    if np.ptp(cut.pitch) > 1e-12:
        tool["pitch"] = degrees(cut.pitch)
    if cut.runout_offset:
        angle = degrees([cut.runout_angle])[0]
        tool["runout"] = {"offset": f"{float(1e6 * cut.runout_offset)!r} um", "angle": angle}
    material: dict = {"law": "linear" if cut.exponent is None else "exponential"}
    for name in ("Ktc", "Krc", "Kac", "Kte", "Kre", "Kae"):
        material[name] = float(getattr(cut, name))
    if cut.exponent is not None:
        material |= {"h0": float(cut.h0), "exponent": float(cut.exponent)}
    case = {
        "title": title,
        "tool": tool,
        "material": material,
        "cut": {
            "mode": cut.mode,
            "spindle_speed": f"{float(cut.spindle_speed * 60.0 / TWO_PI)!r} rpm",
            "feed_per_tooth": float(cut.feed_per_tooth),
            "axial_depth": float(cut.axial_depth),
            "radial_depth": float(cut.radial_depth),
        },
        "structure": {
            "mode": [
                {
                    "frequency": f"{float(mode.frequency)!r} Hz",
                    "damping": float(mode.damping),
                    "mass": float(mode.mass),
                    "direction": [float(value) for value in mode.direction],
                    "side": mode.side,
                }
                for mode in cut.modes
            ]
        },
    }
    if cut.damping_coefficient:
        case["process_damping"] = {
            "coefficient": float(cut.damping_coefficient),
            "friction": float(cut.damping_friction),
        }
    return case
