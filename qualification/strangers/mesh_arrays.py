# SPDX-License-Identifier: GPL-3.0-or-later
"""What a mesh file holds, found without PAMR's code: from the arrays alone, and by OpenFOAM's checkMesh."""
import os
import re
import subprocess

import h5py
import numpy as np

SYSTEM = {  # what OpenFOAM wants to read first
    "controlDict": "startFrom startTime; startTime 0; stopAt endTime; endTime 1; deltaT 1; writeControl timeStep; writeInterval 1;",
    "fvSchemes": "ddtSchemes {} gradSchemes {} divSchemes {} laplacianSchemes {} interpolationSchemes {} snGradSchemes {}",
    "fvSolution": "",
}
FACES = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])


class Mesh:
    """The arrays of a native file. Triangles of the boundary point out of the mesh."""

    def __init__(self, path):
        with h5py.File(path) as file:
            self.points = file["VTKHDF/Points"][:]
            self.cells = file["VTKHDF/Connectivity"][:].reshape(-1, 4)
            neighbors = self.neighbors = file["PAMR/cell_to_cell"][:]
            fields = file["VTKHDF/CellData"]
            self.region = fields["region"][:] if "region" in fields else np.zeros(len(self.cells), int)
            names = [name.decode() for name in file["PAMR/patches/names"][:]]
        self.triangles = {}
        for number, name in enumerate(names):
            cell, face = np.nonzero(neighbors == -(number + 1))
            self.triangles[name] = np.take_along_axis(self.cells[cell], FACES[face], axis=1)

    def volumes(self):
        a, b, c, d = (self.points[self.cells[:, i]].astype(np.longdouble) for i in range(4))
        return (np.cross(b - a, c - a) * (d - a)).sum(axis=1) / 6

    def area(self, patch):
        a, b, c = (self.points[self.triangles[patch][:, i]] for i in range(3))
        return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2

    def nodes_of(self, patch):
        return self.points[np.unique(self.triangles[patch])]

    def off_plane(self, patch):
        """Largest distance of its nodes from the plane that fits them best."""
        points = self.nodes_of(patch)
        points = points - points.mean(axis=0)
        return abs(points @ np.linalg.svd(points, full_matrices=False)[2][2]).max()

    def regions(self):
        """Volume of each."""
        volumes = self.volumes()
        return {int(r): float(volumes[self.region == r].sum()) for r in np.unique(self.region)}

    def area_between_regions(self):
        cell, face = np.nonzero(self.neighbors > np.arange(len(self.cells))[:, None])
        differs = self.region[self.neighbors[cell, face]] != self.region[cell]
        a, b, c = (self.points[np.take_along_axis(self.cells[cell], FACES[face], axis=1)[differs, i]] for i in range(3))
        return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2

    def faults(self):
        """In words; none for a conforming mesh of positive cells whose boundary is that of its patches."""
        found = []
        volumes = self.volumes()
        if not (volumes > 0).all():
            found.append(f"{(~(volumes > 0)).sum()} cells without positive volume")
        faces = np.sort(self.cells[:, FACES].reshape(-1, 3), axis=1)
        kinds, times = np.unique(faces, axis=0, return_counts=True)
        if times.max() > 2:
            found.append(f"{(times > 2).sum()} faces of more than two cells")
        boundary = np.sort(np.concatenate(list(self.triangles.values())), axis=1)
        boundary = boundary[np.lexsort(boundary.T[::-1])]
        if not np.array_equal(kinds[times == 1], boundary):
            found.append("faces of one cell are not those of the patches: a hanging node")
        if len(np.unique(self.points, axis=0)) != len(self.points):
            found.append("two nodes in one place")
        return found


def check_mesh(folder):
    """Complaints of OpenFOAM about the topology and the signs of its mesh (not about angles: Gmsh's have them, too)."""
    (folder / "system").mkdir(exist_ok=True)
    for name, body in SYSTEM.items():
        (folder / "system" / name).write_text(f"FoamFile {{ version 2.0; format ascii; class dictionary; object {name}; }}\n{body}\n")
    environment = os.environ.copy()
    if os.path.isdir("/usr/share/openfoam/etc"):  # where Debian has it
        environment.setdefault("WM_PROJECT_DIR", "/usr/share/openfoam")
    done = subprocess.run(["checkMesh", "-case", str(folder), "-allTopology"], capture_output=True, text=True, timeout=300,
                          env=environment)
    said = done.stdout
    if "End" not in said:
        return ["checkMesh did not end: " + (done.stderr or said)[-300:]]
    angles = re.compile(r"non-orthogonality|skew|aspect ratio|wedge|two or more|underdetermined|Failed \d+ mesh check", re.I)
    return [line.strip() for line in said.splitlines() if "***" in line and not angles.search(line)]
