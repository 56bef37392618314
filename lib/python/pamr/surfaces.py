# SPDX-License-Identifier: GPL-3.0-or-later
"""Curved surfaces that boundary patches lie on: new nodes of the boundary are put onto them."""
from __future__ import annotations

import os
from dataclasses import dataclass, fields
from typing import Sequence, Union

Vector = Sequence[float]


class Surface:
    """A shape that a patch lies on; one of the classes below."""

    kind = ""

    def toml(self, name: str) -> str:
        """Its entry ``[[surface]]`` (docs/surfaces.md), with all digits."""
        lines = ["[[surface]]", f'name = "{name}"', f'kind = "{self.kind}"']
        for entry in fields(self):  # type: ignore[arg-type]
            value = getattr(self, entry.name)
            if hasattr(value, "__len__"):
                lines.append(f"{entry.name} = [{', '.join(repr(float(v)) for v in value)}]")
            else:
                lines.append(f"{entry.name} = {float(value)!r}")
        return "\n".join(lines) + "\n"


@dataclass(frozen=True)
class Plane(Surface):
    """The plane through ``point`` across ``normal``."""
    point: Vector
    normal: Vector
    kind = "plane"


@dataclass(frozen=True)
class Sphere(Surface):
    """The sphere about ``center``; lengths in the unit of the mesh."""
    center: Vector
    radius: float
    kind = "sphere"


@dataclass(frozen=True)
class Cylinder(Surface):
    """The cylinder without ends about the line through ``point`` along ``axis``."""
    point: Vector
    axis: Vector
    radius: float
    kind = "cylinder"


@dataclass(frozen=True)
class Cone(Surface):
    """One nappe, from ``apex`` along ``axis``; ``half_angle`` in degrees between axis and generators."""
    apex: Vector
    axis: Vector
    half_angle: float
    kind = "cone"


@dataclass(frozen=True)
class Torus(Surface):
    """The ring torus about ``axis``: ``major_radius`` from ``center`` to the middle of the tube, ``minor_radius`` of the
    tube."""
    center: Vector
    axis: Vector
    major_radius: float
    minor_radius: float
    kind = "torus"


@dataclass(frozen=True)
class File(Surface):
    """A body given by triangles: an STL, OBJ, PLY or OFF file, read by every rank."""
    path: Union[str, os.PathLike]


@dataclass(frozen=True)
class Toml(Surface):
    """The surface of that name in a text of entries ``[[surface]]``, of any kind that docs/surfaces.md knows."""
    text: str
    name: str
