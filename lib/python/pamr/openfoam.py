# SPDX-License-Identifier: GPL-3.0-or-later
"""A solver of OpenFOAM in the loop: the case of a mesh, fields back from it, and onto the refined mesh::

    from pamr import openfoam

    openfoam.write_mesh(mesh, "level0")                       # and processorN with ranks=...
    # the solver runs in level0, from the fields in level0/0
    fields = openfoam.read_fields(mesh, "level0", "1")        # mesh.cell_fields["T"] and so on, and what the files say beside
    result = pamr.refine(mesh, pamr.mark.flags(mesh, ...))
    openfoam.write_mesh(result.mesh, "level1")
    openfoam.write_fields(fields.after(result), "level1", "0")

Values in cells keep their integrals. Everything else in a field file stays as it is written: dimensions and the entries of
boundaryField, of which lists get the value of the face that each new face is part of. All functions are collective; files are
read and written by rank 0.
"""
from __future__ import annotations

import os
import re
from dataclasses import dataclass, replace
from typing import Any, Iterable, Optional, Union

import numpy as np

from . import _core, foam_case
from ._core import Error
from .foam_file import COMPONENTS, FieldFile, Values, class_of, read_field, write_bytes
from .mesh import Mesh
from .said import listed, say
from .stages import RefineResult
from .together import agree, integers

__all__ = ["FoamFields", "read_fields", "write_fields", "write_mesh"]
_CARRIED = re.compile(r"vol(Scalar|Vector|SymmTensor|Tensor)Field")
_OF_TIME = ("polyMesh", "uniform")  # folders of a mesh that moves and of the time itself


@dataclass
class _Faces:
    """Faces of the whole boundary in the order of OpenFOAM, on rank 0; none on the others."""
    patch: np.ndarray   #: n
    cell: np.ndarray    #: n, numbers from 0
    parent: np.ndarray  #: n, numbers from 0 in the mesh before; empty without one
    center: np.ndarray  #: n x 3
    normal: np.ndarray  #: n x 3, unit vectors


def _first_cell(mesh: Mesh) -> int:
    """The lowest number of a cell. Collective."""
    from mpi4py import MPI
    return mesh.comm.allreduce(int(mesh.cell_numbers.min(initial=np.iinfo(np.int64).max)), MPI.MIN)


def _numbers(mesh: Mesh) -> np.ndarray:
    """Numbers of this rank's cells from 0. Collective."""
    return mesh.cell_numbers - _first_cell(mesh)


def _faces(mesh: Mesh, parent: Optional[np.ndarray] = None, first_parent: int = 0) -> Optional[_Faces]:
    faces = mesh.boundary_faces()
    corners = mesh.points[faces.nodes]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    of_parent = np.empty(0, np.int64) if parent is None else parent[faces.cells] - first_parent
    mine = (faces.patches, _numbers(mesh)[faces.cells], faces.faces, of_parent, corners.mean(axis=1), normal)
    gathered = mesh.comm.gather(mine)
    if gathered is None:
        return None
    patch, cell, face, of_parent, center, normal = (np.concatenate(parts) for parts in zip(*gathered))
    order = np.lexsort((face, cell, patch))
    return _Faces(patch[order], cell[order], of_parent[order] if parent is not None else of_parent, center[order],
                  normal[order])


def _old_faces(old: _Faces, new: _Faces) -> np.ndarray:
    """Of each new face the old one that it is part of: a face of its cell's parent, in its patch, of the nearest direction; where
    the parent has none there (transition cells were undone), the nearest of the patch."""
    n_cells = int(max(old.cell.max(initial=0), new.parent.max(initial=0))) + 1
    key = old.patch.astype(np.int64) * n_cells + old.cell  # ascends
    wanted = new.patch.astype(np.int64) * n_cells + new.parent
    begin, end = np.searchsorted(key, wanted), np.searchsorted(key, wanted, side="right")
    best, angle = np.full(len(wanted), -1), np.full(len(wanted), -2.0)
    for step in range(4):
        some = np.flatnonzero(begin + step < end)
        other = begin[some] + step
        cosine = (new.normal[some] * old.normal[other]).sum(axis=1)
        better = cosine > angle[some]
        best[some[better]], angle[some[better]] = other[better], cosine[better]
    for face in np.flatnonzero(best < 0):
        first, last = np.searchsorted(old.patch, [new.patch[face], new.patch[face] + 1])
        distance = ((old.center[first:last] - new.center[face]) ** 2).sum(axis=1)
        best[face] = first + int(np.argmin(distance))
    return best


