# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws one panel by VTK without a screen: faces, edges and lines, seen by a parallel projection."""
import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

OVERSAMPLING = 2  # pixels across are averaged


class Scene:
    """Collects what is to be seen; `extent`: left, right, bottom, top in the picture's plane, in lengths of the mesh."""

    def __init__(self, view, extent, width, height, depth):
        self.view, self.extent, self.width, self.height = view, extent, width, height
        self.depth = depth  # lowest and highest position along the view's direction
        self.renderer = vtk.vtkRenderer()
        self.renderer.SetBackground(1, 1, 1)
        self.pixel = (extent[1] - extent[0]) / width

    def add_faces(self, data, colors, light):
        """`colors`: of each polygon (rows of 3 bytes), or the name of an array on nodes and its lookup table. `light`: the
        part of the color that depends on how a face lies to the lamps."""
        mapper = vtk.vtkPolyDataMapper()
        if isinstance(colors, tuple):
            data.GetPointData().SetActiveScalars(colors[0])
            mapper.SetScalarModeToUsePointData()
            mapper.SetLookupTable(colors[1])
            mapper.UseLookupTableScalarRangeOn()
            mapper.InterpolateScalarsBeforeMappingOn()
        else:
            data.GetCellData().SetScalars(numpy_to_vtk(colors, deep=True, array_type=vtk.VTK_UNSIGNED_CHAR))
            mapper.SetScalarModeToUseCellData()
        mapper.SetInputData(data)
        mapper.SetResolveCoincidentTopologyToPolygonOffset()
        mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters(1.5, 1.5)
        actor = vtk.vtkActor()
        actor.SetMapper(mapper)
        look = actor.GetProperty()
        look.SetInterpolationToFlat()
        look.SetAmbient(1 - light)
        look.SetDiffuse(light)
        self.renderer.AddActor(actor)

    def add_lines(self, data, color, width, opacity=1.0):
        """`color`: three bytes; `width` in pixels of the picture. The lines lie a little in front of what they lie on."""
        mapper = vtk.vtkPolyDataMapper()
        mapper.SetInputData(data)
        mapper.ScalarVisibilityOff()
        actor = vtk.vtkActor()
        actor.SetMapper(mapper)
        actor.SetPosition(*(self.view.toward * 0.3 * self.pixel))
        look = actor.GetProperty()
        look.SetColor(*(np.asarray(color) / 255))
        look.LightingOff()
        look.SetLineWidth(width * OVERSAMPLING)
        look.SetOpacity(opacity)
        self.renderer.AddActor(actor)

    def _light(self):
        self.renderer.RemoveAllLights()
        view = self.view
        for right, up, toward, strength in ((-0.6, 0.9, 1.0, 0.85), (0.9, -0.2, 0.8, 0.3)):
            light = vtk.vtkLight()
            light.SetPosition(*(right * view.right + up * view.up + toward * view.toward))
            light.SetFocalPoint(0, 0, 0)
            light.SetIntensity(strength)
            self.renderer.AddLight(light)

    def image(self):
        """The panel as rows of pixels, from the top, three bytes each."""
        self._light()
        left, right, bottom, top = self.extent
        view, (near, far) = self.view, (self.depth[1], self.depth[0])
        focus = view.right * (left + right) / 2 + view.up * (bottom + top) / 2 + view.toward * (near + far) / 2
        distance = max(near - far, right - left) + 1e-30
        camera = self.renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetFocalPoint(*focus)
        camera.SetPosition(*(focus + view.toward * distance))
        camera.SetViewUp(*view.up)
        camera.SetParallelScale((top - bottom) / 2)
        reach = 0.55 * (near - far) + 10 * self.pixel
        camera.SetClippingRange(distance - reach, distance + reach)
        window = vtk.vtkRenderWindow()
        window.SetOffScreenRendering(1)
        window.SetMultiSamples(4)
        window.SetSize(self.width * OVERSAMPLING, self.height * OVERSAMPLING)
        window.AddRenderer(self.renderer)
        window.Render()
        grab = vtk.vtkWindowToImageFilter()
        grab.SetInput(window)
        grab.ReadFrontBufferOff()
        grab.Update()
        pixels = vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars())
        k = OVERSAMPLING
        small = pixels.reshape(self.height, k, self.width, k, 3).mean(axis=(1, 3)).round().astype(np.uint8)
        window.Finalize()
        return small[::-1]


def lookup_table(colors):
    """A table over 0 to 1."""
    table = vtk.vtkLookupTable()
    table.SetNumberOfTableValues(len(colors))
    for i, color in enumerate(colors):
        table.SetTableValue(i, *color[:3], 1)
    table.SetNanColor(0.75, 0.75, 0.75, 1)
    table.SetRange(0, 1)
    return table
