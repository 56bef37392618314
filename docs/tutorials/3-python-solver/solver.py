# SPDX-License-Identifier: GPL-3.0-or-later
"""A finite-element solver of 40 lines in the loop: solve, estimate, refine.

    solver.py FOLDER [--cells N]

-lap u = f in the unit ball, u = 0 on the sphere, with the solution u = (1 - r^2) exp(-60 |p - q|^2): a bump near the wall, so that the
curved wall counts and most of the ball needs no small cells.
"""
import argparse
import pathlib

import numpy as np
import pamr
from mpi4py import MPI

CENTER = np.array([0.55, 0.2, 0.1])


def exact(p):
    return (1 - (p ** 2).sum(axis=1)) * np.exp(-60 * ((p - CENTER) ** 2).sum(axis=1))


def source(p):
    """-lap of the solution."""
    d = p - CENTER
    bump = np.exp(-60 * (d ** 2).sum(axis=1))
    laplace_bump = (14400 * (d ** 2).sum(axis=1) - 360) * bump
    return -((1 - (p ** 2).sum(axis=1)) * laplace_bump + 480 * (p * d).sum(axis=1) * bump - 6 * bump)


def solve(mesh):
    """Linear elements: the potential on the nodes, by conjugate gradients."""
    p, cells = mesh.points, mesh.cells
    edges = p[cells[:, 1:]] - p[cells[:, :1]]
    volume = np.abs(np.linalg.det(edges)) / 6
    gradients = np.linalg.inv(edges).transpose(0, 2, 1)  # of the barycentric coordinates of corners 1 to 3
    gradients = np.concatenate([-gradients.sum(axis=1, keepdims=True), gradients], axis=1)
    stiffness = np.einsum("c,cid,cjd->cij", volume, gradients, gradients)
    load = np.bincount(cells.ravel(), (source(p[cells].mean(axis=1)) * volume / 4).repeat(4), len(p))
    free = np.ones(len(p), bool)
    free[mesh.boundary_faces().nodes.ravel()] = False

    def apply(u):
        return free * np.bincount(cells.ravel(), np.einsum("cij,cj->ci", stiffness, u[cells]).ravel(), len(p))

    diagonal = np.bincount(cells.ravel(), np.einsum("cii->ci", stiffness).ravel(), len(p))
    u, r = np.zeros(len(p)), free * load
    z = r / diagonal
    d, rz = z, r @ z
    for _ in range(2000):
        q = apply(d)
        u, r = u + rz / (d @ q) * d, r - rz / (d @ q) * q
        if r @ r < 1e-20 * (load @ load):
            break
        z = r / diagonal
        d, rz = z + (r @ z) / rz * d, r @ z
    return u


def error_of(mesh, u):
    """L2 norm of the error, by the values in the middle of the cells' edges."""
    pairs = [(i, j) for i in range(4) for j in range(i)]
    squares = [(exact(mesh.points[mesh.cells[:, [i, j]]].mean(axis=1)) - u[mesh.cells[:, [i, j]]].mean(axis=1)) ** 2 for i, j in pairs]
    return np.sqrt((mesh.volumes() * np.mean(squares, axis=0)).sum())


def ball(comm):
    points = np.array([[0, 0, 0], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
    cells = np.array([[0, x, y, z] for x in (1, 2) for y in (3, 4) for z in (5, 6)])
    mesh = pamr.Mesh.from_arrays(comm, points, cells, (cells[:, 1:], np.full(8, 1)), {1: "wall"}, repair=True)
    mesh.associate({"wall": pamr.Sphere(center=(0, 0, 0), radius=1)})
    for _ in range(3):
        mesh = pamr.refine(mesh, np.ones(len(mesh.cells), bool)).mesh
    return mesh


def run(choose, max_cells):
    """Rows of cells and error; the last mesh with the solution as a field."""
    mesh, rows = ball(MPI.COMM_SELF), []
    while True:
        u = solve(mesh)
        rows.append((mesh.n_cells, error_of(mesh, u)))
        print(f"{rows[-1][0]:9d} cells, error {rows[-1][1]:.3e}")
        mesh.node_fields["u"] = u
        flags = choose(mesh)
        if pamr.forecast(mesh, flags)[0] > max_cells:
            return rows, mesh
        mesh = pamr.refine(mesh, flags).mesh


def plot(folder, uniform, adaptive):
    try:
        import matplotlib
        matplotlib.use("Agg")
        from matplotlib import pyplot
    except ImportError:
        return
    figure, axes = pyplot.subplots(figsize=(6.4, 4.4), layout="constrained")
    for rows, name, mark in ((uniform, "every cell", "s-"), (adaptive, "where the estimate asks", "o-")):
        axes.loglog(*zip(*rows), mark, label=name)
    axes.set(xlabel="cells", ylabel="error, L2 norm", title="-lap u = f in the ball, linear elements")
    axes.grid(True, which="both", alpha=0.3)
    axes.legend()
    figure.savefig(folder / "error.png", dpi=110)


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("folder", type=pathlib.Path)
    arguments.add_argument("--cells", type=int, default=60000, help="the most cells (default %(default)s)")
    options = arguments.parse_args()
    print("every cell refined")
    uniform, _ = run(lambda mesh: np.ones(len(mesh.cells), bool), options.cells)
    print("where the estimate asks")
    adaptive, mesh = run(lambda mesh: pamr.mark.flags(mesh, pamr.mark.recovered_error(mesh, "u", bulk=0.5)), options.cells)
    mesh.write(str(options.folder / "solution.hdf"))
    plot(options.folder, uniform, adaptive)
    best = min(error for cells, error in adaptive if cells <= uniform[-1][0])
    assert best < 0.5 * uniform[-1][1], "refining where the estimate asks must pay"


if __name__ == "__main__":
    main()
