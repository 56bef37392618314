# SPDX-License-Identifier: GPL-3.0-or-later
"""The dolfinx side of compare-pb.sh: reads the same mesh, solves the same equations, prints both.

Usage: compare_pb.py MESH.hdf PAMR.json
"""
import json
import logging
import resource
import sys
import time

import h5py
import numpy as np
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI
from petsc4py import PETSc


class Clock:
    def __init__(self):
        self.wall, self.cpu = time.perf_counter(), time.process_time()

    def lap(self):
        wall, cpu = time.perf_counter() - self.wall, time.process_time() - self.cpu
        self.__init__()
        return wall, cpu


def read(name):
    with h5py.File(name) as file:
        points = file["VTKHDF/Points"][:]
        cells = file["VTKHDF/Connectivity"][:].reshape(-1, 4)
    element = ufl.Mesh(ufl.VectorElement("Lagrange", ufl.tetrahedron, 1))
    return mesh.create_mesh(MPI.COMM_WORLD, cells, points, element)


def problem(domain):
    """psi = 5 at z = 0, the exact profile at z = 1; the form with the vertices as quadrature points."""
    space = fem.FunctionSpace(domain, ("Lagrange", 1))
    psi, v, d = fem.Function(space), ufl.TestFunction(space), ufl.TrialFunction(space)
    vertices = ufl.dx(metadata={"quadrature_rule": "vertex", "quadrature_degree": 1})
    residual = ufl.inner(ufl.grad(psi), ufl.grad(v)) * ufl.dx + ufl.sinh(psi) * v * vertices
    jacobian = ufl.inner(ufl.grad(d), ufl.grad(v)) * ufl.dx + ufl.cosh(psi) * d * v * vertices
    z = lambda level: fem.locate_dofs_geometrical(space, lambda x: np.isclose(x[2], level))
    lid = 4 * np.arctanh(np.tanh(5 / 4) * np.exp(-1))
    conditions = [fem.dirichletbc(PETSc.ScalarType(5.0), z(0), space),
                  fem.dirichletbc(PETSc.ScalarType(lid), z(1), space)]
    return psi, fem.form(residual), fem.form(jacobian), conditions


def newton(psi, residual, jacobian, conditions):
    """Undamped, until a step is below 1e-8; CG to 1e-8. Returns steps and iterations."""
    matrix, vector = fem.petsc.create_matrix(jacobian), fem.petsc.create_vector(residual)
    step = psi.vector.copy()
    solver = PETSc.KSP().create(MPI.COMM_WORLD)
    solver.setType("cg")
    solver.getPC().setType("jacobi")
    solver.setTolerances(rtol=1e-8)
    solver.setOperators(matrix)
    iterations = 0
    for number in range(1, 50):
        matrix.zeroEntries()
        fem.petsc.assemble_matrix(matrix, jacobian, bcs=conditions)
        matrix.assemble()
        with vector.localForm() as local:
            local.set(0)
        fem.petsc.assemble_vector(vector, residual)
        fem.petsc.apply_lifting(vector, [jacobian], [conditions], x0=[psi.vector], scale=-1.0)
        fem.petsc.set_bc(vector, conditions, psi.vector, -1.0)
        solver.solve(vector, step)
        iterations += solver.getIterationNumber()
        psi.vector.axpy(-1.0, step)
        if step.norm(PETSc.NormType.NORM_INFINITY) < 1e-8:
            return number, iterations
    raise SystemExit("compare_pb.py: dolfinx did not converge")


def main():
    logging.disable(logging.INFO)  # of the compiler of forms
    with open(sys.argv[2], encoding="utf-8") as file:
        ours = json.load(file)
    domain = read(sys.argv[1])
    parts = problem(domain)
    clock = Clock()
    steps, iterations = newton(*parts)
    wall, cpu = clock.lap()
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    psi = parts[0]
    energy = domain.comm.allreduce(fem.assemble_scalar(fem.form(
        ufl.inner(ufl.grad(psi), ufl.grad(psi)) / 2 * ufl.dx
        + (ufl.cosh(psi) - 1) * ufl.dx(metadata={"quadrature_rule": "vertex", "quadrature_degree": 1}))))

    our_wall = ours["seconds"]["assemble"] + ours["seconds"]["solve"]
    our_cpu = ours["cpu_seconds"]["assemble"] + ours["cpu_seconds"]["solve"]
    print(f"{ours['cells']} cells, {ours['nodes']} nodes, one rank; assembly and solve")
    print("            wall s   cpu s   Newton steps   CG iterations   peak MB        energy")
    print(f"pamr-pb   {our_wall:8.2f} {our_cpu:7.2f} {ours['newton_iterations']:>14} {ours['linear_iterations']:>15} "
          f"{ours['peak_rss_bytes'] / 2**20:>9.0f} {ours['energy']:>13.8f}")
    print(f"dolfinx   {wall:8.2f} {cpu:7.2f} {steps:>14} {iterations:>15} {memory:>9.0f} {energy:>13.8f}")
    print(f"ratio     {wall / our_wall:8.2f} {cpu / our_cpu:7.2f}")
    if abs(energy - ours["energy"]) > 1e-6 * abs(energy):
        sys.exit("compare_pb.py: expected the same energy of both")


if __name__ == "__main__":
    main()
