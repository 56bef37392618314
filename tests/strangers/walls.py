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
