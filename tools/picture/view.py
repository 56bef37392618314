# SPDX-License-Identifier: GPL-3.0-or-later
"""From where a picture is taken: a parallel projection, so that lengths can be read off it."""
import dataclasses

import numpy as np

from refused import Refused

NAMED = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1), "iso": (-1, -1.6, 0.9)}
# Looking along an axis: what is up. Cuts are seen as in a drawing: x to the right where there is one.
CUT_VIEWS = {"x": ((1, 0, 0), (0, 0, 1)), "y": ((0, -1, 0), (0, 0, 1)), "z": ((0, 0, 1), (0, 1, 0))}


@dataclasses.dataclass
class View:
    toward: np.ndarray  # from what is seen to the camera, length 1
    right: np.ndarray
    up: np.ndarray
    is_along_axes: bool  # right and up are along axes of the mesh: coordinates can be read

    def flat(self, points):
        """Coordinates in the picture's plane."""
        return points @ np.column_stack([self.right, self.up])


@dataclasses.dataclass
class Plane:
    normal: np.ndarray  # of length 1
    offset: float

    def height(self, points):
        return points @ self.normal - self.offset


def unit(vector, what):
    length = np.linalg.norm(vector)
    if not np.isfinite(length) or length == 0:
        raise Refused(f"{what}: expected a direction, found {','.join(f'{v:g}' for v in vector)}")
    return np.asarray(vector, float) / length


def view_of(toward, up=None):
    """The camera in this direction; `up`: what points upward in the picture (z, or y where the camera looks along z)."""
    toward = unit(toward, "--camera")
    if up is None:
        up = (0, 1, 0) if abs(toward[2]) > 0.999 else (0, 0, 1)
    right = np.cross(unit(up, "--up"), toward)
    if np.linalg.norm(right) < 1e-6:
        raise Refused("--up: expected a direction other than the camera's")
    right = right / np.linalg.norm(right)
    upward = np.cross(toward, right)
    along = all(np.abs(v).max() > 1 - 1e-9 for v in (right, upward))
    return View(toward, right, upward, along)


def axis_text(vector):
    """The axis along which a vector lies, and its sign."""
    axis = int(np.abs(vector).argmax())
    return "xyz"[axis], int(np.sign(vector[axis]))
