# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads a Gmsh file by another code, on one process: read_peer.py gmsh|dmplex|mfem|meshio FILE. Prints a line of JSON:
cells; cpu and wall: s of the call; peak: bytes over those before."""

import json
import sys
import time

import workload

TETRAHEDRON = 4


def read_by_gmsh(file):
    import gmsh

    gmsh.initialize()
    gmsh.option.setNumber("General.Verbosity", 1)

    def read():
        gmsh.open(file)
        return len(gmsh.model.mesh.getElementsByType(TETRAHEDRON)[0])

    return "Gmsh " + gmsh.option.getString("General.Version"), read


def read_by_dmplex(file):
    import petsc4py

    petsc4py.init([])
    from petsc4py import PETSc

    def read():
        first, end = PETSc.DMPlex().createFromFile(file, interpolate=True, comm=PETSc.COMM_SELF).getHeightStratum(0)
        return end - first

    return "PETSc DMPlex " + ".".join(map(str, PETSc.Sys.getVersion())), read


def read_by_mfem(file):
    import mfem
    import mfem.ser

    return f"MFEM {mfem.__version__}", lambda: mfem.ser.Mesh(file, 1, 0).GetNE()


def read_by_meshio(file):
    import meshio

    return f"meshio {meshio.__version__}", lambda: len(meshio.read(file).cells_dict["tetra"])


def main(code, file):
    name, read = {"gmsh": read_by_gmsh, "dmplex": read_by_dmplex, "mfem": read_by_mfem, "meshio": read_by_meshio}[code](
        file
    )
    before = workload.status_bytes("VmRSS")
    workload.forget_peak()
    wall, cpu = time.perf_counter(), time.process_time()
    cells = read()
    values = {
        "cpu": time.process_time() - cpu,
        "wall": time.perf_counter() - wall,
        "peak": workload.status_bytes("VmHWM") - before,
    }
    print(json.dumps({"peer": name, "cells": cells, **values}))


main(*sys.argv[1:])
