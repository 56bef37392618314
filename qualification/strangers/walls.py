# SPDX-License-Identifier: GPL-3.0-or-later
"""Curved walls of strangers' meshes: how a case file describes each, and how far points are from it."""
import dataclasses

import numpy as np


def _toml(kind, **keys):
    lines = ["[[surface]]", 'name = "{name}"', f'kind = "{kind}"']
    for key, value in keys.items():
        value = [float(x) for x in value] if np.ndim(value) else float(value)
        lines.append(f"{key} = {value!r}")
    return "\n".join(lines) + "\n"


def _along(points, axis):
    """Distance along an axis through the origin, and from it."""
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    x = points @ axis
    return x, np.linalg.norm(points - np.outer(x, axis), axis=1)


@dataclasses.dataclass
class Sphere:
    center: tuple
    radius: float

    def toml(self):
        return _toml("sphere", center=self.center, radius=self.radius)

    def distance(self, points):
        return abs(np.linalg.norm(points - self.center, axis=1) - self.radius)


@dataclasses.dataclass
class Cylinder:
    point: tuple
    axis: tuple
    radius: float

    def toml(self):
        return _toml("cylinder", point=self.point, axis=self.axis, radius=self.radius)

    def distance(self, points):
        return abs(_along(points - self.point, self.axis)[1] - self.radius)


@dataclasses.dataclass
class Cone:
    apex: tuple
    axis: tuple
    half_angle: float  # degrees

    def toml(self):
        return _toml("cone", apex=self.apex, axis=self.axis, half_angle=self.half_angle)

    def distance(self, points):
        x, r = _along(points - np.asarray(self.apex), self.axis)
        angle = np.radians(self.half_angle)
        return abs(r * np.cos(angle) - x * np.sin(angle))


@dataclasses.dataclass
class Torus:
    center: tuple
    axis: tuple
    major_radius: float
    minor_radius: float

    def toml(self):
        return _toml("torus", center=self.center, axis=self.axis, major_radius=self.major_radius, minor_radius=self.minor_radius)

    def distance(self, points):
        x, r = _along(points - np.asarray(self.center), self.axis)
        return abs(np.hypot(r - self.major_radius, x) - self.minor_radius)


@dataclasses.dataclass
class Ellipsoid:
    """About the origin, half axes along the coordinates."""
    half_axes: tuple

    def toml(self):
        squares = [1 / a**2 for a in self.half_axes]
        return _toml("quadric", coefficients=squares + [0] * 6 + [-1])

    def distance(self, points):
        """To first order in the distance, from the value of the polynomial and its gradient."""
        scaled = points / self.half_axes
        return abs((scaled**2).sum(axis=1) - 1) / np.linalg.norm(2 * scaled / self.half_axes, axis=1)


@dataclasses.dataclass
class Triangles:
    """A closed triangulated surface, corners by rows."""
    file: str  # as the case file names it
    corners: np.ndarray

    def toml(self):
        return f'[[surface]]\nname = "{{name}}"\nkind = "triangulation"\nfile = "{self.file}"\n'

    def area(self):
        a, b, c = self.corners.swapaxes(0, 1)
        return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2

    def volume(self):
        a, b, c = self.corners.swapaxes(0, 1)
        return (np.cross(a, b) * c).sum() / 6

    def distance(self, points):
        return np.array([np.sqrt(self._squared(point).min()) for point in points])

    def _squared(self, point):
        """Of one point from each triangle: from its plane above it, else from the nearest of its edges."""
        a, b, c = self.corners.swapaxes(0, 1)
        normal = np.cross(b - a, c - a)
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        height = ((point - a) * normal).sum(axis=1)
        squared, is_above = np.full(len(a), np.inf), np.ones(len(a), bool)
        for p, q in ((a, b), (b, c), (c, a)):
            edge, to = q - p, point - p
            is_above &= (np.cross(edge, to) * normal).sum(axis=1) >= 0
            t = np.clip((to * edge).sum(axis=1) / (edge**2).sum(axis=1), 0, 1)
            squared = np.minimum(squared, ((to - t[:, None] * edge)**2).sum(axis=1))
        return np.where(is_above, height**2, squared)


@dataclasses.dataclass
class BallOfTriangles(Triangles):
    """Triangles whose corners lie on the unit sphere. The wall is the smooth surface through them, not their facets."""
    known_to: float = 1e-4  # how far the smooth surface may be from the sphere; facets of 1,280 triangles are 5e-3 off

    def area(self):
        return 4 * np.pi

    def volume(self):
        return 4 * np.pi / 3

    def distance(self, points):
        return abs(np.linalg.norm(points, axis=1) - 1)
