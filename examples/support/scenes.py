# SPDX-License-Identifier: MIT
"""Three-dimensional scenes of the gallery, rendered by VTK with ambient occlusion. The z axis is
vertical, and there is a floor at z = 0 with a soft shadow.

    scene = Scene((720, 540), eye=(3, -4, 2), focus=(0, 0, 0.5))
    scene.spheres(x, radius, colours)
    pixels = scene.pixels()
"""

import numpy as np
from PIL import Image, ImageDraw, ImageFilter

import vtk
from support.films import BACKGROUND, to_rgb
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

TO_LIGHT = np.array([0.45, -0.4, 1.0])  # not normalised: its height is one
SUPERSAMPLING = 2
SHADOW_PIXELS = 512
SHADOW = 0.55     # darkness of the deepest shadow
PENUMBRA = 0.10   # blur of the shadow over the height of what casts it


def poly_data(points):
    data = vtk.vtkPolyData()
    data.SetPoints(vtk.vtkPoints())
    data.GetPoints().SetData(numpy_to_vtk(np.ascontiguousarray(points, dtype=np.float32), deep=True))
    return data


def add_array(data, name, values):
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    data.GetPointData().AddArray(array)


class Scene:
    def __init__(self, size, eye, focus, view_angle=20.0, floor=3.0, occlusion=0.1):
        """size: [pixels]; eye, focus: points [m]; view_angle: vertical [degrees]; floor: half the
        side of the floor [m]; occlusion: distance at which neighbours take light [m]."""
        self.renderer = vtk.vtkRenderer()
        self.renderer.SetBackground(to_rgb(BACKGROUND))
        self.window = vtk.vtkRenderWindow()
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(0)
        self.window.SetSize(*(SUPERSAMPLING * pixels for pixels in size))
        self.window.AddRenderer(self.renderer)
        self.size = size
        self.look(eye, focus)
        self.renderer.GetActiveCamera().SetViewAngle(view_angle)
        self.light()
        self.occlude(occlusion)
        self.floor_centre, self.floor = np.array([focus[0], focus[1]]), floor
        self.actors = []
        self.texture = None
        self.make_floor()

    def look(self, eye, focus):
        camera = self.renderer.GetActiveCamera()
        camera.SetViewUp(0, 0, 1)
        camera.SetPosition(*eye)
        camera.SetFocalPoint(*focus)

    def light(self):
        """A key light, a cool fill light from the other side, and some light from the camera."""
        self.renderer.AutomaticLightCreationOff()
        for towards, intensity, colour in ((TO_LIGHT, 0.9, (1, 0.985, 0.95)),
                                           ((-2, -1.5, 1.2), 0.26, (0.9, 0.95, 1)),
                                           (None, 0.26, (1, 1, 1))):
            light = vtk.vtkLight()
            if towards is None:
                light.SetLightTypeToHeadlight()
            else:
                light.SetLightTypeToSceneLight()
                light.SetPosition(*towards)
                light.SetFocalPoint(0, 0, 0)
            light.PositionalOff()
            light.SetIntensity(intensity)
            light.SetColor(*colour)
            self.renderer.AddLight(light)

    def occlude(self, radius):
        passes = vtk.vtkRenderPassCollection()
        passes.AddItem(vtk.vtkLightsPass())
        passes.AddItem(vtk.vtkOpaquePass())
        sequence = vtk.vtkSequencePass()
        sequence.SetPasses(passes)
        camera = vtk.vtkCameraPass()
        camera.SetDelegatePass(sequence)
        occlusion = vtk.vtkSSAOPass()
        occlusion.SetRadius(radius)
        occlusion.SetBias(0.02 * radius)
        occlusion.SetKernelSize(24)
        occlusion.BlurOn()
        occlusion.SetDelegatePass(camera)
        self.renderer.SetPass(occlusion)

    def make_floor(self):
        plane = vtk.vtkPlaneSource()
        (x, y), s = self.floor_centre, self.floor
        plane.SetOrigin(x - s, y - s, 0)
        plane.SetPoint1(x + s, y - s, 0)
        plane.SetPoint2(x - s, y + s, 0)
        mapper = vtk.vtkPolyDataMapper()
        mapper.SetInputConnection(plane.GetOutputPort())
        actor = vtk.vtkActor()
        actor.SetMapper(mapper)
        # Of the colour of the background, so that no horizon is seen.
        actor.GetProperty().LightingOff()
        self.texture = vtk.vtkTexture()
        self.texture.InterpolateOn()
        actor.SetTexture(self.texture)
        self.renderer.AddActor(actor)
        self.cast(np.empty((0, 3)), 0.0)

    def cast(self, x, radius):
        """The shadow of spheres on the floor, for a light of some extent: the higher a sphere, the
        more its shadow is blurred."""
        light = np.ones((SHADOW_PIXELS, SHADOW_PIXELS))
        scale = SHADOW_PIXELS / (2 * self.floor)  # [pixels/m]
        radius = np.broadcast_to(radius, len(x))
        at = x[:, :2] - x[:, 2:] * TO_LIGHT[:2] - self.floor_centre + self.floor
        step = max(x[:, 2].max() / 16, 1e-9) if len(x) else 1.0
        layers = np.sqrt(x[:, 2].clip(0) / step).astype(int)  # thinner near the floor
        for layer in np.unique(layers):
            mask = Image.new("L", light.shape)
            draw = ImageDraw.Draw(mask)
            of_layer = layers == layer
            for (a, b), r in zip(scale * at[of_layer], scale * radius[of_layer]):
                draw.ellipse([a - r, b - r, a + r, b + r], fill=255)
            blur = scale * (PENUMBRA * x[of_layer, 2].mean() + 0.4 * radius[of_layer].mean())
            light *= 1 - np.asarray(mask.filter(ImageFilter.GaussianBlur(blur))) / 255
        colour = np.array(to_rgb(BACKGROUND)) * (1 - SHADOW * (1 - light[:, :, None]))
        pixels = (255 * colour + 0.5).astype(np.uint8)
        image = vtk.vtkImageData()
        image.SetDimensions(SHADOW_PIXELS, SHADOW_PIXELS, 1)
        image.GetPointData().SetScalars(numpy_to_vtk(pixels.reshape(-1, 3), deep=True))
        self.texture.SetInputData(image)

    def clear(self):
        for actor in self.actors:
            self.renderer.RemoveActor(actor)
        self.actors = []

    def add(self, shape, direct=True, specular=0.15, power=25.0):
        """Adds an actor for a shape; returns its vtkProperty. direct: whether the shape has colours."""
        mapper = vtk.vtkPolyDataMapper()
        mapper.SetInputData(shape)
        if not direct:
            mapper.ScalarVisibilityOff()
        actor = vtk.vtkActor()
        actor.SetMapper(mapper)
        look = actor.GetProperty()
        look.SetInterpolationToPhong()
        look.SetAmbient(0.06)
        look.SetSpecular(specular)
        look.SetSpecularPower(power)
        self.renderer.AddActor(actor)
        self.actors.append(actor)
        return look

    def spheres(self, x, radius, colours, casts=True):
        """colours: (n, 3) or (n, 4), from 0 to 1."""
        data = poly_data(x)
        add_array(data, "colour", (255 * np.asarray(colours)[:, :3] + 0.5).astype(np.uint8))
        add_array(data, "diameter", 2.0 * np.broadcast_to(radius, len(x)))
        sphere = vtk.vtkSphereSource()
        sphere.SetThetaResolution(20)
        sphere.SetPhiResolution(14)
        glyphs = vtk.vtkGlyph3D()
        glyphs.SetInputData(data)
        glyphs.SetSourceConnection(sphere.GetOutputPort())
        glyphs.SetInputArrayToProcess(0, 0, 0, 0, "diameter")
        glyphs.SetInputArrayToProcess(3, 0, 0, 0, "colour")
        glyphs.SetScaleModeToScaleByScalar()
        glyphs.SetColorModeToColorByScalar()
        glyphs.Update()
        self.add(glyphs.GetOutput())
        if casts:
            self.cast(x, radius)

    def water(self, x, values, spacing, size, colours, norm):
        """The surface of the water in a tank, from particles at x: where a sum of Gaussians is half
        of what it is inside. Coloured by values of the particles.

        spacing: of the particles [m]; size: length, depth and height of the tank [m].
        """
        size = np.asarray(size)
        # Images in the walls, so that the water reaches them.
        for axis in range(3):
            for wall in (0.0, size[axis]):
                near = np.abs(x[:, axis] - wall) < 2 * spacing
                image = x[near].copy()
                image[:, axis] = 2 * wall - image[:, axis]
                x, values = np.concatenate([x, image]), np.concatenate([values, values[near]])
        data = poly_data(x)
        add_array(data, "value", values.astype(np.float32))

        splatter = vtk.vtkGaussianSplatter()
        splatter.SetInputData(data)
        bounds = np.column_stack([np.zeros(3), size])
        splatter.SetModelBounds(*bounds.ravel())
        splatter.SetSampleDimensions(*(np.round(size / (0.36 * spacing)).astype(int) + 1))
        reach, decay = 1.6, 5.0  # the Gaussian is exp(−decay (r/reach)²), r in spacings
        splatter.SetRadius(reach * spacing / size.max())
        splatter.SetExponentFactor(-decay)
        splatter.ScalarWarpingOff()
        splatter.NormalWarpingOff()
        splatter.SetAccumulationModeToSum()
        splatter.SetNullValue(0)
        splatter.CappingOn()
        splatter.SetCapValue(0)
        inside = (np.pi / decay) ** 1.5 * reach**3
        surface = vtk.vtkFlyingEdges3D()
        surface.SetInputConnection(splatter.GetOutputPort())
        surface.SetValue(0, 0.45 * inside)
        surface.ComputeNormalsOff()
        smooth = vtk.vtkWindowedSincPolyDataFilter()
        smooth.SetInputConnection(surface.GetOutputPort())
        smooth.SetNumberOfIterations(20)
        smooth.SetPassBand(0.04)
        smooth.NormalizeCoordinatesOn()
        normals = vtk.vtkPolyDataNormals()
        normals.SetInputConnection(smooth.GetOutputPort())
        normals.SplittingOff()
        kernel = vtk.vtkGaussianKernel()
        kernel.SetRadius(2.5 * spacing)
        kernel.SetSharpness(2.5)
        interpolator = vtk.vtkPointInterpolator()
        interpolator.SetInputConnection(normals.GetOutputPort())
        interpolator.SetSourceData(data)
        interpolator.SetKernel(kernel)
        interpolator.SetNullPointsStrategyToClosestPoint()
        interpolator.Update()
        result = interpolator.GetOutput()
        found = vtk_to_numpy(result.GetPointData().GetArray("value"))
        shown = numpy_to_vtk((255 * colours(norm(found))[:, :3] + 0.5).astype(np.uint8), deep=True)
        result.GetPointData().SetScalars(shown)
        self.add(result, specular=0.45, power=60.0)

    def tubes(self, segments, radius, colour):
        """Straight tubes between pairs of points."""
        points = np.reshape(segments, (-1, 3))
        data = poly_data(points)
        lines = vtk.vtkCellArray()
        for k in range(0, len(points), 2):
            lines.InsertNextCell(2, (k, k + 1))
        data.SetLines(lines)
        tube = vtk.vtkTubeFilter()
        tube.SetInputData(data)
        tube.SetRadius(radius)
        tube.SetNumberOfSides(10)
        tube.CappingOn()
        tube.Update()
        self.add(tube.GetOutput(), direct=False).SetColor(to_rgb(colour))

    def mesh(self, path, top, shift, colour):
        """The part with y > 0 and z < top of a surface in an STL file, moved by a vector [m]."""
        shape = vtk.vtkSTLReader()
        shape.SetFileName(str(path))
        for origin, normal in (((0, 0, 0), (0, 1, 0)), ((0, 0, top), (0, 0, -1))):
            plane = vtk.vtkPlane()
            plane.SetOrigin(*origin)
            plane.SetNormal(*normal)
            part = vtk.vtkClipPolyData()
            part.SetInputConnection(shape.GetOutputPort())
            part.SetClipFunction(plane)
            shape = part
        move = vtk.vtkTransform()
        move.Translate(*shift)
        moved = vtk.vtkTransformPolyDataFilter()
        moved.SetTransform(move)
        moved.SetInputConnection(shape.GetOutputPort())
        moved.Update()
        look = self.add(moved.GetOutput(), direct=False)
        look.SetColor(to_rgb(colour))
        look.SetInterpolationToFlat()

    def pixels(self):
        """(height, width, 3), unsigned bytes."""
        self.window.Render()
        grab = vtk.vtkWindowToImageFilter()
        grab.SetInput(self.window)
        grab.ReadFrontBufferOff()
        grab.Update()
        image = grab.GetOutput()
        width, height, _ = image.GetDimensions()
        pixels = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1)
        large = Image.fromarray(np.ascontiguousarray(pixels[::-1, :, :3]))
        return np.asarray(large.resize(self.size, Image.LANCZOS))
