# SPDX-License-Identifier: GPL-3.0-or-later
"""Decomposed cases of OpenFOAM: folders processorN with a mesh each and with the numbers that its cells, faces, points and
patches have in the whole (``*ProcAddressing``). Local: works on folders.

Source of the format: OpenFOAM's documentation of decomposePar and the source of processorPolyPatch (a face between two
processors has the corners of the other side in reverse, beginning with the same one).
"""
from __future__ import annotations

import os
import re
import shutil
from dataclasses import dataclass, replace
from typing import Any, Optional, Union

import numpy as np

from ._core import Error
from .foam_file import FieldFile, Values, header, list_bytes, read_bytes, read_field, write_bytes

MESH = os.path.join("constant", "polyMesh")
NAMES = ("cellProcAddressing", "faceProcAddressing", "pointProcAddressing", "boundaryProcAddressing")


def processors(case: str) -> list[str]:
    """Folders processor0, processor1, ... of a case."""
    found = []
    while os.path.isdir(os.path.join(case, f"processor{len(found)}")):
        found.append(os.path.join(case, f"processor{len(found)}"))
    return found


def remove(folders: list[str]) -> None:
    """Removes folders of processors, the last one first, so that what is left has no gap."""
    for folder in reversed(folders):
        shutil.rmtree(folder)


@dataclass
class _Patch:
    name: str
    text: str  #: of its entry, without nFaces and startFace
    start: int
    n: int


def _body(path: str) -> bytes:
    """What comes after the header."""
    data = read_bytes(path)
    head = re.search(rb"FoamFile\s*\{.*?\}", data, re.S)
    if not head or b"binary" in head.group():
        raise Error(f"file '{path}': expected a text file of OpenFOAM")
    return re.sub(rb"//[^\n]*|/\*.*?\*/", b" ", data[head.end():], flags=re.S)


def _numbers(path: str, dtype: Any) -> np.ndarray:
    """All numbers of a list but the first, which counts the rows."""
    text = _body(path).translate(bytes.maketrans(b"()", b"  "))
    return np.array(text.split(), dtype=float if dtype is float else np.int64)[1:]


def _patches(case: str) -> list[_Patch]:
    text = _body(os.path.join(case, MESH, "boundary")).decode()
    result = []
    for name, entry in re.findall(r'([^\s(){}]+)\s*\{(.*?)\}', text, re.S):
        n, start = (int(re.search(rf"\b{key}\s+(\d+)\s*;", entry)[1]) for key in ("nFaces", "startFace"))
        rest = re.sub(r"\b(nFaces|startFace)\s+\d+\s*;", "", entry)
        result.append(_Patch(name, " ".join(rest.split()), start, n))
    return result


@dataclass
class _Whole:
    """The mesh of a case."""
    points: np.ndarray
    faces: np.ndarray
    owner: np.ndarray
    neighbor: np.ndarray
    patches: list[_Patch]


def _read_whole(case: str) -> _Whole:
    at = os.path.join(case, MESH)
    faces = _numbers(os.path.join(at, "faces"), int).reshape(-1, 4)[:, 1:]  # each row begins with its 3
    return _Whole(_numbers(os.path.join(at, "points"), float).reshape(-1, 3), faces,
                  _numbers(os.path.join(at, "owner"), int), _numbers(os.path.join(at, "neighbour"), int), _patches(case))


def _write_list(folder: str, location: str, kind: str, name: str, lines: list[str], note: str = "") -> None:
    text = header(kind, location, name, note) + f"{len(lines)}\n(\n" + "\n".join(lines) + ("\n" if lines else "") + ")\n"
    write_bytes(os.path.join(folder, name), text.encode())


def decompose_mesh(case: str, of_cell: np.ndarray) -> None:
    """Writes the meshes of the processors, from that in constant/polyMesh and the processor of each cell."""
    whole = _read_whole(case)
    n_parts = int(of_cell.max(initial=0)) + 1
    counts = np.bincount(of_cell, minlength=n_parts)
    if (counts == 0).any():
        raise Error(f"ranks: expected cells on each of {n_parts} processors, found none on {int(np.argmin(counts))}")
    for number in range(n_parts):
        _write_part(case, whole, of_cell, number)
    _write_number(case, n_parts)


