#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Force, torque and charge of cases/ellipsoid-plate by other means: quadratic or cubic elements on curved cells of a Gmsh mesh of the
true ellipsoid, in dolfinx (Debian packages python3-dolfinx-real and python3-gmsh; dolfinx 0.5).

Usage: reference.py [--size H] [--largest H] [--degree 2|3] [--spheres [RADIUS DISTANCE HEIGHT SPHERE PLATE]] [--far D]

H is the wanted edge length at the body (--size) and anywhere (--largest). Same box, same conditions on its walls as
its case.toml. Forces by the volume form with a harmonic cut-off function of the same degree; charge by the reaction. With
--spheres the same for two spheres over a plate (default: reading B of cases/charged-spheres; SPHERE and PLATE are
potentials), whose force along x is also found through the mid-plane; the walls are D (default 7.5) beyond the center.
The force on the plate is that of its stress.
"""
import argparse
import math
import time

import gmsh
import numpy as np
import ufl
from dolfinx import fem
from petsc4py import PETSc

from dolfinx_steps import make_curved_mesh, solve


class Ellipsoid:
    axes, turn, center = (0.8, 0.5, 0.4), math.radians(30), (0.0, 0.0, 1.3)
    low, high = (-4.0, 0.0, 0.0), (4.0, 4.0, 5.5)
    body, plate = 2.0, 3.0
    mirror_x = False
    largest = 0.8

    @staticmethod
    def decay(x, n):
        """Coefficient of the far-field condition."""
        return 1.0


class Spheres:
    turn, low = 0.0, (0.0, 0.0, 0.0)
    mirror_x = True
    largest = 1.5

    def __init__(self, radius=0.325, distance=4.5, height=2.5, body=3.0, plate=5.0, far=7.5):
        self.axes, self.center = (radius,) * 3, (distance / 2, 0.0, height)
        self.high = tuple(c + far for c in self.center)
        self.body, self.plate = body, plate

    def decay(self, x, n):
        total = slope = 0
        for side in (1, -1):
            away = x - ufl.as_vector((side * self.center[0], self.center[1], self.center[2]))
            d = ufl.sqrt(ufl.dot(away, away))
            share = ufl.exp(-d) / d
            total += share
            slope += share * (1 + 1 / d) * ufl.dot(away, n) / d
        return slope / total


def make_mesh(shape, size):
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    occ = gmsh.model.occ
    ball = occ.addSphere(*shape.center, 1)
    occ.dilate([(3, ball)], *shape.center, *shape.axes)
    occ.rotate([(3, ball)], *shape.center, 0, -1, 0, shape.turn)
    box = occ.addBox(*shape.low, *(b - a for a, b in zip(shape.low, shape.high)))
    occ.cut([(3, box)], [(3, ball)])
    occ.synchronize()
    groups = {"body": [], "plate": [], "mirror": [], "far": [], "middle": []}
    for _, tag in gmsh.model.getEntities(2):
        box = gmsh.model.getBoundingBox(2, tag)
        reach = max(abs(box[3 * end + k] - shape.center[k]) for end in range(2) for k in range(3))
        flat = {"plate": box[5] < 1e-3, "mirror": box[4] < 1e-3, "middle": shape.mirror_x and box[3] < 1e-3}
        name = next((name for name, here in flat.items() if here), "body" if reach < 2.5 * shape.axes[0] else "far")
        groups[name].append(tag)
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)], 1)
    for number, name in enumerate(groups, 1):
        if groups[name]:
            gmsh.model.addPhysicalGroup(2, groups[name], number)
    field = gmsh.model.mesh.field
    grow, plate, least = field.add("MathEval"), field.add("MathEval"), field.add("Min")
    c, d = math.cos(shape.turn), math.sin(shape.turn)
    x, z = f"(x - {shape.center[0]})", f"(z - {shape.center[2]})"
    along, up = f"({c}*{x} + {d}*{z})", f"({c}*{z} - {d}*{x})"
    level = f"sqrt(({along}/{shape.axes[0]})^2 + (y/{shape.axes[1]})^2 + ({up}/{shape.axes[2]})^2)"
    field.setString(grow, "F", f"{size} * (1 + 0.9 * ({level} - 1))")
    field.setString(plate, "F", f"{2.5 * size} + 0.4*z + 0.15*sqrt({x}^2 + y^2)")
    field.setNumbers(least, "FieldsList", [grow, plate])
    field.setAsBackgroundMesh(least)
    gmsh.option.setNumber("Mesh.MeshSizeMax", shape.largest)
    return make_curved_mesh()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", type=float, default=0.15)
    parser.add_argument("--largest", type=float)
    parser.add_argument("--degree", type=int, default=2)
    parser.add_argument("--spheres", type=float, nargs="*")
    parser.add_argument("--far", type=float, default=7.5)
    o = parser.parse_args()
    shape = Ellipsoid() if o.spheres is None else Spheres(*o.spheres, far=o.far)
    if o.largest:
        shape.largest = o.largest
    mesh, facets = make_mesh(shape, o.size)
    begin = time.process_time()
    space = fem.FunctionSpace(mesh, ("Lagrange", o.degree))
    x = ufl.SpatialCoordinate(mesh)
    n = ufl.FacetNormal(mesh)
    dx = ufl.Measure("dx", mesh, metadata={"quadrature_degree": 8})
    ds = ufl.Measure("ds", mesh, subdomain_data=facets, metadata={"quadrature_degree": 8})
    body, plate, far, middle = 1, 2, 4, 5
    alpha = shape.decay(x, n)
    amplitude = math.tanh(shape.plate / 4)

    def profile(z):
        return 4 * np.arctanh(amplitude * np.exp(-z))

    decayed = amplitude * ufl.exp(-x[2])
    psi0 = 2 * ufl.ln((1 + decayed) / (1 - decayed))
    nodes = {k: fem.locate_dofs_topological(space, 2, facets.find(k)) for k in (body, plate)}
    on_body = fem.Function(space)
    on_body.interpolate(lambda p: shape.body - profile(p[2]))
    zero, one = (fem.Constant(mesh, PETSc.ScalarType(v)) for v in (0.0, 1.0))

    u, v, w = fem.Function(space), ufl.TestFunction(space), ufl.TrialFunction(space)

    def residual(test):
        return (ufl.dot(ufl.grad(u), ufl.grad(test)) + (ufl.sinh(psi0 + u) - ufl.sinh(psi0)) * test) * dx + alpha * u * test * ds(far)

    slope = (ufl.dot(ufl.grad(w), ufl.grad(v)) + ufl.cosh(psi0 + u) * w * v) * dx + alpha * w * v * ds(far)
    u.x.array[nodes[body]] = on_body.x.array[nodes[body]]
    fixed = [fem.dirichletbc(zero, nodes[k], space) for k in (body, plate)]
    for _ in range(30):
        step = solve(slope, -residual(v), fixed, space)
        u.x.array[:] += step.x.array
        if abs(step.x.array).max() < 1e-10:
            break

    outer = fem.locate_dofs_topological(space, 2, np.concatenate([facets.find(k) for k in (plate, far, middle)]))
    chi = solve(ufl.dot(ufl.grad(w), ufl.grad(v)) * dx, zero * v * dx,
                [fem.dirichletbc(zero, outer, space), fem.dirichletbc(one, nodes[body], space)], space)
    base = ufl.as_vector([0, 0, -2 * ufl.sinh(psi0 / 2)])
    g, s = ufl.grad(u) + base, ufl.grad(chi)

    def stress(gradient):
        return ufl.dot(gradient, s) * gradient - ufl.dot(gradient, gradient) / 2 * s

    pull = stress(g) - stress(base) - (ufl.cosh(psi0 + u) - ufl.cosh(psi0)) * s
    arm = ufl.cross(x - ufl.as_vector(shape.center), pull)

    def total(integrand):
        return 2 * fem.assemble_scalar(fem.form(integrand * dx))  # both sides of the mirror

    # The charge is that of u by the reaction and that of psi0, whose flux out of the ellipsoid is -integral of sinh psi0
    # within it: by its flux through the faces.
    charge = 2 * fem.assemble_scalar(fem.form(residual(chi))) + 2 * fem.assemble_scalar(
        fem.form(ufl.dot(base, n) * ds(body)))
    print(f"{mesh.topology.index_map(3).size_global} cells, {space.dofmap.index_map.size_global} unknowns, degree {o.degree}: "
          f"force-x {-total(pull[0]):.7f} force-z {-total(pull[2]):.7f} torque-y {-total(arm[1]):.7f} charge {charge:.7f}")
    if shape.mirror_x:
        across = ufl.dot(ufl.grad(u), ufl.grad(u)) - ufl.dot(ufl.grad(u), n) ** 2
        rest = ufl.cosh(psi0 + u) - ufl.cosh(psi0) - u * ufl.sinh(psi0)
        print(f"force-x through the mid-plane {2 * fem.assemble_scalar(fem.form((across / 2 + rest) * ds(middle))):.9g}")
    # What psi0 alone exerts is left out; on the plate u is 0.
    through_plate = fem.assemble_scalar(fem.form((base[2] * u.dx(2) + u.dx(2) ** 2 / 2) * ds(plate)))
    print(f"force-z on the plate {(4 if shape.mirror_x else 2) * through_plate:.7f}")
    print(f"solved in {time.process_time() - begin:.2f} s of processor time")


if __name__ == "__main__":
    main()
