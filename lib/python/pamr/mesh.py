# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh and its fields."""
from __future__ import annotations

import os
from typing import Any, Iterator, Mapping, MutableMapping, NamedTuple, Optional, Union

import numpy as np

from . import _core
from .rows import described, pack, unpack
from .said import say
from .surfaces import File, Surface, Toml
from .together import agree, description, field as field_in, integers, path_of, reals, require_comm, whole

Error = _core.Error
ORDERS = ("auto", "keep", "curve")


class BoundaryFaces(NamedTuple):
    """The faces of this rank's cells on the boundary, n of them."""
    cells: np.ndarray    #: n, rows of ``Mesh.cells``
    faces: np.ndarray    #: n, 0 to 3: the face opposite this corner of the cell
    patches: np.ndarray  #: n, indices into ``Mesh.patches``
    nodes: np.ndarray    #: n x 3, rows of ``Mesh.points``, counter-clockwise from outside


def _by_number(parts: Any) -> list[dict[int, str]]:
    """Groups of each part by their numbers; those without get the same one below 0 in all parts."""
    free: dict[str, int] = {}
    return [{number if number >= 0 else free.setdefault(name, -1 - len(free)): name for number, name in groups} for groups in parts]


class InnerFaces(NamedTuple):
    """The faces inside the domain that have a patch, from each cell of this rank that has one: a face between two of its cells is
    there twice, n rows in all."""
    cells: np.ndarray    #: n, rows of ``Mesh.cells``
    faces: np.ndarray    #: n, 0 to 3: the face opposite this corner of the cell
    patches: np.ndarray  #: n, indices into ``Mesh.patches``
    nodes: np.ndarray    #: n x 3, rows of ``Mesh.points``, counter-clockwise from outside the cell
    first: np.ndarray    #: n bool: the side of the cell with the lower number, so that each face of the mesh counts once


class Fields(MutableMapping):
    """Fields on cells or on nodes by name: arrays of n values or n x k, float64 or int64, rows of this rank. What is read is
    the mesh's own memory and may be written to, until the field is set or deleted: the mesh then has other memory, and the array
    keeps its values. Setting and deleting are collective: every rank gives a field of the same name, type and k. Refinement
    gives fields to the new mesh: nodal ones linear along edges, those of cells by their parent, where closure cells were taken
    back as means weighted with volume, so that integrals are kept."""

    def __init__(self, mesh: "Mesh", on_cells: bool) -> None:
        self._mesh, self._on_cells = mesh, on_cells

    def __getitem__(self, name: str) -> np.ndarray:
        array = self._mesh._core.get_field(self._on_cells, name) if isinstance(name, str) else None
        if array is None:
            raise KeyError(name)
        return array

    def __setitem__(self, name: str, values: Any) -> None:
        self.set(name, values, self.units.get(name, ""))

    def set(self, name: str, values: Any, unit: str = "") -> None:
        """Adds or replaces a field with a unit. Collective."""
        n = len(self._mesh.cells if self._on_cells else self._mesh.points)

        def prepare() -> tuple[Any, Any]:
            item = field_in(name, values, n, unit)
            return item, description(item)
        self._mesh._core.put_field(self._on_cells, agree(self._mesh.comm, prepare))

    def __delitem__(self, name: str) -> None:
        def prepare() -> tuple[None, Any]:
            if name not in self:
                raise Error(f"field {name!r}: expected a field to remove, found none")
            return None, name
        agree(self._mesh.comm, prepare)
        self._mesh._core.remove_field(self._on_cells, name)

    @property
    def units(self) -> dict[str, str]:
        """The unit of each field."""
        return dict(self._mesh._core.field_names(self._on_cells))

    def __iter__(self) -> Iterator[str]:
        return iter(self.units)

    def __len__(self) -> int:
        return len(self.units)

    def __repr__(self) -> str:
        return f"{'cell' if self._on_cells else 'node'} fields: {', '.join(self) or 'none'}"


