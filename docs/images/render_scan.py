#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the wall of the scanned body: the triangles of the scan, then two levels of the mesh, as seen from behind, where
its groove fades out, and from the cut front.

Usage: render_scan.py SCAN.stl COARSE.hdf FINE.hdf PICTURE.png    (under xvfb-run where there is no screen)
"""
import sys

import numpy as np
import vtk

from render import BODY_FACE, OVERSAMPLING, Mesh, edge_actor, face_actor, save, text_actor, white_window

WIDTH, HEIGHT = 1500, 900
VIEWS = ((-4, -1.6, 2.6), (4, -2.5, 3.2))


class Scan:
    """The triangles of a binary STL as the picture wants a mesh."""

    def __init__(self, name):
        data = np.frombuffer(open(name, "rb").read()[84:], dtype=np.dtype([("f", "<f4", 12), ("n", "<u2")]))
        corners = data["f"][:, 3:].reshape(-1, 3).astype(float)
        self.points, number = np.unique(corners, axis=0, return_inverse=True)
        self.face = number.reshape(-1, 3)

    def part(self, _patches):
        return self.face, np.zeros(len(self.face), int)


def scene(mesh, patches, box, position):
    renderer = vtk.vtkRenderer()
    renderer.SetViewport(*box)
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor(face_actor(mesh, patches, BODY_FACE[:1], True))
    for actor in edge_actor(mesh, patches, (0.8, 0.7, 0.6, 0.4)):
        actor.GetProperty().SetLineWidth(0.5 * OVERSAMPLING)
        renderer.AddActor(actor)
    renderer.RemoveAllLights()
    for where, strength in (((-2, -6, 8), 0.8), ((position[0], position[1], -2), 0.35)):
        light = vtk.vtkLight()
        light.SetPosition(*where)
        light.SetFocalPoint(0, 0, 0)
        light.SetIntensity(strength)
        renderer.AddLight(light)
    camera = renderer.GetActiveCamera()
    camera.SetFocalPoint(-0.05, 0, 0)
    camera.SetPosition(*position)
    camera.SetViewUp(0, 0, 1)
    camera.SetViewAngle(25)
    renderer.ResetCameraClippingRange()
    return renderer


def main():
    scan, coarse, fine, picture = Scan(sys.argv[1]), Mesh(sys.argv[2]), Mesh(sys.argv[3]), sys.argv[4]
    window = white_window(WIDTH, HEIGHT)
    columns = ((scan, "Scan"), (coarse, "Level 0"), (fine, f"Level {fine.deepest}"))
    for i, (mesh, title) in enumerate(columns):
        patches = None if mesh is scan else [p for p in np.unique(mesh.face_patch) if p.startswith("body")]
        n_faces = len(mesh.part(patches)[0])
        for row, position in enumerate(VIEWS):
            renderer = scene(mesh, patches, (i / 3, 0.5 - 0.5 * row, (i + 1) / 3, 1 - 0.5 * row), position)
            if row == 0:
                renderer.AddActor2D(text_actor(title, 0.035, 0.90, 25, bold=True))
                renderer.AddActor2D(text_actor(f"{n_faces:,} triangles", 0.035, 0.84, 17))
            window.AddRenderer(renderer)
    save(window, picture)


if __name__ == "__main__":
    main()
