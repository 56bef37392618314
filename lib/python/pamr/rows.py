# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of cells, of one length or of different lengths, as bytes."""
from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any, Optional

import numpy as np

from ._core import Error
from .together import agree, plain


@dataclass
class Rows:
    """Rows of this rank's cells: bytes of items of one type."""
    is_list: bool           #: rows of different lengths
    dtype: np.dtype
    tail: tuple[int, ...]   #: shape of an item
    begins: np.ndarray      #: n + 1 int64, in items
    raw: np.ndarray         #: uint8

    @property
    def item(self) -> int:
        """Bytes of an item."""
        return self.dtype.itemsize * int(np.prod(self.tail, dtype=int))

    def description(self) -> str:
        """The type in a file."""
        return f"numpy {self.dtype.str} {'x'.join(map(str, self.tail)) or '1'} {'list' if self.is_list else 'array'}"


def pack(comm: Any, values: Any, n: int) -> Rows:
    """Rows for n cells: an array of n rows of any type and shape, or a list of n arrays of one type. Collective."""
    def prepare() -> tuple[Any, Any]:
        if len(values) != n:
            raise Error(f"values: expected a row for each of {n} cells, found {len(values)}")
        is_list = isinstance(values, (list, tuple))
        rows = [plain("values", row) for row in values] if is_list else None
        bad = [i for i, row in enumerate(rows or []) if row.ndim == 0]
        if bad:
            raise Error(f"values: expected an array for each cell, found a single value for cell {bad[0]}")
        flat = plain("values", values) if rows is None else (np.concatenate(rows) if rows else np.empty(0))
        if flat.dtype.hasobject:
            raise Error("values: expected numbers, found Python objects")
        return (is_list, rows, np.ascontiguousarray(flat)), is_list
    is_list, rows, flat = agree(comm, prepare)
    types = [t for t in comm.allgather((flat.dtype, flat.shape[1:]) if len(flat) else None) if t]
    if any(t != types[0] for t in types):
        raise Error(f"values: expected the same type on every rank, found {', '.join(str(t[0]) for t in types)}")
    dtype, tail = types[0] if types else (flat.dtype, flat.shape[1:])
    lengths = np.ones(n, dtype=np.int64) if rows is None else np.array([len(row) for row in rows], dtype=np.int64)
    raw = flat.astype(dtype, copy=False).view(np.uint8).ravel() if len(flat) else np.empty(0, np.uint8)
    return Rows(is_list, dtype, tail, np.concatenate(([0], np.cumsum(lengths))).astype(np.int64), raw)


def unpack(rows: Rows) -> Any:
    """The array or the list again."""
    found = rows.raw.view(rows.dtype).reshape(-1, *rows.tail)
    if not rows.is_list:
        return found
    return np.split(found, rows.begins[1:-1]) if len(rows.begins) > 1 else []


def described(text: str, begins: np.ndarray, raw: np.ndarray, dtype: Optional[Any]) -> Rows:
    """Rows of a file by the description of their type, or of a type that is given."""
    if dtype is not None:
        return Rows(True, np.dtype(dtype), (), begins, raw)
    found = re.fullmatch(r"numpy (\S+) (\d+(?:x\d+)*) (list|array)", text)
    if not found:
        raise Error(f"rows: expected data that Python wrote, found '{text}' (give the type: dtype=)")
    tail = tuple(map(int, found[2].split("x")))
    return Rows(found[3] == "list", np.dtype(found[1]), () if found[2] == "1" else tail, begins, raw)
