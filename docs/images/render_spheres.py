#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the surface meshes of the charged spheres and their plate, level 0 beside a later level: a sphere from near by
and both over the plate. The meshed quarter is mirrored; edges and faces are colored by level.

Usage: render_spheres.py COARSE.hdf FINE.hdf PICTURE.png    (under xvfb-run where there is no screen)
"""
import sys

import numpy as np
import vtk

from render import (BODY_FACE, EDGE, PLANE_FACE, Mesh, edge_actor, face_actor, save, text_actor, white_window)

SPHERE, PLATE = ("sphere",), ("plate",)
WIDTH, HEIGHT = 1480, 1000
SPLIT = 0.39  # height of the lower pictures


def mirrored(mesh):
    """The mesh with the images of its faces in x = 0 and y = 0."""
    sides = [np.array(side) for side in ((1, 1, 1), (-1, 1, 1), (1, -1, 1), (-1, -1, 1))]
    near = mesh.part(SPHERE)[0].ravel()
    mesh.center = (mesh.points[near].max(axis=0) + mesh.points[near].min(axis=0)) / 2 * (1, 0, 1)
    mesh.radius = np.ptp(mesh.points[near, 2]) / 2
    mesh.n_sphere, mesh.n_plate = len(mesh.part(SPHERE)[0]), len(mesh.part(PLATE)[0])
    mesh.face = np.concatenate([mesh.face + k * len(mesh.points) for k in range(len(sides))])
    mesh.face_level = np.tile(mesh.face_level, len(sides))
    mesh.face_patch = np.tile(mesh.face_patch, len(sides))
    mesh.points = np.concatenate([mesh.points * side for side in sides])
    return mesh


def scene(mesh, box, focus, position, angle, width_scale):
    renderer = vtk.vtkRenderer()
    renderer.SetViewport(*box)
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor(face_actor(mesh, PLATE, PLANE_FACE, False))
    renderer.AddActor(face_actor(mesh, SPHERE, BODY_FACE, True))
    widths = tuple(width_scale * w for w in (1.1, 0.9, 0.8, 0.7))
    for patch in (PLATE, SPHERE):
        for actor in edge_actor(mesh, patch, widths):
            renderer.AddActor(actor)
    renderer.RemoveAllLights()
    for where, strength in (((-20, -40, 40), 0.85), ((-10, -20, -40), 0.35)):
        light = vtk.vtkLight()
        light.SetPosition(*(np.array(focus) + where))
        light.SetFocalPoint(*focus)
        light.SetIntensity(strength)
        renderer.AddLight(light)
    camera = renderer.GetActiveCamera()
    camera.SetFocalPoint(*focus)
    camera.SetPosition(*position)
    camera.SetViewUp(0, 0, 1)
    camera.SetViewAngle(angle)
    renderer.ResetCameraClippingRange()
    return renderer


def column(mesh, title, left, right, legend_levels):
    """Two pictures one above the other: a sphere, and both over the plate."""
    unit = mesh.center[2]  # the height of the centers over the plate
    at = mesh.center
    near = scene(mesh, (left, SPLIT, right, 1), at, at + np.array((-6, -8, 3)) * mesh.radius, 16.5, 1.2)
    far = scene(mesh, (left, 0, right, SPLIT), (0, 0, 0.46 * unit), (unit, -9 * unit, 4.2 * unit), 12.5, 0.8)
    near.AddActor2D(text_actor(title, 0.035, 0.925, 25, bold=True))
    counts = f"{mesh.n_cells:,} cells, {mesh.n_sphere:,} faces on the half sphere, {mesh.n_plate:,} on the plate"
    near.AddActor2D(text_actor(counts, 0.035, 0.880, 17))
    for level in range(legend_levels):
        color = EDGE[min(level, len(EDGE) - 1)] / 255
        near.AddActor2D(text_actor(f"level {level}", 0.035 + 0.125 * level, 0.03, 19, color, bold=True))
    return near, far


def main():
    coarse, fine, picture = mirrored(Mesh(sys.argv[1])), mirrored(Mesh(sys.argv[2])), sys.argv[3]
    window = white_window(WIDTH, HEIGHT)
    for renderer in (*column(coarse, "Before", 0, 0.498, 0),
                     *column(fine, "After", 0.502, 1, fine.deepest + 1)):
        window.AddRenderer(renderer)
    save(window, picture)
    print(f"{picture}: {coarse.n_cells} and {fine.n_cells} cells")


if __name__ == "__main__":
    main()