@dataclass
class FoamFields:
    """Fields of a case. Their values in cells are cell fields of ``mesh`` of the same names."""
    mesh: Mesh
    names: list[str]                       #: of the fields
    not_carried: list[str]                 #: what else the folder holds: fields on faces or points, particles, ...
    _files: Optional[list[FieldFile]]      #: on rank 0
    _faces: Optional[_Faces]

    def after(self, result: RefineResult) -> "FoamFields":
        """The same fields on the refined mesh: lists of boundary values go to the faces that the old ones were split into.
        Collective."""
        comm = self.mesh.comm
        faces = _faces(result.mesh, result.parent, _first_cell(self.mesh))

        def prepare() -> tuple[Any, Any]:
            missing = [name for name in self.names if name not in result.mesh.cell_fields]
            if missing:
                raise Error(f"after: expected the mesh that was refined from the one with these fields, found no cell field "
                            f"'{missing[0]}'")
            if faces is None:
                return None, None
            source = _old_faces(self._faces, faces)
            return [self._mapped(file, faces, source) for file in self._files], None
        return FoamFields(result.mesh, self.names, self.not_carried, agree(comm, prepare), faces)

    def _mapped(self, file: FieldFile, faces: _Faces, source: np.ndarray) -> FieldFile:
        patches = _words(self.mesh)
        parts: list[Union[bytes, Values]] = []
        for part in file.parts:
            if isinstance(part, Values) and part.text is None and part.place[0] == "boundaryField" and len(part.rows):
                patch = patches.index(part.place[1])
                start = int(np.searchsorted(self._faces.patch, patch))
                part = replace(part, rows=part.rows[source[faces.patch == patch] - start])
            parts.append(part)
        return replace(file, parts=parts)


def _words(mesh: Mesh) -> list[str]:
    """Names of the patches as OpenFOAM has them."""
    return [re.sub(r"[^!-~]|[\"'/;{}()\[\]$#\\]", "_", name) for name in mesh.patches]


def write_mesh(mesh: Mesh, case: Union[str, os.PathLike], ranks: Any = None, force: bool = False,
               scale: float = 1.0) -> None:
    """Writes ``constant/polyMesh`` of a case, and with ``ranks`` the decomposed mesh as well: folders ``processorN`` with their
    ``*ProcAddressing``, as decomposePar makes them. Collective.

    ranks: one number from 0 for each cell of this rank (the cell field "rank" of pamr-partition, say), or "own": cells stay
    together as they lie on the ranks of this job. ``system/decomposeParDict`` gets the number of processors.
    force: remove folders ``processorN`` that are there already, which belong to another mesh, with all that is in them; without it
    they are an error. A mesh in ``constant/polyMesh`` is replaced in any case.
    scale: factor for all coordinates, above 0: 0.001 for a mesh in millimeters, since OpenFOAM computes in meters. ``mesh`` and
    its fields stay as they are. Raises pamr.Error for other numbers.
    """
    comm = mesh.comm

    def prepare() -> tuple[Any, Any]:
        if ranks is None or isinstance(ranks, str):
            if ranks not in (None, "own"):
                raise Error(f"ranks: expected numbers or 'own', found {ranks!r}")
            return (None if ranks is None else np.full(len(mesh.cells), comm.rank)), ranks is None
        values = integers("ranks", ranks, (len(mesh.cells),))
        if (values < 0).any():
            raise Error(f"ranks: expected numbers from 0, found {values.min()} for cell {int(np.argmin(values))}")
        return values, False
    of_cell = agree(comm, prepare)

    def prepare_folder() -> tuple[Any, Any]:
        folder, factor = os.fspath(case), float(scale)
        if not (factor > 0 and np.isfinite(factor)):
            raise Error(f"scale: expected a number above 0, found {scale!r}")
        if comm.rank == 0:
            os.makedirs(folder, exist_ok=True)
            old = foam_case.processors(folder)
            if old and not force:
                raise Error(f"case '{folder}': expected no folders of processors, found {len(old)} (force=True removes them)")
            foam_case.remove(old)
        return (folder, factor), (folder, force, factor)
    folder, factor = agree(comm, prepare_folder)
    say(comm, *mesh._core.write_foam(folder, factor))
    if comm.allreduce(0 if of_cell is None else 1) == 0:
        return
    of_all = _to_zero(mesh, of_cell)
    agree(comm, lambda: (foam_case.decompose_mesh(folder, of_all) if comm.rank == 0 else None, None))


def _to_zero(mesh: Mesh, values: np.ndarray) -> Optional[np.ndarray]:
    """Rows of all cells in their order, on rank 0."""
    gathered = mesh.comm.gather((_numbers(mesh), values))
    if gathered is None:
        return None
    result = np.empty((mesh.n_cells,) + gathered[0][1].shape[1:], gathered[0][1].dtype)
    for numbers, rows in gathered:
        result[numbers] = rows
    return result


def _names_in(folder: str, names: Optional[Iterable[str]]) -> tuple[list[str], dict[str, str]]:
    """Fields on cells in a folder of a time, and what each other object is."""
    if not os.path.isdir(folder):
        raise Error(f"folder '{folder}': expected fields of OpenFOAM, found no such folder")
    if names is not None:
        return list(names), {}
    fields: list[str] = []
    others: dict[str, str] = {}
    for name in sorted({n[:-3] if n.endswith(".gz") else n for n in os.listdir(folder)}):
        path = os.path.join(folder, name)
        kind = "a folder" if os.path.isdir(path) else class_of(path)
        if _CARRIED.fullmatch(kind):
            fields.append(name)
        elif kind != "a folder" or name not in _OF_TIME:
            others[name] = kind or "no field"
    if not fields:
        raise Error(f"folder '{folder}': expected fields on cells, found none")
    return fields, others