class Mesh:
    """A tetrahedral mesh on the ranks of a communicator, valid at all times. Made by ``from_arrays``, ``read``, ``kuhn_cube``,
    ``pamr.from_meshio``, ``pamr.from_dolfinx`` or ``pamr.refine``. Arrays show its memory; they are for reading only, but for
    those of fields."""

    def __init__(self, core: Any, comm: Any) -> None:
        self._core, self._comm = core, comm

    # --- where meshes come from

    @staticmethod
    def from_arrays(comm: Any, points: Any, cells: Any, boundary: Optional[tuple[Any, Any]] = None,
                    names: Optional[Mapping[int, Union[str, tuple[str, str]]]] = None, *,
                    cell_fields: Optional[Mapping[str, Any]] = None, node_fields: Optional[Mapping[str, Any]] = None,
                    length_unit: str = "", order: str = "auto", repair: bool = True,
                    regions: Optional[Mapping[int, str]] = None) -> "Mesh":
        """A mesh from arrays. Collective.

        comm: communicator of mpi4py.
        points: n x 3 floats. Their numbers run over the ranks: rank 0 has the first ones, and so on (none is fine).
        cells: m x 4 integers, numbers of points in the whole mesh; any cells on any rank, of positive volume (``cells``).
        boundary: triangles (t x 3 numbers of points) and their tags (t integers), on any ranks, in any order, of faces on the
            boundary or inside. Faces of the boundary without a triangle form the patch "boundary" ("boundary_2" beside one of
            that name) of kind "untagged".
        names: of the tags: {tag: name} or {tag: (name, kind)}, the same on every rank; otherwise "patch_TAG".
        cell_fields, node_fields: {name: values} for the cells and the points given here.
        order: put cells and nodes along a space-filling curve: "auto" (where it pays), "curve", "keep". ``cell_origin`` and
            ``node_origin`` say which row of the arrays each came from.
        repair: turn inverted cells over, with a warning. Without it they are refused, unless all cells are inverted. ``n_turned`` counts them.
        regions: names of values of the integer cell field "region".
        What is odd or left out (points of no cell, faces without a triangle, names of nothing) is a Python warning on rank 0,
        in the words of pamr-convert for files.
        Raises pamr.Error, the same on every rank, that says which entry is wrong.
        """
        mesh, remarks = Mesh._of_arrays(comm, points, cells, boundary, names, cell_fields, node_fields, length_unit, order, repair,
                                        regions)
        say(comm, remarks)
        return mesh

    @staticmethod
    def _of_arrays(comm: Any, points: Any, cells: Any, boundary: Any, names: Any, cell_fields: Any, node_fields: Any,
                   length_unit: str, order: str, repair: bool, regions: Any, source: str = "arrays", unused: Any = (),
                   finite: bool = True, joint: Any = (), oriented: bool = True) -> tuple["Mesh", list[str]]:
        """The same, with the warnings as texts. Errors begin with ``source``; ``unused``: groups that were left out before; ``finite``:
        whether points have to be finite, where some may be left out; ``joint``: dimension and tag of what stands for several groups,
        and their names by number; ``oriented``: whether cells of negative volume are news."""
        require_comm(comm)
        n_points = [0]

        def prepare_points() -> tuple[Any, Any]:
            if order not in ORDERS:
                raise Error(f"order: expected one of {', '.join(ORDERS)}, found {order!r}")
            array = reals("points", points, (None, 3), finite)
            n_points[0] = len(array)
            at_points = [field_in(k, v, len(array)) for k, v in (node_fields or {}).items()]
            corners = integers("cells", cells, (None, 4))
            at_cells = [field_in(k, v, len(corners)) for k, v in (cell_fields or {}).items()]
            triangles, tags = (np.empty((0, 3)), np.empty(0)) if boundary is None else boundary
            triangles, tags = integers("boundary triangles", triangles, (None, 3)), integers("boundary tags", tags, (None,))
            if len(triangles) != len(tags):
                raise Error(f"boundary: expected a tag for each of {len(triangles)} triangles, found {len(tags)}")
            for tag in names or {}:
                whole("names", tag)
            if regions and not any(k == "region" and v.ndim == 1 and v.dtype == np.int64 for k, _, v, _ in at_cells):
                raise Error("regions: expected names for the values of an integer cell field 'region', found no such field")
            region_names = sorted((whole("regions", number), str(name)) for number, name in (regions or {}).items())
            same = ([description(f) for f in at_points], [description(f) for f in at_cells], order, length_unit,
                    sorted((names or {}).items()), bool(repair), region_names)
            return (array, corners, triangles, tags, at_points, at_cells, region_names), same

        array, corners, triangles, tags, at_points, at_cells, region_names = agree(comm, prepare_points)
        n_all, n_cells = comm.allreduce(n_points[0]), comm.allreduce(len(corners))
        if n_cells == 0:
            raise Error("cells: expected one cell or more, found none on any rank")
        all_tags = sorted(set().union(*comm.allgather(set(np.unique(tags).tolist()))) | set(names or {}))

        def prepare_numbers() -> tuple[Any, Any]:
            for name, rows in (("cells", corners), ("boundary triangles", triangles)):
                bad = np.argwhere((rows < 0) | (rows >= n_all))
                if len(bad):
                    row, column = map(int, bad[0])
                    raise Error(f"{name}: expected numbers of points from 0 to {n_all - 1}, found {rows[row, column]} in "
                                f"row {row}")
            patches = []
            for tag in all_tags:
                name = (names or {}).get(tag, f"patch_{tag}")
                patches.append((tag, name, "") if isinstance(name, str) else (tag, str(name[0]), str(name[1])))
            if len({name for _, name, _ in patches}) != len(patches):
                raise Error("names: expected different names for different tags, found one twice")
            return patches, patches

        given = _core.Given()
        given.patches = agree(comm, prepare_numbers)
        given.points, given.cells, given.triangles, given.tags = array, corners, triangles, tags
        given.cell_fields, given.node_fields = at_cells, at_points
        given.length_unit, given.regions, given.unused = length_unit, region_names, list(unused)
        given.joint = [(dimension, tag, sorted(groups.items())) for dimension, tag, groups in joint]
        given.has_boundary, given.has_orientation = boundary is not None, oriented
        core, n_turned, remarks = _core.from_arrays(_address(comm), given, source, ORDERS.index(order), bool(repair))
        mesh = Mesh(core, comm)
        mesh.n_turned = n_turned
        return mesh, remarks

    #: Cells given with negative volume, which were turned over.
    n_turned: int = 0

    @staticmethod
    def read(comm: Any, file: Union[str, os.PathLike], repair: bool = True, strict: bool = False,
             split_prisms: bool = False) -> "Mesh":
        """A mesh from a file: .hdf or .vtkhdf (of any number of ranks, of PAMR or another program), or in any other format that
        pamr-convert reads. What is odd and does no harm, and what is left out, is a Python warning on rank 0; what lies beside the
        mesh (fields, further regions of an OpenFOAM case) a ``pamr.Note``. Collective.

        repair: turn inverted cells of other programs over, with a warning that counts them. Without it they are refused, unless
            all cells are inverted.
        strict: what would be a warning raises pamr.Error, as with ``pamr-convert --strict``; notes stay notes.
        split_prisms: cut prisms and pyramids of other programs into tetrahedra, and quadrangles into triangles, which raise
            pamr.Error otherwise; a ``pamr.Note`` counts them.
        """
        require_comm(comm)
        given = agree(comm, lambda: 2 * ((path_of(file), bool(repair), bool(strict), bool(split_prisms)),))
        core, *said = _core.read(_address(comm), *given)
        say(comm, *said)
        return Mesh(core, comm)

    @staticmethod
    def kuhn_cube(comm: Any, n: int) -> "Mesh":
        """The unit cube as 6 n^3 cells, with the patches xmin xmax ymin ymax zmin zmax. Collective."""
        require_comm(comm)
        return Mesh(_core.kuhn_cube(_address(comm), agree(comm, lambda: 2 * (whole("n", n, np.int32),))), comm)

    def write(self, file: Union[str, os.PathLike], provenance: str = "") -> None:
        """Writes the mesh and its fields: .hdf or .vtkhdf (complete), any other format that pamr-convert writes (or the boundary, as
        .stl, say), or an OpenFOAM case where the name has no ending or is a folder. The bytes do not depend on the number of
        ranks. What the format has no place for is a Python warning on rank 0; levels, surfaces, numbers of patches and the unit of
        lengths, which only native files keep, a ``pamr.Note``. Collective."""
        path = agree(self._comm, lambda: (path_of(file), (path_of(file), provenance)))
        say(self._comm, *self._core.write(path, provenance))

    def write_rows(self, file: Union[str, os.PathLike], values: Any) -> None:
        """Writes data that belong to cells and are no fields, to go on from with ``read_rows`` and a mesh file: n rows, one for each
        cell of this rank, of any numbers and shape; or a list of n arrays of one type and of different lengths (particles,
        say). The bytes do not depend on the number of ranks. Collective."""
        path = agree(self._comm, lambda: (path_of(file), path_of(file)))
        rows = pack(self._comm, values, len(self.cells))
        if rows.dtype.fields is not None or rows.item == 0:
            raise Error("values: expected numbers, found a type with fields or without bytes")
        _core.write_rows(self._core, path, rows.begins, rows.raw, rows.item, rows.description())

    def read_rows(self, file: Union[str, os.PathLike], dtype: Any = None) -> Any:
        """The rows that ``write_rows`` wrote with this mesh, on any number of ranks, in the same form, for the cells of this rank.

        dtype: of the items of a file that C++ wrote (``adapt::write_cell_rows``); the result is a list of arrays then.
        Collective. Raises pamr.Error for damaged files and other meshes.
        """
        path = agree(self._comm, lambda: (path_of(file), (path_of(file), str(dtype))))
        item = 0 if dtype is None else np.dtype(dtype).itemsize
        return unpack(described(*_core.read_rows(self._core, path, item), dtype))

    def validate(self) -> None:
        """Raises pamr.Error, the same on every rank, that names what is broken and where, unless cells, neighbors, shapes, patches,
        levels and the borders of ranks fit together. Meshes of this package do; the memory that its arrays show may have been
        changed by a client since. As long as splitting the mesh takes a few times. Collective."""
        self._core.require_valid("mesh")

    # --- arrays of this rank

    @property
    def comm(self) -> Any:
        """The communicator that the mesh was made with."""
        return self._comm

    @property
    def points(self) -> np.ndarray:
        """n x 3 float64, length unit. Points on the border of ranks are on all of them."""
        return self._core.points

    @property
    def cells(self) -> np.ndarray:
        """m x 4 int32, rows of ``points``; (p1 - p0) x (p2 - p0) . (p3 - p0) > 0. Each cell is on one rank."""
        return self._core.cells

    @property
    def cell_to_cell(self) -> np.ndarray:
        """m x 4 int32: what lies across the face opposite each corner. 0 to m-1: a row of ``cells``; m + k: a cell of another
        rank, with the number ``ghost_numbers[k]``; -(p+1): patch p of ``patches``."""
        return self._core.cell_to_cell

    @property
    def node_numbers(self) -> np.ndarray:
        """n int64: numbers of the points in the whole mesh."""
        return self._core.node_numbers

    @property
    def cell_numbers(self) -> np.ndarray:
        """m int64, ascending: numbers of the cells in the whole mesh."""
        return self._core.cell_numbers

    @property
    def ghost_numbers(self) -> np.ndarray:
        """int64: numbers of the cells of other ranks behind the faces of the rank border."""
        return self._core.ghost_numbers

    @property
    def cell_origin(self) -> np.ndarray:
        """m int64: the row in the arrays of ``from_arrays``, counted over the ranks, that each cell was."""
        return self._core.cell_origin

    @property
    def node_origin(self) -> np.ndarray:
        """n int64: the same of the points."""
        return self._core.node_origin

    @property
    def levels(self) -> np.ndarray:
        """m uint8: how often the cell, or the one that a closure cell is part of, was split into eight."""
        return self._core.levels

    @property
    def patches(self) -> list[str]:
        """Names of the patches: of parts of the boundary, and of faces inside."""
        return [name for name, _, _ in self._core.patches]

    @property
    def patch_numbers(self) -> list[int]:
        """The numbers that the user gave the patches: physical groups, references, tags; -1 for those without one."""
        return self._core.patch_numbers

    @property
    def patch_groups(self) -> dict[str, dict[int, str]]:
        """The user's groups, {number: name}, of each patch whose faces are in several; the patch is the only group of the others.
        Groups that have no number (of OpenFOAM) are -1, -2, ..."""
        return {name: groups for name, groups in zip(self.patches, _by_number(self._core.patch_groups)) if groups}

    @property
    def region_groups(self) -> dict[int, dict[int, str]]:
        """The same of regions, by their values in the cell field "region"."""
        numbers = [number for number, _ in self._core.region_groups]
        return {number: groups for number, groups in zip(numbers, _by_number(groups for _, groups in self._core.region_groups)) if groups}

    @property
    def regions(self) -> dict[int, str]:
        """Names of values of the cell field "region", for those that have one."""
        return dict(self._core.regions)

    @property
    def surfaces(self) -> dict[str, str]:
        """The surface that each patch lies on, for those that have one."""
        return {name: surface for name, _, surface in self._core.patches if surface}

    @property
    def cell_fields(self) -> Fields:
        """Fields on cells."""
        return Fields(self, True)

    @property
    def node_fields(self) -> Fields:
        """Fields on nodes."""
        return Fields(self, False)

    @property
    def n_cells(self) -> int:
        """Cells of the whole mesh."""
        return self._core.n_cells

    @property
    def n_nodes(self) -> int:
        """Nodes of the whole mesh."""
        return self._core.n_nodes

    @property
    def length_unit(self) -> str:
        """Unit of the coordinates."""
        return self._core.length_unit

    def boundary_faces(self) -> BoundaryFaces:
        """The faces of this rank's cells on the boundary. Local."""
        return BoundaryFaces(*self._core.boundary_faces())

    def inner_faces(self) -> InnerFaces:
        """The faces inside that have a patch: sheets, interfaces, ports. Local."""
        *faces, first = self._core.inner_faces()
        return InnerFaces(*faces, first.astype(bool))

    def volumes(self) -> np.ndarray:
        """m float64: the volume of each cell. Local."""
        p = self.points[self.cells]
        return np.einsum("ij,ij->i", np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), p[:, 3] - p[:, 0]) / 6

    def fingerprint(self) -> int:
        """A number that tells two meshes apart, whatever their numbering and ranks (docs/file-format.md). Collective."""
        return self._core.fingerprint()

    def associate(self, surfaces: Mapping[str, Surface], tolerance: Optional[float] = None,
                  feature_angle: float = 40) -> dict[str, float]:
        """Lets patches lie on surfaces: ``mesh.associate({"wall": pamr.Sphere((0, 0, 0), 1)})``. Refinements then put new nodes of
        these patches onto them. Returns the largest distance of a node from the surface of each patch. Python warnings on
        rank 0 say what of a file of triangles is left out and where it cuts through itself, a ``pamr.Note`` where edges are long for
        the radius of their wall, as pamr-convert does.

        tolerance: largest distance that is accepted, length unit (default: 1e-6 of the mesh's size, more for triangles).
        feature_angle: degrees between two triangles of a ``pamr.File`` beyond which their edge is sharp.
        Collective. Raises pamr.Error for patches that are not there and nodes farther off.
        """
        def prepare() -> tuple[Any, Any]:
            text, pairs, files = "", [], []
            for patch, surface in surfaces.items():
                if isinstance(surface, File):
                    files.append((patch, os.fspath(surface.path)))
                elif isinstance(surface, Toml):
                    if surface.text not in text:
                        text += surface.text.rstrip() + "\n\n"
                    pairs.append(f"{patch}={surface.name}")
                elif isinstance(surface, Surface):
                    text += surface.toml(patch) + "\n"
                else:
                    raise Error(f"surface of patch '{patch}': expected one of pamr's surfaces, found "
                                f"{type(surface).__name__}")
            given = (text, pairs, files, float(feature_angle) if files else -1.0,
                     -1.0 if tolerance is None else float(tolerance))
            return given, given
        given = agree(self._comm, prepare)
        if not hasattr(_core, "associate"):
            raise Error("associate: expected a build with PAMR_MESHING, found one without")
        found, remarks = _core.associate(self._core, *given)
        coarse = _core.text_of_coarse_walls(self._core)
        say(self._comm, remarks, [coarse] if coarse else [])
        return {patch: distance for patch, _, distance in found}

    def __repr__(self) -> str:
        return f"<pamr.Mesh: {self.n_cells} cells, {self.n_nodes} nodes, patches {', '.join(self.patches)}>"


def _address(comm: Any) -> int:
    from mpi4py import MPI
    return MPI._addressof(comm)
