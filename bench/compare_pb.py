# SPDX-License-Identifier: GPL-3.0-or-later
"""The dolfinx side of compare-pb.sh, as one would write it by hand for speed: P1, the stiffness matrix assembled once, the
source lumped, so that a Newton step changes the diagonal alone, inexact Newton (Eisenstat and Walker), CG.

Usage: compare_pb.py MESH.hdf jacobi|boomeramg    prints JSON: CPU seconds of each stage, iterations, energy, memory

Points and cells are in memory when the clock starts, and forms are compiled. The boundary is found by coordinates: psi =
5 at z = 0, the exact profile at z = 1. With boomeramg the settings are those of pamr-pb and one hierarchy serves all steps.
"""
import json
import logging
import math
import sys
import time

import h5py
import numpy as np
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI
from petsc4py import PETSc

MULTIGRID = {"coarsen_type": "PMIS", "strong_threshold": 0.5, "agg_nl": 1, "agg_num_paths": 2, "interp_type": "ext+i",
             "P_max": 6, "relax_type_down": "SOR/Jacobi", "relax_type_up": "backward-SOR/Jacobi", "no_CF": True}
TOLERANCE = 1e-10  # of the residual, over that of the potential that is 0 off the boundary, as pamr-pb's
VERTICES = {"quadrature_rule": "vertex", "quadrature_degree": 1}


class Stages:
    def __init__(self):
        self.seconds, self.last = {}, time.process_time()

    def lap(self, name):
        now = time.process_time()
        self.seconds[name], self.last = now - self.last, now


def resident(key):
    with open("/proc/self/status", encoding="utf-8") as file:
        for line in file:
            if line.startswith(key):
                return 1024 * int(line.split()[1])
    return 0


def restart_peak():
    with open("/proc/self/clear_refs", "w", encoding="utf-8") as file:
        file.write("5")


def forms(space):
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    return (fem.form(ufl.inner(ufl.grad(u), ufl.grad(v)) * ufl.dx), fem.form(v * ufl.dx(metadata=VERTICES)))


def make_domain(points, cells):
    return mesh.create_mesh(MPI.COMM_WORLD, cells, points, ufl.Mesh(ufl.VectorElement("Lagrange", ufl.tetrahedron, 1)))


def make_solver(preconditioner):
    solver = PETSc.KSP().create(MPI.COMM_WORLD)
    solver.setType("cg")
    solver.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
    if preconditioner == "boomeramg":
        options = PETSc.Options()
        for name, value in MULTIGRID.items():
            options[f"pc_hypre_boomeramg_{name}"] = value
        solver.getPC().setType("hypre")
        solver.getPC().setHYPREType("boomeramg")
        solver.getPC().setFromOptions()
    else:
        solver.getPC().setType("jacobi")
    return solver


def newton(stiffness, volume, fixed, values, preconditioner):
    """Returns psi, Newton steps and CG iterations. Full steps: none has to be shortened here."""
    jacobian = stiffness.copy()
    jacobian.zeroRowsColumns(fixed, 1.0)
    diagonal = jacobian.getDiagonal()
    solver = make_solver(preconditioner)
    solver.setOperators(jacobian)
    psi, residual, step, updated = (stiffness.createVecRight() for _ in range(4))
    psi.array[fixed] = values
    free_volume = volume.array.copy()
    free_volume[fixed] = 0
    first = before = relative = None
    iterations = 0
    for number in range(60):
        stiffness.mult(psi, residual)
        residual.array[:] += free_volume * np.sinh(psi.array)
        residual.array[fixed] = 0
        norm = residual.norm()
        first = first or norm
        if norm <= TOLERANCE * first:
            return psi, number, iterations
        if relative is None:
            relative = 1e-2
        else:
            safe, relative = 0.9 * relative ** 1.618, 0.9 * (norm / before) ** 1.618
            relative = min(max(relative, safe) if safe > 0.1 else relative, 1e-2)
        before = norm
        updated.array[:] = diagonal.array + free_volume * np.cosh(psi.array)
        jacobian.setDiagonal(updated)
        solver.getPC().setReusePreconditioner(preconditioner == "boomeramg" and number > 0)
        solver.setTolerances(rtol=relative)
        solver.solve(residual, step)
        iterations += solver.getIterationNumber()
        psi.axpy(-1.0, step)
    raise SystemExit("compare_pb.py: dolfinx did not converge")


def solve(points, cells, preconditioner, stages):
    domain = make_domain(points, cells)
    stages.lap("topology")
    space = fem.FunctionSpace(domain, ("Lagrange", 1))
    lid = 4 * math.atanh(math.tanh(5 / 4) * math.exp(-1))
    parts = [(fem.locate_dofs_geometrical(space, lambda x, z=z: np.isclose(x[2], z)), value)
             for z, value in ((0, 5.0), (1, lid))]
    fixed = np.concatenate([nodes for nodes, _ in parts])
    values = np.concatenate([np.full(len(nodes), value) for nodes, value in parts])
    stages.lap("space")
    of_stiffness, of_volume = forms(space)
    stiffness = fem.petsc.assemble_matrix(of_stiffness)
    stiffness.assemble()
    volume = fem.petsc.assemble_vector(of_volume)
    stages.lap("matrix")
    psi, steps, iterations = newton(stiffness, volume, fixed, values, preconditioner)
    stages.lap("solve")
    product = stiffness.createVecRight()
    stiffness.mult(psi, product)
    energy = psi.dot(product) / 2 + float(np.dot(volume.array, np.cosh(psi.array) - 1))
    return domain, steps, iterations, energy


def main():
    logging.disable(logging.INFO)  # of the compiler of forms
    solve(np.array([[0., 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]), np.array([[0, 1, 2, 3]]), "jacobi", Stages())
    with h5py.File(sys.argv[1]) as file:
        points = file["VTKHDF/Points"][:]
        cells = file["VTKHDF/Connectivity"][:].reshape(-1, 4)
    restart_peak()
    before = resident("VmRSS:")
    stages = Stages()
    domain, steps, iterations, energy = solve(points, cells, sys.argv[2], stages)
    print(json.dumps({"cells": domain.topology.index_map(3).size_global, "seconds": stages.seconds,
                      "newton_iterations": steps, "linear_iterations": iterations, "energy": energy,
                      "peak_to_solution_bytes": resident("VmHWM:"), "bytes_before_topology": before}))


if __name__ == "__main__":
    main()
