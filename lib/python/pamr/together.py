# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of arguments that end alike on every rank."""
from __future__ import annotations

import operator
import os
from typing import Any, Callable, Optional, Sequence, TypeVar

import numpy as np

from ._core import Error

T = TypeVar("T")

# Of pamr::mesh::StorageType.
STORAGE = {"float64": 0, "float32": 1, "int64": 2, "int32": 3, "uint64": 4, "uint32": 5, "uint8": 6, "int8": 7,
           "int16": 8, "uint16": 9}


def agree(comm: Any, prepare: Callable[[], tuple[T, Any]]) -> T:
    """What ``prepare`` makes of this rank's arguments. It returns that and what has to be the same on every rank, and
    raises for what is wrong; the lowest rank's error is then raised on every rank. Collective."""
    error, result, same = None, None, None
    try:
        result, same = prepare()
    except Exception as trouble:  # whatever it is, the other ranks have to hear of it
        error = str(trouble) if isinstance(trouble, Error) else f"{type(trouble).__name__}: {trouble}"
    told = comm.allgather((error, repr(same)))
    for rank, (text, _) in enumerate(told):
        if text is not None:
            raise Error(f"{text} (rank {rank})")
    for rank, (_, other) in enumerate(told):
        if other != told[0][1]:
            raise Error(f"arguments: expected the same on every rank, found {told[0][1]} on rank 0 and {other} on rank "
                        f"{rank}")
    return result  # type: ignore[return-value]


def path_of(file: Any) -> str:
    """The name of a file; one with a NUL character would be cut there by the system, without a word."""
    path = os.fsdecode(file)
    if "\0" in path:
        raise Error(f"expected a name of a file without NUL characters, found {path!r}")
    return path


def require_comm(comm: Any) -> None:
    """Raises TypeError for what is no communicator of mpi4py."""
    from mpi4py import MPI
    if not isinstance(comm, MPI.Intracomm):
        raise TypeError(f"expected a communicator of mpi4py, found {type(comm).__name__}")
    if comm == MPI.COMM_NULL:
        raise TypeError("expected a communicator, found COMM_NULL")


def plain(name: str, values: Any) -> np.ndarray:
    """An array of what was given, which must not have masked entries: what lies under a mask is no value."""
    n_masked = _sum_over(values, lambda item: np.ma.count_masked(item) if isinstance(item, np.ma.MaskedArray) else 0)
    if n_masked:
        raise Error(f"{name}: expected values without a mask, found {n_masked} masked of {_sum_over(values, np.size)}")
    return np.asarray(values)


def _sum_over(values: Any, count: Callable[[Any], Any]) -> int:
    """Of an array, or of all that are in lists: numpy forgets the masks of their items."""
    return sum(_sum_over(item, count) for item in values) if isinstance(values, (list, tuple)) else int(count(values))


def whole(name: str, value: Any, dtype: Any = np.int64) -> int:
    """A single integer that the type holds."""
    try:
        number = operator.index(value)
    except TypeError:
        raise Error(f"{name}: expected an integer, found {value!r}") from None
    limits = np.iinfo(dtype)
    if not int(limits.min) <= number <= int(limits.max):
        raise Error(f"{name}: expected an integer that fits {np.dtype(dtype)}, found {number}")
    return number


def require_fit(name: str, array: np.ndarray, dtype: Any) -> None:
    """Raises Error for integers that the type does not hold. Python compares them exactly, numpy as doubles."""
    limits = np.iinfo(dtype)
    for value in (array.min(initial=0), array.max(initial=0)) if array.dtype.kind in "iu" else ():
        if not int(limits.min) <= int(value) <= int(limits.max):
            raise Error(f"{name}: expected integers that fit {np.dtype(dtype)}, found {value}")


def integers(name: str, values: Any, shape: Sequence[Optional[int]], dtype: Any = np.int64) -> np.ndarray:
    """An array of integers of that shape (None: any length)."""
    array = plain(name, values)
    if array.size == 0 and None in shape:
        return np.empty([n or 0 for n in shape], dtype)
    require_shape(name, array, shape)
    if array.size == 0:
        return np.empty(array.shape, dtype)
    if array.dtype.kind not in "iub":
        raise Error(f"{name}: expected integers, found {array.dtype}")
    require_fit(name, array, dtype)
    return np.ascontiguousarray(array, dtype=dtype)


def reals(name: str, values: Any, shape: Sequence[Optional[int]], finite: bool = True) -> np.ndarray:
    """An array of float64 of that shape (None: any length), finite unless told."""
    array = plain(name, values)
    if array.size == 0 and None in shape:
        return np.empty([n or 0 for n in shape])
    require_shape(name, array, shape)
    if array.dtype.kind not in "fiub":
        raise Error(f"{name}: expected real numbers, found {array.dtype}")
    result = np.ascontiguousarray(array, dtype=np.float64)
    if finite and not np.isfinite(result).all():
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(result))[0])
        raise Error(f"{name}: expected finite numbers, found {result[where]} in row {where[0]}")
    return result


def require_shape(name: str, array: np.ndarray, shape: Sequence[Optional[int]]) -> None:
    if array.ndim != len(shape) or any(n is not None and n != m for n, m in zip(shape, array.shape)):
        wanted = " x ".join("n" if n is None else str(n) for n in shape)
        found = " x ".join(str(n) for n in array.shape) or "a single value"
        raise Error(f"{name}: expected shape {wanted}, found {found}")


def field(name: Any, values: Any, n_rows: int, unit: str = "") -> tuple[str, str, np.ndarray, int]:
    """A field as the compiled part takes it: float64 or int64, n or n x k."""
    if not isinstance(name, str) or not name or "/" in name:
        raise Error(f"field: expected a name without '/', found {name!r}")
    array = plain(f"field '{name}'", values)
    if array.ndim not in (1, 2) or len(array) != n_rows or (array.ndim == 2 and array.shape[1] < 1):
        found = " x ".join(str(n) for n in array.shape) or "a single value"
        raise Error(f"field '{name}': expected {n_rows} rows, one for each, or {n_rows} x k values, found {found}")
    if array.dtype.kind == "b":
        array = array.astype(np.uint8)
    storage = STORAGE.get(array.dtype.name)
    if storage is None:
        raise Error(f"field '{name}': expected real numbers or integers, found {array.dtype}")
    require_fit(f"field '{name}'", array, np.int64)
    dtype = np.float64 if array.dtype.kind == "f" else np.int64
    return name, unit, np.ascontiguousarray(array, dtype=dtype), storage


def description(item: tuple[str, str, np.ndarray, int]) -> tuple:
    """What has to be the same on every rank."""
    name, unit, values, storage = item
    return name, unit, 1 if values.ndim == 1 else values.shape[1], storage