def read_fields(mesh: Mesh, case: Union[str, os.PathLike], time: str, names: Optional[Iterable[str]] = None) -> FoamFields:
    """Reads the fields on cells that OpenFOAM has in ``case/time``, or in ``case/processorN/time``: text or binary, compressed
    or not. Their values become cell fields of the mesh, which must be the one that the case has, with its cells in the same
    order (pamr.Error where ``constant/polyMesh`` has them in another one). Collective.

    names: of the fields; default: all scalars, vectors, symmetric tensors and tensors on cells. What else the folder holds is in
    ``not_carried``, and a ``pamr.Note`` names it: fields on faces and points (phi), which solvers make anew, particles, others.
    """
    comm = mesh.comm
    path = agree(comm, lambda: (os.fspath(case), os.fspath(case)))
    n_other = _core.other_foam_faces(mesh._core, path)
    if n_other:
        raise Error(f"case '{path}': expected a mesh with the cells of this one in their order, found {n_other} other inner faces: "
                    f"renumberMesh, for one, changes the order (pamr.Mesh.read takes the mesh of a case as it is)")
    faces = _faces(mesh)

    def prepare() -> tuple[Any, Any]:
        if comm.rank != 0:
            return None, None
        folder, n_cells = os.fspath(case), mesh.n_cells
        alone = os.path.join(folder, time)
        parts = foam_case.processors(folder)
        if os.path.isdir(alone) or not parts:
            fields, others = _names_in(alone, names)
            files = [read_field(os.path.join(alone, name)) for name in fields]
        else:
            fields, others = _names_in(os.path.join(parts[0], time), names)
            files = [foam_case.joined(folder, parts, time, name) for name in fields]
        counts = np.bincount(faces.patch, minlength=len(mesh.patches))
        for file in files:
            for place, part in file.values().items():
                if place[0] != "boundaryField" or part.text is not None or len(part.rows) == 0:
                    continue
                if place[1] not in _words(mesh):
                    raise Error(f"field '{file.name}': expected lists of values for patches of the mesh, found '{place[1]}'")
                n = counts[_words(mesh).index(place[1])]
                if len(part.rows) != n:
                    raise Error(f"field '{file.name}', patch '{place[1]}', {place[-1]}: expected {n} values, one for each face, "
                                f"found {len(part.rows)}")
        return (fields, others, files, [file.internal(n_cells) for file in files]), None
    result = agree(comm, prepare)
    fields, others = comm.bcast(result[:2] if result else None)
    shown = [f"{name} ({kind})" for name, kind in others.items()]
    say(comm, [], [f"case '{path}', time {time}: left out, as no field on cells: {listed(shown)}"] if shown else [])
    numbers = comm.gather(_numbers(mesh))
    for i, name in enumerate(fields):
        mesh.cell_fields[name] = comm.scatter([result[3][i][rows] for rows in numbers] if comm.rank == 0 else None)
    return FoamFields(mesh, fields, list(others), result[2] if result else None, faces)


def write_fields(fields: FoamFields, case: Union[str, os.PathLike], time: str = "0") -> None:
    """Writes fields into ``case/time``, with the values of the cell fields of their mesh, and into ``case/processorN/time`` where
    the case has such folders. Fields that were one value everywhere and still are stay one. Collective."""
    mesh, comm = fields.mesh, fields.mesh.comm
    values = [_to_zero(mesh, np.asarray(mesh.cell_fields[name], float)) for name in fields.names]

    def prepare() -> tuple[None, Any]:
        if comm.rank != 0:
            return None, None
        folder = os.fspath(case)
        parts = foam_case.processors(folder)
        for target in [folder] + parts:
            os.makedirs(os.path.join(target, time), exist_ok=True)
        for file, rows in zip(fields._files, values):
            file = replace(file, parts=[_internal(file, part, rows) for part in file.parts])
            write_bytes(os.path.join(folder, time, file.name), file.to_bytes())
            foam_case.split_field(folder, parts, time, file, rows)
        return None, None
    agree(comm, prepare)


def _internal(file: FieldFile, part: Union[bytes, Values], rows: np.ndarray) -> Union[bytes, Values]:
    if isinstance(part, bytes) or part.place != ("internalField",):
        return part
    if part.text is not None and (rows == part.rows).all():
        return part
    if rows.ndim != (1 if COMPONENTS[file.kind] == 1 else 2):
        raise Error(f"field '{file.name}': expected {COMPONENTS[file.kind]} values for each cell, found another shape")
    return Values(part.place, file.kind, rows)