def _write_number(case: str, n_parts: int) -> None:
    """The number of processors where parallel solvers look for it."""
    path = os.path.join(case, "system", "decomposeParDict")
    os.makedirs(os.path.dirname(path), exist_ok=True)
    text, entry = "", f"numberOfSubdomains {n_parts};"
    if os.path.exists(path):
        with open(path, encoding="utf-8") as file:
            text = file.read()
    changed, n = re.subn(r"\bnumberOfSubdomains\s+\d+\s*;", entry, text)
    if n == 0:
        changed = (text or header("dictionary", "system", "decomposeParDict") + "method none;\n") + entry + "\n"
    if changed != text:
        write_bytes(path, changed.encode())


def _write_part(case: str, whole: _Whole, of_cell: np.ndarray, number: int) -> None:
    n_inner = len(whole.neighbor)
    cells = np.flatnonzero(of_cell == number)
    new_cell = np.full(len(of_cell), -1)
    new_cell[cells] = np.arange(len(cells))
    here_owner = of_cell[whole.owner] == number
    here_other = of_cell[whole.neighbor] == number
    inner = np.flatnonzero(here_owner[:n_inner] & here_other)
    faces, patches, of_patch = [inner], [], []
    n = len(inner)
    for i, patch in enumerate(whole.patches):
        own = patch.start + np.flatnonzero(here_owner[patch.start:patch.start + patch.n])
        patches.append(f"    {patch.name}\n    {{ {patch.text} nFaces {len(own)}; startFace {n}; }}")
        faces.append(own)
        of_patch.append(i)
        n += len(own)
    border = np.flatnonzero(here_owner[:n_inner] != here_other)
    beyond = np.where(here_owner[border], of_cell[whole.neighbor[border]], of_cell[whole.owner[border]])
    for other in np.unique(beyond):
        own = border[beyond == other]
        patches.append(f"    procBoundary{number}to{other}\n    {{ type processor; inGroups 1(processor); nFaces {len(own)}; "
                       f"startFace {n}; matchTolerance 0.0001; transform unknown; myProcNo {number}; neighbProcNo {other}; }}")
        faces.append(own)
        of_patch.append(-1)
        n += len(own)
    face = np.concatenate(faces)
    turned = ~here_owner[face]
    corners = whole.faces[face]
    corners[turned] = corners[turned][:, [0, 2, 1]]
    points, corner = np.unique(corners, return_inverse=True)
    corner = corner.reshape(-1, 3)
    inside = whole.owner[face]
    inside[turned] = whole.neighbor[face[turned]]
    owner, neighbor = new_cell[inside], new_cell[whole.neighbor[inner]]

    location = f"processor{number}/constant/polyMesh"
    folder = os.path.join(case, f"processor{number}", MESH)
    os.makedirs(folder, exist_ok=True)
    note = f"nPoints:{len(points)}  nCells:{len(cells)}  nFaces:{n}  nInternalFaces:{len(inner)}"

    def labels(kind: str, name: str, values: np.ndarray, note: str = "") -> None:
        _write_list(folder, location, kind, name, list(map(str, values.tolist())), note)
    _write_list(folder, location, "vectorField", "points", [f"({x!r} {y!r} {z!r})" for x, y, z in whole.points[points].tolist()])
    _write_list(folder, location, "faceList", "faces", [f"3({a} {b} {c})" for a, b, c in corner.tolist()])
    labels("labelList", "owner", owner, note)
    labels("labelList", "neighbour", neighbor, note)
    _write_list(folder, location, "polyBoundaryMesh", "boundary", patches)
    for name, values in zip(NAMES, (cells, np.where(turned, -(face + 1), face + 1), points, np.array(of_patch))):
        labels("labelList", name, values)


@dataclass
class _Part:
    """What the folder of a processor says of its place in the whole."""
    cells: np.ndarray
    faces: np.ndarray  #: numbers in the whole, from 0
    patches: list[_Patch]


