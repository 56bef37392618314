#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Gas between two parallel diffuse walls and two open ends, by the equation of Bhatnagar, Gross and Krook in two dimensions.

    c . grad f = nu (n + 2 c . j + t (c^2 - 3/2) - f),   f times a Maxwellian; heights and sqrt(2 k T / m) are 1,

linear in the flow j and in the excess t of pressure by temperature; nu is delta times the local density. Nothing is drawn: n, j
and t at the nodes of a grid, and what the walls send back, are one linear system. Each is an integral over all rays that reach
its place (Gauss points on the four sides and along each ray); that over the speeds is T_k(s) = int_0^inf c^k exp(-c^2 - s/c) dc.
Run as a program it prints how well it meets known limits."""
import math

import numpy as np

FAR = 25.0  # mean free paths, beyond which less than 1e-6 is left
ROOT = np.linspace(0.0, math.sqrt(FAR), 8001)  # of s, where T_k is tabulated


def table():
    c, step = np.linspace(-16.0, 2.0, 1441, retstep=True)
    c = np.exp(c)
    left = step * c * np.exp(-c**2 - ROOT[:, None]**2 / c)
    return [(c**k * left).sum(axis=1) for k in range(6)]


TABLE = table()
# Sources and moments are sums of factor(direction) * (speed in the plane)^power, and a multiple of c_z^2 - 1/2.
SOURCES = {"n": lambda x, y: ([(1, 0)], 0), "jx": lambda x, y: ([(2 * x, 1)], 0), "jy": lambda x, y: ([(2 * y, 1)], 0),
           "t": lambda x, y: ([(1, 2), (-1, 0)], 1)}
MOMENTS = {"n": lambda x, y: ([(1, 0)], 0), "jx": lambda x, y: ([(x, 1)], 0), "jy": lambda x, y: ([(y, 1)], 0),
           "t": lambda x, y: ([(2 / 3, 2), (-2 / 3, 0)], 2 / 3),
           "wall": lambda x, y: ([(2 * math.sqrt(math.pi) * abs(y), 1)], 0),  # what a wall sends back
           "across": lambda x, y: ([(y * y, 2), (-0.5, 0)], 1)}  # t of the motion along an end
FIELDS = ("n", "jx", "jy", "t")


def tables(depth):
    """T_0 to T_5 of depths."""
    at = np.sqrt(np.minimum(depth, FAR)) * ((len(ROOT) - 1) / ROOT[-1])
    left = np.minimum(at.astype(np.int64), len(ROOT) - 2)
    share, near = at - left, depth < FAR
    return [((1 - share) * one[left] + share * one[left + 1]) * near for one in TABLE]


def kernel(moment, source, direction, t, lift):
    """Of what a source adds to a moment, over all speeds: `t` are the tables of the depths between; `lift`: 1 for molecules that
    begin at the boundary, 0 for inside."""
    (to, to_z), (of, of_z) = MOMENTS[moment](*direction), SOURCES[source](*direction)
    parts = [a * b * t[k + m + lift] for a, k in to for b, m in of]
    return sum(parts) + (0.5 * to_z * of_z * t[lift] if to_z * of_z else 0)


def along_side(start, end, foot, away, points):
    """Gauss points of a side, and the angles they cover seen from a point `away` from it whose foot is `foot`: even in the
    logarithm of the distance where that is large."""
    low, high = np.arcsinh((start - foot) / away), np.arcsinh((end - foot) / away)
    cuts = [low, 0.0, high]
    t = np.concatenate([a + (b - a) * points[0] for a, b in zip(cuts, cuts[1:])])
    w = np.concatenate([(b - a) * points[1] for a, b in zip(cuts, cuts[1:])])
    return foot + away * np.sinh(t), w / np.cosh(t)


def lagrange(nodes, x):
    """Weights of the polynomial through all nodes: points x nodes."""
    return np.stack([np.prod([(x - b) / (a - b) for b in nodes if b != a], axis=0) for a in nodes], axis=1)


class Channel:
    """`along` times `across` nodes, closer at the ends and the walls. `cell`: how near to the last end the motion along it is
    taken."""
    RAYS, PLACES = 16, 24  # Gauss points of half a side, and of a ray

    def __init__(self, length, delta, along=64, across=8, cell=0.125):
        self.length, self.delta, self.cell = length, delta, cell
        (self.y, self.wy), self.side, (q, wq) = [(0.5 * (1 + x), 0.5 * w) for x, w in map(np.polynomial.legendre.leggauss,
                                                                                        (across, self.RAYS, self.PLACES))]
        self.s, self.ws = q * q, 2 * q * wq  # along a ray
        z = (np.arange(along) + 0.5) / along
        self.x = length * (0.8 * z * z * (3 - 2 * z) + 0.2 * z)
        self.density = np.ones_like  # of places x

    def shares(self, x):
        """The node on the left of each place, and the share of the next one."""
        left = np.clip(np.searchsorted(self.x, x) - 1, 0, len(self.x) - 2)
        return left, (x - self.x[left]) / (self.x[left + 1] - self.x[left])

    def onto_nodes(self, x, values):
        left, share = self.shares(x)
        return np.bincount(left, values * (1 - share), len(self.x)) + np.bincount(left + 1, values * share, len(self.x))

    def depth(self, start, end, way):
        """Mean free paths, by Simpson."""
        return self.delta * way * (self.density(start) + 4 * self.density((start + end) / 2) + self.density(end)) / 6

    def rays(self, x, y):
        """All rays that reach a point: where they begin, the angles they cover, and the side (0, 1: walls; 2, 3: ends)."""
        parts = []
        for side, at in ((0, 0.0), (1, 1.0)):
            if y != at:
                places, angle = along_side(0.0, self.length, x, abs(y - at), self.side)
                parts.append((places, np.full_like(places, at), angle, np.full(len(places), side)))
        for side, at in ((2, 0.0), (3, self.length)):
            places, angle = along_side(0.0, 1.0, y, abs(x - at), self.side)
            parts.append((np.full_like(places, at), places, angle, np.full(len(places), side)))
        return map(np.concatenate, zip(*parts))

    def row(self, x, y, moments):
        """Coefficients of moments at a point: of all unknowns, and of four kinds of gas that enter: with density 1 at the first
        end, at the last; with flow 1 at both; warmer at the last."""
        nx, ny = len(self.x), len(self.y)
        bx, by, angle, side = self.rays(x, y)
        far = np.hypot(x - bx, y - by)
        ex, ey = (x - bx) / far, (y - by) / far
        thin = max(self.delta * self.density(np.array([0.0, self.length])).min(), 1e-9)
        reach = np.minimum(far, FAR / thin)
        s = reach[:, None] * self.s
        px, py = x - ex[:, None] * s, y - ey[:, None] * s
        depths = tables(self.depth(px, np.full_like(px, x), s))
        weight = (angle * reach / math.pi)[:, None] * self.ws * self.delta * self.density(px)
        left, share = self.shares(px.ravel())
        across = lagrange(self.y, py.ravel())
        cells = ((left[:, None, None] + np.arange(2)[:, None]) * ny + np.arange(ny)).ravel()  # of each place: 2 x ny nodes
        spread = (np.stack([1 - share, share], axis=1)[:, :, None] * across[:, None]).reshape(len(left), -1)
        unknowns, enters = np.zeros((len(moments), 4 * nx * ny + 2 * nx)), np.zeros((len(moments), 4))
        edge = tables(self.depth(bx, np.full_like(bx, x), far))
        for m, moment in enumerate(moments):
            for f, field in enumerate(FIELDS):
                values = (weight * kernel(moment, field, (ex[:, None], ey[:, None]), depths, 0)).ravel()
                unknowns[m, f * nx * ny:(f + 1) * nx * ny] = np.bincount(cells, (values[:, None] * spread).ravel(), nx * ny)
            begins = {field: angle / math.pi * kernel(moment, field, (ex, ey), edge, 1) for field in ("n", "jx", "t")}
            for wall in (0, 1):
                on = side == wall
                unknowns[m, 4 * nx * ny + wall * nx:][:nx] = self.onto_nodes(bx[on], begins["n"][on])
            enters[m] = (begins["n"][side == 2].sum(), begins["n"][side == 3].sum(), begins["jx"][side >= 2].sum(),
                         begins["t"][side == 3].sum())
        return unknowns, enters

    def solve(self, first, last, at_rest=False):
        """Gas of these pressures at both ends. It enters like gas of a vessel at rest; or at the speed of the flow, and at the
        last end as warm as the motion along the end near it. Yields itself, with the fields."""
        nx, ny = len(self.x), len(self.y)
        n = 4 * nx * ny
        a, b = np.eye(n + 2 * nx), np.zeros((n + 2 * nx, 4))
        for i, x in enumerate(self.x):
            for j, y in enumerate(self.y):
                rows = np.arange(4) * nx * ny + i * ny + j
                unknowns, b[rows] = self.row(x, y, FIELDS)
                a[rows] -= unknowns
            for wall in (0, 1):
                unknowns, b[n + wall * nx + i] = self.row(x, float(wall), ("wall",))
                a[n + wall * nx + i] -= unknowns[0]
        states = np.linalg.solve(a, b)
        flows = np.einsum("ijk,j->ik", states[nx * ny:2 * nx * ny].reshape(nx, ny, 4), self.wy)
        flow = flows[nx // 4:nx - nx // 4].mean(axis=0)
        warm = np.zeros(4)
        for y, w in zip(self.y, self.wy):
            unknowns, enters = self.row(self.length - self.cell / 2, y, ("across",))
            warm += w * (unknowns @ states + enters)[0]
        # Entering: first, last (1 - w), J, last w, with J the flow and last w = warm: two equations.
        given = np.array([first, last, 0.0, 0.0])
        if not at_rest:
            j, w = np.linalg.solve([[1 - flow[2], flow[1] - flow[3]], [-warm[2], 1 + warm[1] - warm[3]]],
                                   [flow @ given, warm @ given])
            given = np.array([first, last - w, j, w])
        self.n, self.jx, self.jy, self.t = (states[:n] @ given).reshape(4, nx, ny)
        self.flows, self.flow, self.warmth = flows @ given, flow @ given, given[3] / last if last else 0.0
        return self

    def with_density(self, first, last, times=2):
        """The same with nu as the density of the solution before."""
        self.solve(first, last)
        for _ in range(times):
            x, n = np.concatenate([[0.0], self.x, [self.length]]), self.n @ self.wy
            slope = lambda i, k, to: n[i] + (n[i] - n[k]) * (to - self.x[i]) / (self.x[i] - self.x[k])
            n = np.concatenate([[slope(0, 1, 0.0)], n, [slope(-1, -2, self.length)]])
            self.density = lambda at, x=x, n=n: np.interp(at, x, n)
            self.solve(first, last)
        return self

    def pressure(self, x):
        return np.interp(x, self.x, (self.n + self.t) @ self.wy)


def transmission(length, points=800):
    """Of a channel without collisions: Clausing's integral equation, by Gauss's points."""
    x, w = np.polynomial.legendre.leggauss(points)
    x, w = length * 0.5 * (x + 1), length * 0.5 * w
    onto = lambda x: 0.5 * (1 - x / np.sqrt(1 + x * x))  # a wall at x from an end
    arrives = np.linalg.solve(np.eye(points) - 0.5 * w / ((x[:, None] - x)**2 + 1)**1.5, onto(x))
    return math.sqrt(1 + length**2) - length + 2 * (w * arrives * onto(length - x)).sum()


def main():
    from ducts import flow_of_bgk
    for length in (1, 20):
        found = Channel(float(length), 1e-7).solve(1.0, 0.0, at_rest=True)
        print(f"no collisions, length {length}: transmission {2 * math.sqrt(math.pi) * found.flow:.5f}, "
              f"Clausing's equation {transmission(length):.5f}", flush=True)
    for delta, length in ((0.1, 20), (0.1, 60), (0.1, 200), (1.0, 20), (10.0, 20)):
        found = Channel(float(length), delta, along=64 if length < 60 else 96).solve(4 / 3, 2 / 3)
        fall = (found.pressure(0.4 * length) - found.pressure(0.6 * length)) / 0.2 / length
        print(f"delta = {delta:g}, length {length}: G {2 * found.flow / fall:.4f} in the middle, {flow_of_bgk(delta):.4f} without ends",
              flush=True)


if __name__ == "__main__":
    main()
