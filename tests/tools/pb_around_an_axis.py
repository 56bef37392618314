# SPDX-License-Identifier: GPL-3.0-or-later
"""The Poisson-Boltzmann equation around a body of revolution in a sphere, by spectral elements in the half plane of its axis.

A body is seen from a point of that half plane, and all rays from there meet it once and then the sphere or the axis. Between both the
unknowns are polynomials of high degree on a grid of angles and shares of the way. Nothing here is of pamr-pb.
"""
import math

import numpy as np


class Body:
    """Distances of the body and of what is around it from `seen_from` (distance from the axis, place along it), by the angle to the
    direction away from the axis.

    Angles are in pieces, at whose ends a distance may bend; near `edges` pieces are to be short. `times` completes the body.
    """

    def __init__(self, seen_from, near, far, pieces, *, shell, edges=(), times=1):
        self.seen_from, self.near, self.far, self.pieces = seen_from, near, far, pieces
        self.shell, self.edges, self.times = shell, edges, times


def ellipsoid(along, across, shell):
    """Half axes along the axis of revolution and across it; by its upper half."""
    return Body((0.0, 0.0), lambda t: 1 / np.sqrt(np.sin(t) ** 2 / along ** 2 + np.cos(t) ** 2 / across ** 2),
                lambda t: np.full_like(t, shell), [k * math.pi / 8 for k in range(5)], shell=shell, times=2)


def torus(major, minor, shell):
    """The same of a ring, seen from the middle of its tube."""
    corner = math.pi - math.atan2(shell, major)  # where the sphere meets the axis

    def far(t):
        on_axis = np.where(t < corner + 1e-12, np.inf, -major / np.where(t < corner + 1e-12, 1, np.cos(t)))
        return np.minimum(on_axis, np.sqrt(shell ** 2 - (major * np.sin(t)) ** 2) - major * np.cos(t))

    pieces = [0, corner / 2, corner, (corner + math.pi) / 2, math.pi]
    return Body((major, 0.0), lambda t: np.full_like(t, minor), far, pieces, shell=shell, times=2)


def two_balls(balls, shell):
    """Two balls (place along the axis, radius) that overlap, as one body; the middle of the sphere is in both."""
    (x, r), (y, s) = sorted(balls)
    plane = (r * r - s * s - x * x + y * y) / (2 * (y - x))  # of the circle where they meet
    edge = math.atan2(plane, math.sqrt(r * r - (plane - x) ** 2))

    def near(t):
        return np.max([c * np.sin(t) + np.sqrt(q * q - (c * np.cos(t)) ** 2) for c, q in ((x, r), (y, s))], axis=0)

    return Body((0.0, 0.0), near, lambda t: np.full_like(t, shell), [-math.pi / 2, edge, math.pi / 2], shell=shell,
                edges=(edge,))


def split(ends, near, n, share=0.15):
    """`ends` with n more points towards each point of `near`, in geometric sequence."""
    more = [end for a, b in zip(ends, ends[1:]) for k in range(1, n + 1) for end in
            ([a + (b - a) * share ** k] if a in near else []) + ([b - (b - a) * share ** k] if b in near else [])]
    return sorted([*ends, *more])


class Line:
    """Polynomials of this degree between points that follow each other; in each piece places of Gauss with weights."""

    def __init__(self, ends, degree):
        inner = np.polynomial.legendre.Legendre.basis(degree).deriv().roots()
        nodes = np.concatenate([[-1], np.sort(inner.real), [1]])
        places, weights = np.polynomial.legendre.leggauss(degree + 4)
        # Coefficients of Legendre polynomials of each function that is 1 in one node.
        of_nodes = np.linalg.inv(np.polynomial.legendre.legvander(nodes, degree))
        slopes = np.polynomial.legendre.legder(of_nodes)
        self.value = np.polynomial.legendre.legvander(places, degree) @ of_nodes
        self.slope = np.polynomial.legendre.legvander(places, degree - 1) @ slopes
        self.weight, self.degree, self.n = weights, degree, len(ends) - 1
        self.node = [a + (b - a) * (nodes + 1) / 2 for a, b in zip(ends, ends[1:])]

    def numbers(self, k):
        return np.arange(k * self.degree, (k + 1) * self.degree + 1)


