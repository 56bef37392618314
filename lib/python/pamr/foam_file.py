# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of OpenFOAM: field files, text or binary, with everything but their lists of values kept as it is.

Source of the format: OpenFOAM user guide, "Basic input/output file format", and the source of Foam::List.
"""
from __future__ import annotations

import gzip
import os
import re
from dataclasses import dataclass
from typing import Optional, Union

import numpy as np

from ._core import Error, write_complete

COMPONENTS = {"scalar": 1, "vector": 3, "symmTensor": 6, "tensor": 9}
_CLASS = re.compile(r"vol(Scalar|Vector|SymmTensor|Tensor)Field")
_BLANK = re.compile(rb"(?:\s+|//[^\n]*|/\*.*?\*/)*", re.S)
_WORD = re.compile(rb'"(?:[^"\\]|\\.)*"|[^\s;{}"]+')
_UNIFORM = re.compile(rb"uniform\s+(?:[-+.\w]+|\(\s*[-+.\w\s]+\))")
_LIST = re.compile(rb"nonuniform\s+(?:List<(\w+)>\s*)?(\d+)\s*([({]|(?=;))")


@dataclass
class Values:
    """Values in a field file: a list, or one value for all."""
    place: tuple[str, ...]  #: ("internalField",), or ("boundaryField", patch, key)
    kind: str               #: scalar, vector, ...
    rows: np.ndarray        #: n, or n x k; one row where it is for all
    text: Optional[bytes] = None  #: of the file, where it is for all


@dataclass
class FieldFile:
    """A field as its file has it: text that stays, and values in between."""
    name: str
    kind: str                #: scalar, vector, ...
    parts: list[Union[bytes, Values]]
    is_binary: bool

    def values(self) -> dict[tuple[str, ...], Values]:
        return {part.place: part for part in self.parts if isinstance(part, Values)}

    def internal(self, n_cells: int) -> np.ndarray:
        """A row for each cell."""
        part = self.values().get(("internalField",))
        if part is None:
            raise Error(f"field '{self.name}': expected an entry internalField, found none")
        if part.text is not None:
            return np.repeat(part.rows, n_cells, axis=0)
        if len(part.rows) != n_cells:
            raise Error(f"field '{self.name}', internalField: expected {n_cells} values, one for each cell, found "
                        f"{len(part.rows)}")
        return part.rows

    def to_bytes(self) -> bytes:
        def text(part: Union[bytes, Values]) -> bytes:
            if isinstance(part, bytes):
                return part
            return list_bytes(part.kind, part.rows, self.is_binary) if part.text is None else part.text
        return b"".join(map(text, self.parts))


def list_bytes(kind: str, rows: np.ndarray, is_binary: bool) -> bytes:
    """A list as OpenFOAM writes it, with all digits."""
    head = f"nonuniform List<{kind}> "
    if len(rows) == 0:
        return f"{head}0()".encode()
    if is_binary:
        return f"{head}{len(rows)}(".encode() + np.ascontiguousarray(rows, "<f8").tobytes() + b")"
    if rows.ndim == 1:
        lines = "\n".join(map(repr, rows.tolist()))
    else:
        lines = "\n".join(f"({' '.join(map(repr, row))})" for row in rows.tolist())
    return f"{head}\n{len(rows)}\n(\n{lines}\n)".encode()


def read_bytes(path: str) -> bytes:
    """A file, or its compressed form."""
    if os.path.exists(path) or not os.path.exists(path + ".gz"):
        with open(path, "rb") as file:
            return file.read()
    with gzip.open(path + ".gz") as file:
        return file.read()


class _Scanner:
    """One walk through a field file; notes where lists of values stand."""

    def __init__(self, path: str, data: bytes) -> None:
        self.path, self.data, self.at = path, data, 0
        self.found: list[tuple[int, int, Optional[Values]]] = []  # None: left out
        self.header: dict[str, str] = {}
        self.is_binary = False
        self.kind = ""

    def fail(self, expected: str) -> Error:
        line = self.data.count(b"\n", 0, self.at) + 1
        return Error(f"file '{self.path}', line {line}: expected {expected}")

    def skip(self) -> bytes:
        """Jumps over blanks and comments; the next character, empty at the end."""
        self.at = _BLANK.match(self.data, self.at).end()
        return self.data[self.at:self.at + 1]

    def entries(self, place: tuple[str, ...]) -> None:
        while True:
            next_one = self.skip()
            if next_one == b"" and not place:
                return
            if next_one == b"}" and place:
                self.at += 1
                return
            if next_one == b";":
                self.at += 1
                continue
            if next_one in (b"", b"{", b"}"):
                raise self.fail("a keyword")
            if next_one == b"#":  # a directive: its line
                end = self.data.find(b"\n", self.at)
                self.at = len(self.data) if end < 0 else end
                continue
            word, n_found = _WORD.match(self.data, self.at), len(self.found)
            self.at = word.end()
            key = word.group().decode("utf-8", "replace").strip('"')
            self.entry(place + (key,))
            if place == ("boundaryField",) and key.startswith("procBoundary"):  # between the parts of a decomposed case
                self.found[n_found:] = [(word.start(), self.at, None)]

    def entry(self, place: tuple[str, ...]) -> None:
        if self.skip() == b"{":
            self.at += 1
            self.entries(place)
            if place == ("FoamFile",):
                self.check_header()
            return
        begin, depth = self.at, 0
        while True:
            match = _LIST.match(self.data, self.at) if self.data[self.at:self.at + 1] == b"n" else None
            if match and (place[0] in ("internalField", "boundaryField")):
                self.list_of(place, match)
                continue
            character = self.data[self.at:self.at + 1]
            if character == b"":
                raise self.fail(f"a ';' after the entry {place[-1]}")
            if character == b'"':
                self.at = _WORD.match(self.data, self.at).end()
                continue
            depth += {b"(": 1, b"{": 1, b")": -1, b"}": -1}.get(character, 0)
            self.at += 1
            if character == b";" and depth <= 0:
                break
        text = self.data[begin:self.at - 1].rstrip()
        if place[0] == "FoamFile":
            self.header[place[-1]] = text.decode("utf-8", "replace").strip('"')
        elif place[0] in ("internalField", "boundaryField") and _UNIFORM.fullmatch(text):
            value = self.numbers(re.sub(rb"[()]", b" ", text[len("uniform"):]), None)
            kind = {COMPONENTS[name]: name for name in ("scalar", "vector", "symmTensor", "tensor")}.get(len(value))
            if kind is None or (place == ("internalField",) and len(value) != COMPONENTS[self.kind]):
                raise self.fail(f"a {self.kind} after '{place[-1]} uniform'")
            rows = value if len(value) == 1 else value[None]
            self.found.append((begin, begin + len(text), Values(place, kind, rows, text)))

    def check_header(self) -> None:
        kind = _CLASS.fullmatch(self.header.get("class", ""))
        if not kind:
            raise self.fail(f"a field on cells (volScalarField, volVectorField, ...), found class "
                            f"{self.header.get('class', 'missing')}")
        self.kind = kind[1][0].lower() + kind[1][1:]
        self.is_binary = self.header.get("format", "ascii") == "binary"
        arch = self.header.get("arch", "")
        if self.is_binary and ("scalar=32" in arch or arch.startswith("MSB")):
            raise self.fail(f"numbers of 64 bits, least byte first, found {arch}")

    def list_of(self, place: tuple[str, ...], match: re.Match) -> None:
        begin, kind, n = self.at, (match[1] or self.kind.encode()).decode(), int(match[2])
        if kind not in COMPONENTS:
            raise self.fail(f"a list of one of {', '.join(COMPONENTS)}, found List<{kind}>")
        k = COMPONENTS[kind]
        self.at = match.end()
        if match[3] == b"":  # "nonuniform 0;", a patch without faces
            if n > 0:
                raise self.fail(f"{n} values in the list, found none")
            rows = np.empty(0)
        elif match[3] == b"{":  # one value for all
            end = self.data.find(b"}", self.at)
            rows = np.tile(self.numbers(self.data[self.at:end], k), n)
            self.at = end + 1
        elif self.is_binary and n > 0:
            end = self.at + 8 * k * n
            if self.data[end:end + 1] != b")":
                raise self.fail(f"{n} values of {8 * k} bytes and a ')'")
            rows = np.frombuffer(self.data[self.at:end], "<f8")
            self.at = end + 1
        else:
            end = self.at
            depth = 1
            if k == 1:
                end = self.data.find(b")", end)
            else:
                end = self.closing(end, depth)
            if end < 0:
                raise self.fail("a ')' at the end of the list")
            rows = self.numbers(self.data[self.at:end].replace(b"(", b" ").replace(b")", b" "), k * n)
            self.at = end + 1
        self.found.append((begin, self.at, Values(place, kind, rows.astype(float).reshape((n, k) if k > 1 else (n,)))))

    def closing(self, at: int, depth: int) -> int:
        for bracket in re.finditer(rb"[()]", self.data[at:]):
            depth += 1 if bracket.group() == b"(" else -1
            if depth == 0:
                return at + bracket.start()
        return -1

    def numbers(self, text: bytes, n: Optional[int]) -> np.ndarray:
        try:
            values = np.array(text.split(), dtype=float)
        except ValueError:
            raise self.fail("numbers") from None
        if n is not None and len(values) != n:
            raise self.fail(f"{n} numbers in the list, found {len(values)}")
        return values


def read_field(path: str) -> FieldFile:
    """Reads a field on cells. Raises pamr.Error that says which line is wrong."""
    data = read_bytes(path)
    scanner = _Scanner(path, data)
    scanner.entries(())
    if not scanner.kind:
        raise Error(f"file '{path}': expected a header FoamFile, found none")
    parts: list[Union[bytes, Values]] = []
    end = 0
    for begin, after, values in scanner.found:
        parts += [data[end:begin]] + ([values] if values else [])
        end = after
    name = os.path.basename(path)
    return FieldFile(name, scanner.kind, parts + [data[end:]], scanner.is_binary)


def class_of(path: str) -> str:
    """The class that the header of a file names; empty where there is none."""
    head = read_bytes(path)[:2000]
    found = re.search(rb"FoamFile\s*\{[^}]*?\bclass\s+([\w:]+)\s*;", head)
    return found[1].decode() if found else ""


def write_bytes(path: str, data: bytes) -> None:
    """Writes a file in one step, with the rights of one that it replaces. Raises pamr.Error where the system refuses."""
    write_complete(os.fsencode(path), data)
    if os.path.exists(path + ".gz"):
        os.remove(path + ".gz")  # OpenFOAM would read either


def header(kind: str, location: str, name: str, note: str = "") -> str:
    extra = f'    note        "{note}";\n' if note else ""
    return (f"FoamFile\n{{\n    version     2.0;\n    format      ascii;\n    class       {kind};\n{extra}"
            f'    location    "{location}";\n    object      {name};\n}}\n\n')