def _read_part(folder: str) -> _Part:
    at = os.path.join(folder, MESH)
    cells, faces = (_numbers(os.path.join(at, name), int) for name in NAMES[:2])
    return _Part(cells, np.abs(faces) - 1, _patches(folder))


def split_field(case: str, parts: list[str], time: str, file: FieldFile, rows: np.ndarray) -> None:
    """Writes a field of the whole mesh, with values in all cells, into the folders of the processors."""
    if not parts:
        return
    starts = {patch.name: patch.start for patch in _patches(case)}
    owner, neighbor = (_numbers(os.path.join(case, MESH, name), int) for name in ("owner", "neighbour"))
    for folder in parts:
        part = _read_part(folder)
        faces = {patch.name: part.faces[patch.start:patch.start + patch.n] for patch in part.patches}
        inside = np.zeros(len(rows), bool)
        inside[part.cells] = True

        def own(item: Union[bytes, Values]) -> Union[bytes, Values]:
            if isinstance(item, bytes) or item.text is not None:
                return item
            if item.place == ("internalField",):
                return replace(item, rows=item.rows[part.cells])
            if len(item.rows) == 0:
                return item
            return replace(item, rows=item.rows[faces[item.place[1]] - starts[item.place[1]]])
        data = replace(file, parts=[own(item) for item in file.parts]).to_bytes()
        entries = b""
        for name in (name for name in faces if name.startswith("procBoundary")):
            beyond = np.where(inside[owner[faces[name]]], neighbor[faces[name]], owner[faces[name]])
            entries += (f"    {name}\n    {{\n        type            processor;\n        value           ".encode()
                        + list_bytes(file.kind, rows[beyond], file.is_binary) + b";\n    }\n")
        write_bytes(os.path.join(folder, time, file.name), _with_entries(data, file.name, entries))


def _with_entries(data: bytes, name: str, entries: bytes) -> bytes:
    """A field file with more entries at the beginning of its boundaryField."""
    found = re.search(rb"\bboundaryField\s*\{\s*?\n?", data)
    if not found:
        raise Error(f"field '{name}': expected an entry boundaryField, found none")
    return data[:found.end()] + entries + data[found.end():]


def joined(case: str, parts: list[str], time: str, name: str) -> FieldFile:
    """A field of the whole mesh from the files of the processors."""
    places = [_read_part(folder) for folder in parts]
    files = [read_field(os.path.join(folder, time, name)) for folder in parts]
    n_cells = sum(len(place.cells) for place in places)
    whole = {patch.name: patch for patch in _patches(case)}
    values = [file.values() for file in files]
    file_kind = files[0].kind

    def put(result: Optional[np.ndarray], n: int, rows: np.ndarray, to: np.ndarray) -> np.ndarray:
        if result is None:
            result = np.zeros((n,) + rows.shape[1:])
        result[to] = rows
        return result

    def merged(item: Union[bytes, Values]) -> Union[bytes, Values]:
        if isinstance(item, bytes):
            return item
        of_parts = [v.get(item.place) for v in values]
        result, kind, with_faces = None, item.kind, []
        for place, v in zip(places, of_parts):
            if item.place == ("internalField",):
                n, to = n_cells, place.cells
            else:
                patch = next((p for p in place.patches if p.name == item.place[1]), None)
                if patch is None or item.place[1] not in whole:
                    raise Error(f"field '{name}': expected values of patches of the mesh, found '{item.place[1]}'")
                n = whole[item.place[1]].n
                to = place.faces[patch.start:patch.start + patch.n] - whole[item.place[1]].start
            if len(to) == 0:
                continue
            if v is None:
                raise Error(f"field '{name}', {'/'.join(item.place)}: expected values in all of {len(parts)} folders of "
                            f"processors, found none in one")
            kind = v.kind
            with_faces.append(v)
            result = put(result, n, v.rows, to)
        if with_faces and with_faces[0].text is not None and all(v.text == with_faces[0].text for v in with_faces):
            return with_faces[0]
        rows = item.rows[:0] if result is None else result
        return Values(item.place, file_kind if item.place == ("internalField",) else kind, rows)
    return replace(files[0], parts=[merged(item) for item in files[0].parts])
