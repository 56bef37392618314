# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of the shapes by Gmsh: a .msh with a physical surface for each patch, and what is true of the shape."""
import math

import gmsh
import numpy as np


class Model:
    """A shape in Gmsh while it lives: its mesh has been written, and Gmsh can be asked for nearest points."""

    def __init__(self, function, size, path):
        gmsh.clear()
        for option, value in (("General.Terminal", 0), ("Mesh.MeshSizeMax", size), ("Mesh.MeshSizeMin", size / 8),("Mesh.MeshSizeFromCurvature", 12),
                              ("Mesh.Binary", 1), ("Mesh.RandomSeed", 1), ("Mesh.Optimize", 1), ("Mesh.OptimizeThreshold", 0.3),
                              ("Mesh.Algorithm3D", 1), ("Mesh.Algorithm", 5), ("Mesh.ScalingFactor", 1)):
            gmsh.option.setNumber(option, value)
        self.made = function(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        for option, value in self.made.options.items():
            gmsh.option.setNumber(option, value)
        gmsh.option.setNumber("Mesh.ScalingFactor", self.made.factor)
        self._link_sides()
        gmsh.model.mesh.generate(3)
        self.entities = self._name_patches()
        self.flat = [name for name in self.entities if name.startswith("flat")]
        volumes = [tag for _, tag in gmsh.model.getEntities(3)]
        for group in [[v] for v in volumes] if self.made.keep_volumes else [volumes]:
            gmsh.model.addPhysicalGroup(3, group)
        gmsh.write(path)
        self.volume = sum(gmsh.model.occ.getMass(3, v) for v in volumes) * self.made.factor**3

    def _name_patches(self):
        """Entities of each patch. A face on a described wall has its name, others are flat_N or free_N."""
        outer = gmsh.model.getBoundary(gmsh.model.getEntities(3), combined=True, oriented=False)
        entities = {}
        for _, tag in sorted(outer):
            entities.setdefault(self._patch_of(tag), []).append(tag)
        if self.made.inner_patch:
            inner = {tag for _, tag in gmsh.model.getEntities(2)} - {tag for _, tag in outer}
            gmsh.model.setPhysicalName(2, gmsh.model.addPhysicalGroup(2, sorted(inner)), self.made.inner_patch)
        for name, tags in entities.items():
            gmsh.model.setPhysicalName(2, gmsh.model.addPhysicalGroup(2, tags), name)
        return entities

    def _link_sides(self):
        """Sides of the bounding box that face each other get the same triangles."""
        low, high = np.round(np.array(gmsh.model.getBoundingBox(-1, -1)).reshape(2, 3), 5)  # it is given with a margin
        for axis in self.made.periodic:
            shift = np.where(np.arange(3) == axis, high - low, 0)
            at_low, at_high = ([tag for _, tag in gmsh.model.getEntitiesInBoundingBox(*(corner - 1e-3), *(other + 1e-3), 2)]
                               for corner, other in ((low, np.where(np.arange(3) == axis, low, high)),
                                                     (np.where(np.arange(3) == axis, high, low), high)))
            affine = np.eye(4)
            affine[:3, 3] = shift
            gmsh.model.mesh.setPeriodic(2, at_high, at_low, affine.ravel())

    def _patch_of(self, tag):
        is_flat = gmsh.model.getType(2, tag) == "Plane"
        points = self.made.factor * gmsh.model.mesh.getNodes(2, tag, includeBoundary=True)[1].reshape(-1, 3)
        for name, wall in self.made.walls.items():
            if not is_flat and wall.distance(points).max() < 1e-6 * np.ptp(points, axis=0).max():
                return name
        return f"{'flat' if is_flat else 'free'}_{tag}"

    def area(self, patch):
        return sum(gmsh.model.occ.getMass(2, tag) for tag in self.entities[patch]) * self.made.factor**2

    def distance(self, patch, points):
        """Of points from the nearest face of the patch, as OpenCASCADE finds it."""
        least = np.full(len(points), math.inf)
        for tag in self.entities[patch]:
            nearest = gmsh.model.getClosestPoint(2, tag, (points / self.made.factor).ravel())[0]
            least = np.minimum(least, np.linalg.norm(self.made.factor * nearest.reshape(-1, 3) - points, axis=1))
        return least
