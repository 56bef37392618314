# SPDX-License-Identifier: GPL-3.0-or-later
"""What is done with a mesh."""
from __future__ import annotations

import json
from dataclasses import dataclass, replace
from typing import Any, Optional

import numpy as np

from . import _core
from .mesh import Mesh
from .rows import pack, unpack
from .said import say
from .together import agree, integers, reals

Error = _core.Error
POLICIES = ("none", "isotropic", "short-edge", "removable")
BALANCES = ("auto", "scotch", "curve", "blocks", "none")


def _flags(mesh: Mesh, values: Any, known: str = "0 or 1", lowest: int = 0) -> np.ndarray:
    array = integers("flags", values, (len(mesh.cells),))
    bad = np.argwhere((array < lowest) | (array > 1))
    if len(bad):
        raise Error(f"flags: expected {known}, found {array[bad[0][0]]} for cell {int(bad[0][0])}")
    return array.astype(np.uint8 if lowest == 0 else np.int8)


def _one_of(name: str, value: Any, known: tuple[str, ...]) -> None:
    if value not in known:
        raise Error(f"{name}: expected one of {', '.join(known)}, found {value!r}")


def closing(quality_control: Any, shape_floor: Any) -> tuple[str, float]:
    """What the core takes for them."""
    _one_of("quality_control", quality_control, POLICIES)
    if not 0 <= float(shape_floor) <= 1:
        raise Error(f"shape_floor: expected a number from 0 to 1, found {shape_floor!r}")
    return quality_control, float(shape_floor)


