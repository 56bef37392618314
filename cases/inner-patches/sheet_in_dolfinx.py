#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""sheet_in_dolfinx.py OUT LEVELS: on each level the integral of 1 + x + 2 y over the sheet (dS of its tag) and over the lid (ds)."""
import json
import logging
import pathlib
import sys

import ufl
from dolfinx import fem
from mpi4py import MPI

import pamr

logging.disable(logging.INFO)  # the compiler of the forms logs each of its commands
out, levels = pathlib.Path(sys.argv[1]), int(sys.argv[2])
found = []
for level in range(levels + 1):
    back = pamr.to_dolfinx(pamr.Mesh.read(MPI.COMM_WORLD, str(out / f"sheet-1/level{level}.hdf")))
    x = ufl.SpatialCoordinate(back.mesh)
    on, at = (ufl.Measure(kind, back.mesh, subdomain_data=back.facet_tags) for kind in ("dS", "ds"))
    values = [fem.assemble_scalar(fem.form(form)) for form in
              ((1 + x[0]("+") + 2 * x[1]("+")) * on(7), (1 + x[0] + 2 * x[1]) * at(12))]
    found.append([MPI.COMM_WORLD.allreduce(value, MPI.SUM) for value in values])
if MPI.COMM_WORLD.rank == 0:
    (out / "dolfinx.json").write_text(json.dumps(found))
