# SPDX-License-Identifier: GPL-3.0-or-later
"""The boundary value problems: -laplace(u) = f with a known solution, on a mesh of coarse cells."""
from __future__ import annotations

import itertools

import numpy as np
import pamr
import ufl


def of_rank_zero(comm, *arrays):
    return [a if comm.rank == 0 else a[:0] for a in arrays]


def mesh_of_cubes(comm, n, is_inside):
    """The cubes of side 1/n in [-1, 1]^3 for which `is_inside` holds, by their least corners in units of the side, 6 cells each."""
    side = 2 * n
    at = np.array(list(itertools.product(range(side), repeat=3)))
    at = at[is_inside(at - n)]
    steps = [np.cumsum([np.eye(3, dtype=int)[i] for i in path], axis=0) for path in itertools.permutations(range(3))]
    corners = np.array([np.concatenate([[cube], cube + step]) for cube in at for step in steps])
    used, cells = np.unique((corners @ [(side + 1) ** 2, side + 1, 1]).reshape(-1, 4), return_inverse=True)
    grid = np.stack([used // (side + 1) ** 2, used // (side + 1) % (side + 1), used % (side + 1)], axis=1)
    return pamr.Mesh.from_arrays(comm, *of_rank_zero(comm, grid / n - 1.0, cells.reshape(-1, 4)), repair=True)


def edge_function(a, b):
    """r^(2/3) sin(2 phi / 3) with phi from the positive b axis, away from the quadrant of two positive numbers. phi jumps in the middle
    of that quadrant, so that points of the two faces may lie beside them by rounding, as dolfinx computes them."""
    angle = ufl.atan_2(-a, b)
    angle = ufl.conditional(ufl.lt(angle, -np.pi / 4), angle + 2 * np.pi, angle)
    return (a * a + b * b) ** (1 / 3) * ufl.sin(2 * angle / 3)


def edge_values(a, b):
    """The same of numbers."""
    angle = np.arctan2(-a, b)
    angle = np.where(angle < -np.pi / 4, angle + 2 * np.pi, angle)
    return np.cbrt(a * a + b * b) * np.sin(2 * angle / 3)


class Edge:
    """A prism over an L: [-1, 1]^2 without [0, 1]^2, times [0, 1]. u = r^(2/3) sin(2 phi / 3) is harmonic, zero on the two faces at
    the edge of 270 degrees, and singular along it."""

    name = "edge"

    @staticmethod
    def mesh(comm):
        return mesh_of_cubes(comm, 2, lambda at: ~(at[:, :2] >= 0).all(axis=1) & (at[:, 2] >= 0))

    @staticmethod
    def exact(x):
        return edge_function(x[0], x[1])

    @staticmethod
    def source(x):
        return None  # zero

    @staticmethod
    def boundary_values(x):
        """The solution at points of the boundary, 3 x n."""
        return edge_values(x[0], x[1])

    @staticmethod
    def off_wall(points):
        return 0.0


class Fichera:
    """The cube [-1, 1]^3 without [0, 1]^3: three edges with an angle of 270 degrees inside meet in a corner. For the edge along z

        u = max(z, 0)^2 r^(2/3) sin(2 phi / 3),   -laplace(u) = -2 r^(2/3) sin(2 phi / 3) where z > 0, else 0,

    with r and phi in the x-y plane and phi from the positive y axis through the domain to the positive x axis: zero on the two
    faces at the edge, singular along the edge alone. The solution is the sum of this over the three edges."""

    name = "fichera"

    @staticmethod
    def mesh(comm):
        return mesh_of_cubes(comm, 2, lambda at: ~(at >= 0).all(axis=1))

    @staticmethod
    def exact(x):
        return sum(ufl.conditional(ufl.gt(x[k], 0), x[k] ** 2, 0.0) * edge_function(x[(k + 1) % 3], x[(k + 2) % 3])
                   for k in range(3))

    @staticmethod
    def source(x):
        return -2 * sum(ufl.conditional(ufl.gt(x[k], 0), 1.0, 0.0) * edge_function(x[(k + 1) % 3], x[(k + 2) % 3])
                        for k in range(3))

    @staticmethod
    def boundary_values(x):
        return sum(np.maximum(x[k], 0) ** 2 * edge_values(x[(k + 1) % 3], x[(k + 2) % 3]) for k in range(3))

    @staticmethod
    def off_wall(points):
        return 0.0


class Ball:
    """The unit ball with u = 0 on the sphere and u = (1 - |x|^2) / |x - q|^3, q = (1.25, 0, 0): steep at (1, 0, 0). The first mesh is
    an octahedron of eight cells refined twice onto the sphere: 512 cells."""

    name = "ball"
    q = (1.25, 0.0, 0.0)

    @staticmethod
    def mesh(comm):
        points = np.array([[0, 0, 0], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
        cells = np.array([[0, x, y, z] for x in (1, 2) for y in (3, 4) for z in (5, 6)])
        points, cells = of_rank_zero(comm, points, cells)
        mesh = pamr.Mesh.from_arrays(comm, points, cells, (cells[:, 1:], np.full(len(cells), 1)), {1: "sphere"}, repair=True)
        mesh.associate({"sphere": pamr.Sphere(center=(0, 0, 0), radius=1)})
        for _ in range(2):
            mesh = pamr.refine(mesh, np.ones(len(mesh.cells), bool)).mesh
        return mesh

    @classmethod
    def exact(cls, x):
        return (1 - ufl.dot(x, x)) / ufl.dot(x - ufl.as_vector(cls.q), x - ufl.as_vector(cls.q)) ** 1.5

    @classmethod
    def source(cls, x):
        return -ufl.div(ufl.grad(cls.exact(x)))

    @staticmethod
    def boundary_values(x):
        return np.zeros(x.shape[1])

    @staticmethod
    def off_wall(points):
        """Largest distance of points that ought to be on the sphere."""
        return float(np.abs(np.linalg.norm(points, axis=1) - 1).max(initial=0))


PROBLEMS = {problem.name: problem for problem in (Edge, Fichera, Ball)}