@dataclass
class RefineResult:
    """What a refinement gives."""
    mesh: Mesh      #: the refined mesh
    report: dict    #: counts over all ranks by the keys of pamr-refine (docs/tools/pamr-refine.md), seconds of this one
    parent: np.ndarray  #: m int64: number in the old mesh of the cell that each new cell comes from
    _old: Mesh

    def from_parents(self, values: Any) -> Any:
        """The data of each new cell's parent, wherever it is kept.

        values: n rows, one for each cell of the old mesh on this rank, of any type and shape without Python objects; or a
            list of n arrays of one type and of different lengths (particles, say). The result has the same form, m rows.
        Fields of the mesh need none of this: the new mesh has them. Collective.
        """
        old = self._old
        rows = pack(self.mesh.comm, values, len(old.cells))
        offset, raw = _core.fetch_rows(self.mesh._core, old.n_cells, old.cell_numbers, rows.begins * rows.item, rows.raw,
                                       self.parent)
        return unpack(replace(rows, begins=offset // max(rows.item, 1), raw=raw))


def placing(project: Any, bend: Any) -> tuple[bool, str]:
    """What the core takes for them."""
    _one_of("bend", bend, ("none", "walls", "all"))
    return bool(project), bend


def refine(mesh: Mesh, flags: Any, *, project: bool = True, bend: str = "walls", quality_control: str = "removable",
           shape_floor: float = 0.35, balance: str = "auto", weights: str = "exact", check: bool = False) -> RefineResult:
    """Splits the flagged cells into eight and closes the mesh around them. Collective.

    flags: one for each cell of this rank, 0 or 1 (or truth values).
    project: put new nodes of the boundary onto the surfaces of their patches.
    bend: which inner edges of level 0 may bend for better shapes (docs/coarse-walls.md): "none", "walls" (those near walls that
        are curved more than their edges are short), "all". Decides when a mesh of level 0 is refined.
    quality_control: what happens to transition cells that are to be split again (docs/refinement.md).
    shape_floor: smallest mean ratio of transition cells under "removable"; more edges are marked where they would fall below
        it. 0: none.
    balance: how cells are spread over the ranks first: "auto", "scotch", "curve", "blocks", "none" (children stay with parents).
    weights: "exact", "8/1", "uniform", or the name of a cell field.
    check: look at the whole mesh first (``Mesh.validate``). Without it the arrays are trusted: where a client has written into
        them through a view of its own, what follows may be wrong or end the process.
    The old mesh stays as it is. The new one is the same on any number of ranks, bit for bit, whatever the balance.
    Cells that are too deep to be split, and periodic patches, are a Python warning on rank 0.
    """
    def prepare() -> tuple[Any, Any]:
        _one_of("balance", balance, BALANCES)
        if not isinstance(weights, str):
            raise Error(f"weights: expected \"exact\", \"8/1\", \"uniform\" or the name of a cell field, found {type(weights).__name__}")
        how = placing(project, bend), closing(quality_control, shape_floor), balance, weights
        return (_flags(mesh, flags), *how), (how, bool(check))
    arguments = agree(mesh.comm, prepare)
    if check:
        mesh.validate()
    core, report, remarks = _core.refine(mesh._core, *arguments)
    say(mesh.comm, remarks)
    fine = Mesh(core, mesh.comm)
    return RefineResult(fine, report, fine.cell_fields["parent"], mesh)


def adapt(mesh: Mesh, flags: Any, *, project: bool = True, bend: str = "walls", shape_floor: float = 0.35, balance: str = "auto",
          weights: str = "exact", integrals: tuple[str, ...] = (), check: bool = False) -> RefineResult:
    """Refines and coarsens in one call (docs/coarsening.md). Collective.

    flags: one for each cell of this rank: 1 is split into eight; -1 may be coarsened: with its siblings, all flagged, it
        becomes their parent again if nothing that remains needs them; 0 stays.
    integrals: names of cell fields of which coarsening keeps the sum of value times volume, at curved walls too. All others keep
        values.
    The other arguments are those of ``refine`` (``check``, too); the policy is "removable". ``report["coarsening"]`` says what went and why the
    rest stayed. ``parent`` names for each new cell the old one that holds its centroid. Where nothing is coarsened because the cells
    know no parent, a Python warning on rank 0 says so.
    """
    def prepare() -> tuple[Any, Any]:
        _one_of("balance", balance, BALANCES)
        if not isinstance(weights, str):
            raise Error(f"weights: expected \"exact\", \"8/1\", \"uniform\" or the name of a cell field, found {type(weights).__name__}")
        if isinstance(integrals, str):
            raise Error(f"integrals: expected a list of names, found the text {integrals!r}")
        names = [str(name) for name in integrals]
        how = placing(project, bend), closing("removable", shape_floor), balance, weights, names
        return (_flags(mesh, flags, "-1, 0 or 1", -1), *how), (how, bool(check))
    arguments = agree(mesh.comm, prepare)
    if check:
        mesh.validate()
    core, report, remarks = _core.adapt(mesh._core, *arguments)
    say(mesh.comm, remarks)
    fine = Mesh(core, mesh.comm)
    return RefineResult(fine, report, fine.cell_fields["parent"], mesh)


def forecast(mesh: Mesh, flags: Any, quality_control: str = "removable", shape_floor: float = 0.35) -> tuple[int, int]:
    """Cells and nodes that adapting with these flags would give, exactly. Collective.

    flags: one for each cell of this rank: 1 is split, 0 stays, -1 may be coarsened, as for ``adapt``.
    """
    def prepare() -> tuple[Any, Any]:
        how = closing(quality_control, shape_floor)
        return (_flags(mesh, flags, "-1, 0 or 1", -1), how), how
    return _core.forecast(mesh._core, *agree(mesh.comm, prepare))


def balance(mesh: Mesh, weights: Any = None, method: str = "scotch") -> Mesh:
    """The same mesh, its cells moved so that every rank bears about the same weight; fields move along. Collective.

    weights: one number of at least 0 for each cell of this rank, in any unit (default: 1).
    method: "scotch" (few faces between ranks), "curve" (pieces of a space-filling curve),
      "blocks" (runs of cells), "auto" (what is good enough and cheapest), "none".
    """
    def prepare() -> tuple[Any, Any]:
        _one_of("method", method, BALANCES)
        n = len(mesh.cells)
        array = np.ones(n) if weights is None else reals("weights", weights, (n,))
        if (array < 0).any():
            raise Error(f"weights: expected numbers of at least 0, found {array.min()}")
        return array, (method, weights is None)
    return Mesh(_core.balance(mesh._core, agree(mesh.comm, prepare), method), mesh.comm)


def quality(mesh: Mesh) -> dict:
    """Everything that pamr-quality reports of a mesh: volume, shapes, patches, faults (docs/tools/pamr-quality.md).
    The same for any number of ranks. Collective."""
    return json.loads(_core.quality(mesh._core))


def locate(mesh: Mesh, points: Any, near: Optional[Any] = None) -> tuple[np.ndarray, np.ndarray]:
    """Which cell holds each point, inside or on its surface, by exact predicates. Collective.

    points: n x 3, others on each rank. near: n rows of ``mesh.cells`` to walk from (-1: none), such as the cells in which the
    points were before; it saves time and changes nothing else.
    Returns the cells' numbers in the whole mesh and their ranks, n each, -1 where no cell holds the point. Where several do,
    the smallest number.
    """
    def prepare() -> tuple[Any, Any]:
        where = reals("points", points, (None, 3), finite=False)
        cells = np.empty(0, np.int32) if near is None else integers("near", near, (len(where),), np.int32)
        return (where, cells), None
    where, cells = agree(mesh.comm, prepare)
    number, rank = _core.locate(mesh._core, where, cells)
    number[rank < 0] = -1
    return number, rank
