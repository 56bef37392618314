#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The push of an end wall held at 5 on the pair of reading A, with all walls at 5, by other means: cubic elements in dolfinx
on a mesh by Gmsh, and forms that have nothing to cancel (Debian packages python3-dolfinx-real and python3-gmsh).

Usage: end_wall.py HALF_LENGTH... [--width Y] [--top Z] [--size H] [--degree 2|3] [--no-spheres]

All lengths in Debye lengths. The potential of the empty cross-section, psi0(y, z) with walls, plate and lid at 5, is
subtracted: u = psi - psi0 vanishes on all of them, and what passes a plane x = const,

    S(x) = integral of |grad_t u|^2/2 - u_x^2/2 + cosh(psi0 + u) - cosh psi0 - u sinh psi0  over y and z,

has only terms of second order in u and is the same for all planes between which there is no body. The force on the sphere
at x > 0 is S(0) - S(between sphere and wall), twice that of the meshed half. Without spheres it must be zero. Each row has
the force by two planes (means over two stretches between sphere and wall), whose difference tells the error of the mesh.
"""
import argparse
import time

import gmsh
import numpy as np
import ufl
from dolfinx import fem
from petsc4py import PETSc

from dolfinx_steps import make_curved_mesh, solve

RADIUS, DISTANCE, HEIGHT = 0.325 / 0.275, 4.5 / 0.275, 2.5 / 0.275
PLACE = DISTANCE / 2  # x of the center of the sphere
SPHERE, WALL = 3.0, 5.0


class CrossSection:
    """psi0(y, z) on [-width, width] x [0, top], lap psi0 = sinh psi0, WALL on the boundary: Chebyshev's points, even in y."""

    def __init__(self, width, top, n_y=96, n_z=100):
        y, d_y = self.chebyshev(n_y)
        z, d_z = self.chebyshev(n_z)
        half = n_y // 2 + 1  # y[0..half) >= 0, the last one is 0
        second_y = (d_y @ d_y)[:half]
        second_y = second_y[:, :half] + np.pad(second_y[:, half:][:, ::-1], ((0, 0), (0, 1)))
        second_z = (d_z @ d_z) * (2 / top) ** 2
        second_y = second_y[1:, 1:] / width**2
        inner_z = second_z[1:-1, 1:-1]
        # phi = psi0 - WALL is zero on the boundary
        laplace = np.kron(second_y, np.eye(n_z - 1)) + np.kron(np.eye(half - 1), inner_z)
        phi = np.full(len(laplace), -WALL)
        for _ in range(60):
            residual = laplace @ phi - np.sinh(WALL + phi)
            step = np.linalg.solve(laplace - np.diag(np.cosh(WALL + phi)), -residual)
            phi += np.clip(step, -1.0, 1.0)
            if np.abs(step).max() < 1e-9:
                break
        else:
            raise SystemExit("end_wall.py: the cross-section's potential was not found")
        values = np.full((n_y + 1, n_z + 1), WALL)
        values[1:half, 1:-1] = WALL + phi.reshape(half - 1, n_z - 1)
        values[half:] = values[: n_y // 2][::-1]
        self.width, self.top = width, top
        self.coefficients = np.polynomial.chebyshev.chebfit(y, np.polynomial.chebyshev.chebfit(z, values.T, n_z).T, n_y)

    @staticmethod
    def chebyshev(n):
        k = np.arange(n + 1)
        x = np.cos(np.pi * k / n)
        c = np.where((k == 0) | (k == n), 2.0, 1.0) * (-1.0) ** k
        gap = x[:, None] - x[None, :] + np.eye(n + 1)
        d = np.outer(c, 1 / c) / gap
        return x, d - np.diag(d.sum(axis=1))

    def __call__(self, p):
        """At points p of shape (3, n)."""
        places, index = np.unique(np.round(p[1:3].T, 12), axis=0, return_inverse=True)
        y, z = places[:, 0] / self.width, 2 * places[:, 1] / self.top - 1
        at_y = np.polynomial.chebyshev.chebvander(y, self.coefficients.shape[0] - 1)
        at_z = np.polynomial.chebyshev.chebvander(z, self.coefficients.shape[1] - 1)
        return np.einsum("ni,ij,nj->n", at_y, self.coefficients, at_z, optimize=True)[index.ravel()]


def make_mesh(o, half_length):
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    occ = gmsh.model.occ
    box = occ.addBox(0, 0, 0, half_length, o.width, o.top)
    if not o.no_spheres:
        occ.cut([(3, box)], [(3, occ.addSphere(PLACE, 0, HEIGHT, RADIUS))])
    occ.synchronize()
    groups = {"sphere": [], "walls": [], "end": [], "middle": [], "mirror": []}
    for _, tag in gmsh.model.getEntities(2):
        low, high = np.split(np.array(gmsh.model.getBoundingBox(2, tag)), 2)
        flat = high - low < 1e-3
        name = ("sphere" if not flat.any() else "middle" if flat[0] and low[0] < 1e-3 else "end" if flat[0]
                else "mirror" if flat[1] and low[1] < 1e-3 else "walls")
        groups[name].append(tag)
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)], 1)
    for number, name in enumerate(groups, 1):
        if groups[name]:
            gmsh.model.addPhysicalGroup(2, groups[name], number)
    field = gmsh.model.mesh.field
    away = f"(sqrt((x-{PLACE})^2 + y^2 + (z-{HEIGHT})^2) - {RADIUS})"
    wanted = [f"{1.2 * o.size} + 0.5*({half_length}-x)", f"{3 * o.size}"]
    if not o.no_spheres:
        wanted.append(f"{o.size} + 0.4*{away}")
    parts = []
    for text in wanted:
        parts.append(field.add("MathEval"))
        field.setString(parts[-1], "F", text)
    smallest = field.add("Min")
    field.setNumbers(smallest, "FieldsList", parts)
    field.setAsBackgroundMesh(smallest)
    return make_curved_mesh()


