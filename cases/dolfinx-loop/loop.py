#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""dolfinx solves, PAMR marks and refines, in one program and in memory; a table of the levels is its output. `-m mpi4py` ends all ranks
where one of them fails.

    mpirun -n 2 python3 -m mpi4py loop.py fichera --levels 6 --table fichera.csv --record marks.npz
"""
from __future__ import annotations

import argparse
import csv
import ctypes
import gc
import logging
import sys
import time

import dolfinx
import numpy as np
import pamr
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import LinearProblem
from mpi4py import MPI
from pamr import dolfinx_versions as versions

from problems import PROBLEMS

COMM = MPI.COMM_WORLD
SOLVER = {"ksp_type": "cg", "pc_type": "hypre", "ksp_rtol": 1e-10}


def solve(problem, mesh):
    """The finite element solution of first order on a mesh of dolfinx."""
    space = versions.function_space(mesh, ("Lagrange", 1))
    x = ufl.SpatialCoordinate(mesh)
    trial, test = ufl.TrialFunction(space), ufl.TestFunction(space)
    inner = ufl.dx(metadata={"quadrature_degree": 4})
    mesh.topology.create_connectivity(2, 3)
    facets = dolfinx.mesh.exterior_facet_indices(mesh.topology)
    wall = fem.Function(space)
    wall.interpolate(problem.boundary_values)
    fixed = fem.dirichletbc(wall, fem.locate_dofs_topological(space, 2, facets))
    source = problem.source(x)
    source = fem.Constant(mesh, 0.0) if source is None else source
    return LinearProblem(ufl.dot(ufl.grad(trial), ufl.grad(test)) * ufl.dx, source * test * inner, [fixed],
                         petsc_options=SOLVER).solve()


def errors(problem, mesh, solution):
    """Norms of the error over those of the solution: in L2, and of the gradient."""
    x = ufl.SpatialCoordinate(mesh)
    exact = problem.exact(x)
    measure = ufl.dx(metadata={"quadrature_degree": 6})

    def norm(form):
        return np.sqrt(COMM.allreduce(fem.assemble_scalar(fem.form(form * measure))))
    error = solution - exact
    return (norm(error ** 2) / norm(exact ** 2),
            norm(ufl.dot(ufl.grad(error), ufl.grad(error))) / norm(ufl.dot(ufl.grad(exact), ufl.grad(exact))))


def peak_since_reset():
    """Bytes of this process: the peak since `reset_peak`, and now."""
    size = {}
    with open("/proc/self/status", encoding="ascii") as status:
        for line in status:
            if line.startswith(("VmHWM", "VmRSS")):
                size[line[:5]] = int(line.split()[1]) * 1024
    return size["VmHWM"], size["VmRSS"]


def reset_peak():
    gc.collect()
    ctypes.CDLL("libc.so.6").malloc_trim(0)  # what was freed before does not hide what is taken
    with open("/proc/self/clear_refs", "w", encoding="ascii") as file:
        file.write("5")


class Pamr:
    """PAMR holds the mesh, dolfinx gets it at every level."""

    def __init__(self, mesh, project):
        self.mesh, self.project = mesh, project

    def to_dolfinx(self):
        self.given = pamr.to_dolfinx(self.mesh)
        return self.given.mesh

    def marks(self, solution, arguments):
        self.mesh.node_fields["u"] = pamr.dolfinx_values(self.given, solution)
        return flags_of(self.mesh, arguments)

    def refine(self, flags):
        for name in list(self.mesh.node_fields):
            del self.mesh.node_fields[name]
        self.mesh = pamr.refine(self.mesh, flags, project=self.project).mesh

    def as_pamr(self):
        return self.mesh


class Dolfinx:
    """dolfinx holds the mesh and refines it with its own `refine` (bisection of edges); the marks are those of PAMR all the same."""

    def __init__(self, mesh):
        if COMM.size > 1:
            raise SystemExit("--refiner dolfinx: expected one process")
        self.mesh = pamr.to_dolfinx(mesh).mesh
        self.ours, self.edges = mesh, None

    def to_dolfinx(self):
        self.ours = pamr.from_dolfinx(self.mesh)
        return self.mesh

    def marks(self, solution, arguments):
        self.ours.node_fields["u"] = pamr.dolfinx_values(self.ours, solution)
        flags = flags_of(self.ours, arguments)
        self.edges = versions.edges_of(self.mesh, np.flatnonzero(flags).astype(np.int32))  # not part of what is timed
        return flags

    def refine(self, flags):
        self.mesh = versions.refined(self.mesh, self.edges)

    def as_pamr(self):
        return self.ours


def flags_of(mesh, arguments):
    if arguments.uniform:
        return np.ones(len(mesh.cells), np.uint8)
    return pamr.mark.flags(mesh, pamr.mark.recovered_error(mesh, "u", bulk=arguments.bulk), max_cells=arguments.max_cells)


def wall_points(mesh):
    return mesh.points[np.unique(mesh.boundary_faces().nodes)]


def run(arguments):
    logging.getLogger().setLevel(logging.WARNING)  # the compiler of forms tells every step
    problem = PROBLEMS[arguments.problem]
    start = pamr.balance(problem.mesh(COMM))
    refiner = Pamr(start, not arguments.no_project) if arguments.refiner == "pamr" else Dolfinx(start)
    replayed = np.load(arguments.replay) if arguments.replay else None
    table, recorded = [], {}
    refine_seconds = refine_bytes = 0.0
    for level in range(arguments.levels + 1):
        flags = None
        if replayed is not None:  # the marks of an earlier run, by the cells' numbers; nothing is solved
            if f"level{level}" in replayed:
                flags = np.isin(refiner.mesh.cell_numbers, replayed[f"level{level}"]).astype(np.uint8)
        else:
            mesh = refiner.to_dolfinx()
            solution = solve(problem, mesh)
            ours = refiner.as_pamr()
            l2, h1 = errors(problem, mesh, solution)
            table.append({"level": level, "cells": ours.n_cells,
                          "unknowns": solution.function_space.dofmap.index_map.size_global, "l2": l2, "h1": h1,
                          "min_mean_ratio": pamr.quality(ours)["mean_ratio"]["min"],
                          "off_wall": COMM.allreduce(problem.off_wall(wall_points(ours)), MPI.MAX),
                          "refine_seconds": refine_seconds, "refine_bytes": refine_bytes})
            if COMM.rank == 0:
                print("  ".join(f"{k} {v:.4g}" if isinstance(v, float) else f"{k} {v}" for k, v in table[-1].items()),
                      flush=True)
            if level < arguments.levels:
                flags = refiner.marks(solution, arguments)
                if arguments.record:
                    numbers = COMM.gather(ours.cell_numbers[flags > 0])
                    recorded[f"level{level}"] = np.concatenate(numbers) if COMM.rank == 0 else None
            del mesh, solution, ours
        if level == arguments.levels or flags is None:
            break
        reset_peak()
        before = peak_since_reset()[1]
        begin = time.process_time()
        refiner.refine(flags)
        refine_seconds = COMM.allreduce(time.process_time() - begin)
        refine_bytes = COMM.allreduce(float(peak_since_reset()[0] - before))
    if COMM.rank == 0 and arguments.record:
        np.savez(arguments.record, **recorded)
    if COMM.rank == 0 and arguments.table and table:
        with open(arguments.table, "w", newline="", encoding="ascii") as file:
            writer = csv.DictWriter(file, table[0].keys())
            writer.writeheader()
            writer.writerows(table)
    if arguments.mesh:
        refiner.as_pamr().write(arguments.mesh)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("problem", choices=PROBLEMS)
    parser.add_argument("--levels", type=int, default=6, help="refinements")
    parser.add_argument("--bulk", type=float, default=0.5, help="part of the squared error that marked cells have")
    parser.add_argument("--max-cells", type=int, default=400_000)
    parser.add_argument("--uniform", action="store_true", help="mark every cell")
    parser.add_argument("--no-project", action="store_true", help="leave new nodes of the boundary between the old ones")
    parser.add_argument("--refiner", choices=("pamr", "dolfinx"), default="pamr")
    parser.add_argument("--table", help="CSV file to write")
    parser.add_argument("--mesh", help="file for the last mesh")
    parser.add_argument("--record", help="file for the marks of every level")
    parser.add_argument("--replay", help="marks of an earlier run: refine by them, solve nothing")
    run(parser.parse_args())


if __name__ == "__main__":
    sys.exit(main())
