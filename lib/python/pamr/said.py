# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings and notes of a call."""
from __future__ import annotations

import warnings
from typing import Any, Iterable, Sequence

from ._core import Error


class Note(UserWarning):
    """A Python warning about what stays behind though nothing is wrong: levels, surfaces and units that only a native file keeps,
    other times and regions of an OpenFOAM case, walls that are coarse. The tools say the same in lines that begin with ``note:``.
    ``warnings.simplefilter("ignore", pamr.Note)`` turns notes off, ``"error"`` makes errors of them."""


def listed(items: Sequence[str], most: int = 10) -> str:
    """"A, B, C" as ``pamr::listed`` has it: the first ten."""
    return ", ".join(items[:most]) + (", ..." if len(items) > most else "")


def say(comm: Any, remarks: Iterable[str], notes: Iterable[str] = ()) -> None:
    """Python warnings on rank 0, which name the line that called the caller. A warning that a filter makes an error is raised on
    every rank, so that none waits for the others. Collective."""
    raised = None
    if comm.rank == 0:
        try:
            for category, texts in ((UserWarning, remarks), (Note, notes)):
                for text in texts:
                    warnings.warn(text, category, stacklevel=3)
        except Warning as warning:
            raised = type(warning), str(warning)
        except Exception as trouble:  # of a warnings.showwarning of the user's
            raised = Error, f"{type(trouble).__name__}: {trouble}"
    raised = comm.bcast(raised)
    if raised is not None:
        kind, text = raised
        raise kind(text)
