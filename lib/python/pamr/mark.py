# SPDX-License-Identifier: GPL-3.0-or-later
"""Which cells to refine.

A criterion gives each cell of this rank a number, its indicator: 0 where the cell may stay, larger where it is wanted
more, infinite where it simply has to. ``flags`` takes any criterion and every limit::

    flags = pamr.mark.flags(mesh, pamr.mark.field(mesh, "T", above=400), pamr.mark.patch(mesh, "wall", layers=2),
                            max_level=5, max_cells=1_000_000)

An array of your own does as well: ``pamr.mark.flags(mesh, error > limit)``. The results do not depend on the number of
ranks; numbers of solvers are rounded to 20 bits before they are compared, because their last bits do. All functions are
collective and raise the same ``pamr.Error`` on every rank.
"""
from __future__ import annotations

from typing import Any, Optional, Sequence

import numpy as np

from . import _core
from .stages import closing
from .together import agree, description, field as field_in, plain, reals, whole

__all__ = ["all_cells", "box", "bulk", "centroid_shell", "crossing_sphere", "field", "flags", "patch", "recovered_error",
           "size_over"]


def _text(*numbers: float) -> str:
    return ",".join(repr(float(n)) for n in numbers)


def _indicator(mesh: Any, options: Any) -> np.ndarray:
    def prepare() -> tuple[list, list]:
        given = [(option, str(text)) for option, text in options()]
        return given, given
    return _core.indicator(mesh._core, agree(mesh.comm, prepare))


def all_cells(mesh: Any) -> np.ndarray:
    """Every cell."""
    return _indicator(mesh, lambda: [("--all", "")])


def crossing_sphere(mesh: Any, center: Sequence[float], radius: float) -> np.ndarray:
    """Cells that a sphere passes through: corners on both sides of it."""
    return _indicator(mesh, lambda: [("--crossing-sphere", _text(*center, radius))])


def centroid_shell(mesh: Any, center: Sequence[float], radius: float, width: float) -> np.ndarray:
    """Cells whose centroid is nearer to a sphere than ``width`` (length unit)."""
    return _indicator(mesh, lambda: [("--centroid-shell", _text(*center, radius, width))])


def box(mesh: Any, low: Sequence[float], high: Sequence[float]) -> np.ndarray:
    """Cells whose centroid lies in the closed box between two corners."""
    return _indicator(mesh, lambda: [("--box", _text(*low, *high))])


def patch(mesh: Any, name: str, layers: int = 1) -> np.ndarray:
    """``layers`` layers of cells at a boundary patch: those with a face on it, then those that share a node, ..."""
    return _indicator(mesh, lambda: [("--patch", name), ("--layers", whole("layers", layers, np.int32))])


def field(mesh: Any, name: str, above: Optional[float] = None, below: Optional[float] = None) -> np.ndarray:
    """Cells where a field of one component is above or below a value; a nodal field counts with the mean of the corners.
    Indicator: how far beyond, over the value's size."""
    def options() -> list:
        if (above is None) == (below is None):
            raise _core.Error("field: expected either above or below")
        return [("--field", name), ("--above", _text(above)) if above is not None else ("--below", _text(below))]
    return _indicator(mesh, options)


def size_over(mesh: Any, name: str, ratio: float = 1, size: str = "cbrt") -> np.ndarray:
    """Cells larger than ``ratio`` times the length that the field gives; size: "cbrt" of the volume or "longest-edge"."""
    return _indicator(mesh, lambda: [("--size-over", name), ("--ratio", _text(ratio)), ("--size", size)])


def recovered_error(mesh: Any, name: str, *, theta: Optional[float] = None, target: Optional[float] = None,
                    bulk: Optional[float] = None) -> np.ndarray:
    """Cells by the error of the gradient of a nodal field, estimated by a recovered one (Zienkiewicz and Zhu 1987), with one of
    ``theta``: squared error above theta * squared norm / cells; ``target``: the same for a relative error of that size;
    ``bulk``: the fewest cells that carry this part of the squared error of the whole mesh (Doerfler 1996)."""
    def options() -> list:
        bars = [(k, v) for k, v in (("theta", theta), ("target", target), ("bulk", bulk)) if v is not None]
        if len(bars) != 1:
            raise _core.Error("recovered_error: expected one of theta, target and bulk")
        return [("--recovered-error", name), ("--" + bars[0][0], _text(bars[0][1]))]
    return _indicator(mesh, options)


def bulk(mesh: Any, values: Any, fraction: float = 0.3) -> np.ndarray:
    """The fewest cells that carry this part of the sum of ``values`` over the whole mesh (Doerfler's marking): n squared error
    estimates of this rank's cells, not negative, or the name of a cell field."""
    name = "pamr.mark.bulk"
    if isinstance(values, str):
        return _indicator(mesh, lambda: [("--bulk-of", f"{values}:{_text(fraction)}")])

    def prepare() -> tuple[Any, Any]:
        item = field_in(name, reals("values", values, (len(mesh.cells),)), len(mesh.cells))
        return item, description(item)
    mesh._core.put_field(True, agree(mesh.comm, prepare))
    try:
        return _indicator(mesh, lambda: [("--bulk-of", f"{name}:{_text(fraction)}")])
    finally:
        mesh._core.remove_field(True, name)


def flags(mesh: Any, *criteria: Any, max_level: Optional[int] = None, max_cells: Optional[int] = None,
          quality_control: str = "removable", shape_floor: float = 0.35) -> np.ndarray:
    """Flags for ``pamr.refine``: n values of uint8, 1 for cells that any of the criteria wants.

    criteria: indicators, or arrays of numbers or truth values, n each. max_level: only cells of a level below it.
    max_cells: the most wanted cells first, as many as keep the refined mesh within so many cells, closure included, with that
        quality control and shape floor.
    """
    def prepare() -> tuple[Any, Any]:
        n = len(mesh.cells)
        if not criteria:
            raise _core.Error("flags: expected one criterion or more, found none")
        total = np.zeros(n)
        for values in criteria:
            array = plain("criterion", values)
            if array.dtype == bool:
                array = np.where(array, np.inf, 0.0)
            wish = reals("criterion", array, (n,), finite=False)
            if np.isnan(wish).any():
                raise _core.Error(f"criterion: expected numbers, found NaN for cell {int(np.argwhere(np.isnan(wish))[0])}")
            total = np.maximum(total, wish)
        level = -1 if max_level is None else whole("max_level", max_level, np.int32)
        cells = -1 if max_cells is None else whole("max_cells", max_cells)
        if (max_level is not None and level < 0) or (max_cells is not None and cells < 1):
            raise _core.Error("flags: expected limits that are not negative")
        how = level, cells, closing(quality_control, shape_floor)
        return (total, *how), (len(criteria), *how)
    return _core.flags(mesh._core, *agree(mesh.comm, prepare))
