"""Rigid cut along the true paths of the edges, as a carved workpiece meets it.

At every node of the edge the ray inwards along its radius ends where an earlier tooth, on its own
trochoid, has been, or where the stock ends. No slice, layer or dexel of the packages takes part.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from benchmarks.contradictions.edge_quadrature import Array, RigidCut
from chatter.description.case import Case

_REVOLUTION = 2.0 * math.pi
#: the moment of the earlier pass is found by so many corrections, each smaller by feed over radius
_CORRECTIONS = 3
#: edges are looked at a little beyond where they can reach the stock
_BEYOND = 1.05


class TrochoidCut(RigidCut):
    """Cut of a tool whose edges go along trochoids through a half-plane of stock."""

    def __init__(self, case: Case) -> None:
        super().__init__(case)
        #: (N, n), m
        self.reach = self.nodes.radius + self.offset / np.sin(self.nodes.immersion)
        #: edge of the stock along the normal, seen from the side at which it lies, m
        self.wall = -math.inf if case.cut.mode == "slot" else self.radius - case.cut.radial_depth
        early = _BEYOND * self.feed / (2.0 * self.reach.min(axis=0))
        widest = self.reach.max(axis=0)
        arc = np.full_like(widest, math.pi)
        if case.cut.mode != "slot":
            arc = np.arccos(np.clip(self.wall / widest, -1.0, 1.0))
        if case.cut.mode == "up":
            self.entry, self.exit = -early * (arc > 0.0), np.minimum(arc, math.pi + early)
        elif case.cut.mode == "down":
            self.entry = np.maximum(math.pi - arc, -early)
            self.exit = math.pi + early * (arc > 0.0)
        else:
            self.entry, self.exit = -early, math.pi + early

    def _chip(self, tooth: int, node: NDArray[np.intp], phi: Array) -> Array:
        """Material along the radius inwards of the edge, normal to it, m."""
        own = self.reach[tooth][node]
        s, c = np.sin(phi), np.cos(phi)
        left = np.full(phi.shape, -np.inf)
        for other in range(len(self.tooth_angle)):
            since = np.mod(self.angle[other] - self.angle[tooth], _REVOLUTION)[node]
            if other == tooth:
                since = np.full_like(since, _REVOLUTION)
            left = np.maximum(left, self._surface(self.reach[other][node], since, phi, s, c))
        if self.case.cut.mode != "slot":
            side = c if self.case.cut.mode == "up" else -c
            if self.wall > 0.0:
                left = np.maximum(left, self.wall / np.maximum(side, 1e-12))
            else:
                left = np.where(own * side < self.wall, np.inf, left)
        return (own - left) * np.sin(self.nodes.immersion[node])

    def _surface(self, reach: Array, since: Array, phi: Array, s: Array, c: Array) -> Array:
        """Distance from the axis now at which an earlier tooth has passed along a ray, m."""
        turned = since
        for _ in range(_CORRECTIONS):
            way = self.feed * turned / _REVOLUTION
            # at a tip of less radius than the feed a ray may pass beside the earlier circle
            distance = np.sqrt(np.maximum(reach**2 - (way * c) ** 2, 0.0)) - way * s
            then = np.arctan2(distance * s + way, distance * c)
            turned = since + np.mod(phi - then + math.pi, _REVOLUTION) - math.pi
        return distance