class Grid:
    """Unknowns along rays, one ray after the other, in columns of elements that share their first and last rays."""

    def __init__(self, body, degree, n_near):
        self.body = body
        self.angles = Line(split(body.pieces, body.edges, n_near), degree)
        self.ways = Line(split([0.0, 1.0], (0.0,) if body.edges else (), n_near) if body.edges else [0.0, 0.4, 1.0], degree)
        self.across = self.ways.n * degree + 1
        self.n = (self.angles.n * degree + 1) * self.across
        a, w = self.angles, self.ways
        self.value, self.along, self.out = (np.kron(x, y) for x, y in ((a.value, w.value), (a.slope, w.value), (a.value, w.slope)))
        self.columns = [np.arange(k * degree * self.across, ((k + 1) * degree + 1) * self.across) for k in range(a.n)]
        self.elements = [[self.element(i, j) for j in range(w.n)] for i in range(a.n)]

    def places(self, i, ways):
        """Distances from the axis, and places along it, at the nodes of piece i of the angles and these shares of the way."""
        t = self.angles.node[i]
        lengths = np.outer(self.body.near(t), 1 - ways) + np.outer(self.body.far(t), ways)
        return self.body.seen_from[0] + np.cos(t)[:, None] * lengths, self.body.seen_from[1] + np.sin(t)[:, None] * lengths

    def element(self, i, j):
        """Numbers in its column, volumes of its places, and gradients of its functions there."""
        rho, z = self.places(i, self.ways.node[j])
        rs, zs, rt, zt = self.along @ rho.ravel(), self.along @ z.ravel(), self.out @ rho.ravel(), self.out @ z.ravel()
        jacobian = rs * zt - rt * zs
        assert (jacobian < 0).all(), (i, j)
        number = (np.arange(self.angles.degree + 1)[:, None] * self.across + self.ways.numbers(j)).ravel()
        weight = -jacobian * np.outer(self.angles.weight, self.ways.weight).ravel()
        volume = weight * 2 * math.pi * (self.value @ rho.ravel()) * self.body.times
        gradient = [(a[:, None] * self.along - b[:, None] * self.out) / jacobian[:, None] for a, b in ((zt, zs), (rt, rs))]
        return number, volume, gradient

    def wall(self, i, end):
        """Nodes of piece i on the body (end 0) or on the sphere (-1), and the area that each stands for."""
        rho, z = (x[:, 0] for x in self.places(i, np.array([-end])))
        area = np.hypot(self.angles.slope @ rho, self.angles.slope @ z) * self.angles.weight * 2 * math.pi * (self.angles.value @ rho)
        is_on_wall = np.full(len(rho), end == 0) | (np.abs(np.hypot(rho, z) - self.body.shell) < 1e-9)  # else on the axis
        nodes = self.columns[i].reshape(-1, self.across)[:, end]
        return nodes[is_on_wall], (self.angles.value.T @ area * self.body.times)[is_on_wall]

    def solve(self, matrices, right):
        """Of matrices of columns, from the first column to the last and back."""
        m, kept, carried = self.across, [], np.zeros((self.across, self.across + 1))
        right = right.copy()
        for matrix, numbers in zip(matrices, self.columns):
            matrix[:m, :m] += carried[:, :m]
            right[numbers[:m]] += carried[:, m]
            kept.append(np.linalg.solve(matrix[:-m, :-m], np.column_stack([matrix[:-m, -m:], right[numbers[:-m]]])))
            carried = -matrix[-m:, :-m] @ kept[-1]
            carried[:, :m] += matrix[-m:, -m:]
        result = np.zeros(self.n)
        result[-m:] = np.linalg.solve(carried[:, :m], right[-m:] + carried[:, m])
        for numbers, of_column in zip(reversed(self.columns), reversed(kept)):
            result[numbers[:-m]] = of_column[:, m] - of_column[:, :m] @ result[numbers[-m:]]
        return result


def around(body, inner, outer, linear=False, degree=10, n_near=4):
    """Charges of body and sphere, and energy; each wall has ("potential", value) or ("charge", density)."""
    grid = Grid(body, degree, n_near)
    given, u, fixed = np.zeros(grid.n), np.zeros(grid.n), np.zeros(grid.n, bool)
    on_wall = {0: np.zeros(grid.n, bool), -1: np.zeros(grid.n, bool)}
    for end, (kind, amount) in ((0, inner), (-1, outer)):
        for i in range(grid.angles.n):
            nodes, area = grid.wall(i, end)
            on_wall[end][nodes] = True
            np.add.at(given, nodes, amount * area if kind == "charge" else 0)
        if kind == "potential":
            u[on_wall[end]], fixed[on_wall[end]] = amount, True
    for _ in range(40):
        taken, matrices, energy = np.zeros(grid.n), [], 0.0
        for numbers, elements in zip(grid.columns, grid.elements):
            matrix = np.zeros((len(numbers), len(numbers)))
            for number, volume, gradient in elements:
                of_element = u[numbers[number]]
                psi, slopes = grid.value @ of_element, [g @ of_element for g in gradient]
                source, stiffness, pressure = (psi, 1 + 0 * psi, psi ** 2 / 2) if linear else (np.sinh(psi), np.cosh(psi), np.cosh(psi) - 1)
                energy += volume @ (sum(s * s for s in slopes) / 2 + pressure)
                taken[numbers[number]] += grid.value.T @ (volume * source) + sum(g.T @ (volume * s) for g, s in zip(gradient, slopes))
                matrix[np.ix_(number, number)] += (sum(g.T @ (volume[:, None] * g) for g in gradient)
                                                   + grid.value.T @ ((volume * stiffness)[:, None] * grid.value))
            held = fixed[numbers]
            matrix[held], matrix[:, held], matrix[held, held] = 0, 0, 1
            matrices.append(matrix)
        change = grid.solve(matrices, np.where(fixed, 0, given - taken))
        u += change * min(1, 2 / max(np.abs(change).max(), 1e-300))
        if np.abs(change).max() < 1e-10:
            return {"charge": tuple(taken[on_wall[end]].sum() for end in (0, -1)), "energy": energy}
    raise AssertionError("Newton's method did not end")
