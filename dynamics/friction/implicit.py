"""Friction force held over a step, solved together with the response of the structure.

Over a step the structure, stepped exactly under a held force F, moves its port by
dx = dx_free - gx F and ends at v1 = v_free - g F. The work taken out of it is then F dx, whatever
happens within the step. A law that answers a motion d by a force F(d) with F d >= change of its
stored energy can therefore not create energy if it is solved at d = dx (mean form). If the law is
stiffer than the step resolves, that form stops the port with v1 = -v0, and the velocity rings
from step to step; the law is then solved at d = (1-s) dx + s h v1, which brings it to rest, with
s from 0 (resolved) to 1 (rigid), or less if that would create energy.
"""

import math

from dynamics.leaves import leaf

#: halvings that end any search; few are needed
_ITERATIONS = 100
_ROUNDING = 1e-15
#: tried from the stiffness down; the first fails where a mode turns far within the step
_SHARES = 4
#: tries by contraction, and the factor by which each must close in
_CONTRACTIONS, _CLOSING = 5, 0.1


@leaf
def no_force(law, i):  # noqa: ARG001
    """Force at no motion of a law without memory."""
    return 0.0


@leaf
def no_energy(law, i, motion, h):  # noqa: ARG001
    """Change of the stored energy of a law that stores none, J."""
    return 0.0


@leaf
def implicit_force(rest, opposing, stored, law, i, stiffness, dx_free, gx, v_free, g, h):
    """Force held over the step, N, against positive motion, and motion of the law, m.

    By that motion the law is to be advanced. Functions of the law, with row i of its table:
    `rest(law, i)` force at no motion; `opposing(law, i, sign, way, h)` mean force against a motion
    by way > 0 (or = 0, the limit) along sign; `stored(law, i, motion, h)` change of the stored
    energy, J. The stiffness is the largest slope of the force over motion, N/m; infinite for dry
    friction. Without friction the displacement increment is dx_free, m, its decrease per force gx,
    m/N, >= 0; the end velocity v_free, m/s, and its decrease per force g, m/(N s). The latter is
    below 0 if a mode turns by more than half a cycle in a step h, s; the mean form is then kept.
    """
    force, motion = _solve(rest, opposing, law, i, dx_free, gx, h)
    end = v_free - g * force
    if gx == 0.0 or g <= 0.0 or end * motion > 0.0 or end == 0.0:
        return force, motion
    share = 1.0 if math.isinf(stiffness) else gx * stiffness / (1.0 + gx * stiffness)
    for _ in range(_SHARES):
        free = (1.0 - share) * dx_free + share * h * v_free
        compliance = (1.0 - share) * gx + share * h * g
        stopping, short = _solve(rest, opposing, law, i, free, compliance, h)
        work = stopping * (dx_free - gx * stopping)
        noise = _ROUNDING * abs(stopping) * (abs(dx_free) + gx * abs(stopping))
        if work >= stored(law, i, short, h) - noise:
            return stopping, short
        share *= 0.5
    return force, motion


@leaf
def _solve(rest, opposing, law, i, free, compliance, h):
    """Force and motion d with d = free - compliance F(d)."""
    at_rest = rest(law, i)
    drive = free - compliance * at_rest
    sign = 1.0 if drive >= 0.0 else -1.0
    # the force is never less than the elastic pull at the start, or none
    high = sign * free - compliance * min(sign * at_rest, 0.0)
    if compliance == 0.0 and high > 0.0:
        return sign * opposing(law, i, sign, high, h), free
    if high <= 0.0:
        return at_rest, 0.0
    guess = min(max(sign * law.rate[i] * h, 0.0), high)
    travel = _travel(opposing, law, i, sign, h, sign * free, compliance, high, guess)
    if travel == 0.0:
        return free / compliance, 0.0
    return sign * opposing(law, i, sign, travel, h), sign * travel


@leaf
def _travel(opposing, law, i, sign, h, free, compliance, high, guess):
    """Root of way - free + compliance opposing(way) in [0, high], that next to the guess.

    A falling force over speed has several roots if the step is coarse; the one that continues
    the motion is taken. 0 is a root also if rest can be held.
    """
    travel = _contracted(opposing, law, i, sign, h, free, compliance, high, guess)
    if travel > 0.0:
        return travel
    low, f_low, top, f_top = 0.0, -1.0, high, 1.0
    if guess > 0.0:
        f = guess - free + compliance * opposing(law, i, sign, guess, h)
        if f == 0.0:
            return guess
        near = min(max(guess - 1.5 * f, 0.0), high)
        fn = near - free + compliance * opposing(law, i, sign, near, h)
        if f < 0.0 < fn:
            return _root(opposing, law, i, sign, h, free, compliance, guess, f, near, fn)
        if fn < 0.0 < f:
            return _root(opposing, law, i, sign, h, free, compliance, near, fn, guess, f)
        if f < 0.0:
            low, f_low = guess, f
        else:
            top, f_top = guess, f
    if low == 0.0:
        f_low = compliance * opposing(law, i, sign, 0.0, h) - free
        if f_low >= 0.0:
            return 0.0
    if top == high:
        f_top = high - free + compliance * opposing(law, i, sign, high, h)
        if f_top <= 0.0:
            return high
    return _root(opposing, law, i, sign, h, free, compliance, low, f_low, top, f_top)


@leaf
def _contracted(opposing, law, i, sign, h, free, compliance, high, guess):
    """Root by putting the way in again and again, or 0 where that does not close in at once.

    A law much softer than the step's compliance closes in by orders of magnitude each time.
    """
    travel, last = guess, high
    for _ in range(_CONTRACTIONS):
        following = free - compliance * opposing(law, i, sign, travel, h)
        change = abs(following - travel)
        if not 0.0 < following <= high or change > _CLOSING * last:
            break
        # the next change would be smaller by as much as this one is than the last
        if change * change <= 2.0 * _ROUNDING * following * last:
            return following
        travel, last = following, change
    return 0.0


@leaf
def _root(opposing, law, i, sign, h, free, compliance, a, fa, b, fb):
    """Root between fa < 0 < fb (Chandrupatla 1997, Adv. Eng. Software 28:145, eqs. 1-4)."""
    c, fc = a, fa
    noise = 0.4 * _ROUNDING * abs(free)
    part = min(max(fa / (fa - fb), 1e-3), 0.999)
    for _ in range(_ITERATIONS):
        x = a + part * (b - a)
        f = x - free + compliance * opposing(law, i, sign, x, h)
        if (f > 0.0) == (fa > 0.0):
            c, fc = a, fa
        else:
            c, fc, b, fb = b, fb, a, fa
        a, fa = x, f
        best = a if abs(fa) < abs(fb) else b
        width = abs(b - a)
        least = _ROUNDING * abs(best)
        if abs(f) <= noise or width <= 2.0 * least:
            break
        part = 0.5
        xi = (a - b) / (c - b)
        phi = (fa - fb) / (fc - fb)
        if phi * phi < xi and (1.0 - phi) * (1.0 - phi) < 1.0 - xi:
            part = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (
                fc - fb
            )
        edge = least / width
        part = min(max(part, edge), 1.0 - edge)
    return a if abs(fa) < abs(fb) else b