def force(o, half_length, section):
    begin = time.process_time()
    mesh, facets = make_mesh(o, half_length)
    space = fem.FunctionSpace(mesh, ("Lagrange", o.degree))
    fine = fem.FunctionSpace(mesh, ("Lagrange", o.degree + 1))
    psi0 = fem.Function(fine)
    psi0.interpolate(section)
    x = ufl.SpatialCoordinate(mesh)
    dx = ufl.Measure("dx", mesh, metadata={"quadrature_degree": 2 * o.degree + 2})
    ds = ufl.Measure("ds", mesh, subdomain_data=facets, metadata={"quadrature_degree": 2 * o.degree + 2})
    sphere, walls, end, middle = 1, 2, 3, 4
    nodes = {k: fem.locate_dofs_topological(space, 2, facets.find(k)) for k in (sphere, walls, end)}
    given = fem.Function(space)
    u, v, w = fem.Function(space), ufl.TestFunction(space), ufl.TrialFunction(space)
    given.interpolate(lambda p: SPHERE - section(p))
    u.x.array[nodes[sphere]] = given.x.array[nodes[sphere]]
    given.interpolate(lambda p: WALL - section(p))
    u.x.array[nodes[end]] = given.x.array[nodes[end]]
    u.x.array[nodes[walls]] = 0
    zero = fem.Constant(mesh, PETSc.ScalarType(0.0))
    fixed = [fem.dirichletbc(zero, nodes[k], space) for k in (sphere, walls, end)]
    slope = (ufl.dot(ufl.grad(w), ufl.grad(v)) + ufl.cosh(psi0 + u) * w * v) * dx
    rest = (ufl.dot(ufl.grad(u), ufl.grad(v)) + 2 * ufl.cosh(psi0 + u / 2) * ufl.sinh(u / 2) * v) * dx
    for _ in range(40):
        step = solve(slope, -rest, fixed, space)
        largest = np.abs(step.x.array).max()
        u.x.array[:] += step.x.array * min(1.0, 2.0 / largest)
        if largest < 1e-9:
            break
    else:
        raise SystemExit("end_wall.py: Newton's method has not converged")
    g = ufl.grad(u)
    # cosh(psi0 + u) - cosh psi0 - u sinh psi0 without cancellation: a series where u is small
    small = u * u / 2 * (ufl.cosh(psi0) + u / 3 * ufl.sinh(psi0) + u * u / 12 * ufl.cosh(psi0))
    whole = ufl.cosh(psi0 + u) - ufl.cosh(psi0) - u * ufl.sinh(psi0)
    passes = (g[1]**2 + g[2]**2 - g[0]**2) / 2 + ufl.conditional(ufl.lt(abs(u), 0.01), small, whole)

    def value(form):
        return fem.assemble_scalar(fem.form(form))

    start = PLACE + RADIUS
    found = []
    for a, b in ((0.1, 0.4), (0.25, 0.6)):  # two places of the plane, spread over a stretch
        low, high = start + a * (half_length - start), start + b * (half_length - start)
        t = (x[0] - low) / (high - low)
        weight = ufl.conditional(ufl.And(ufl.gt(t, 0), ufl.lt(t, 1)), 30 * t**2 * (1 - t)**2 / (high - low), 0.0)
        found.append(value(passes * weight * dx))
    at_middle = value(passes * ds(middle))
    cells = mesh.topology.index_map(3).size_local
    return at_middle, found, cells, len(u.x.array), time.process_time() - begin


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("half_lengths", type=float, nargs="+", metavar="HALF_LENGTH")
    parser.add_argument("--width", type=float, default=12.0)
    parser.add_argument("--top", type=float, default=20.0)
    parser.add_argument("--size", type=float, default=0.4)
    parser.add_argument("--degree", type=int, default=3)
    parser.add_argument("--no-spheres", action="store_true")
    o = parser.parse_args()
    section = CrossSection(o.width, o.top)
    print("half_length,f_x,f_x_by_other_plane,pair,cells,unknowns,cpu_s", flush=True)
    for half_length in o.half_lengths:
        middle, walls, cells, unknowns, seconds = force(o, half_length, section)
        print(f"{half_length:g},{2 * (middle - walls[0]):.6e},{2 * (middle - walls[1]):.6e},{2 * middle:.6e},{cells},{unknowns},"
              f"{seconds:.0f}", flush=True)


if __name__ == "__main__":
    main()
