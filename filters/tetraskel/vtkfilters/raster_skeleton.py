"""The filter that draws skeletons of masks."""

from __future__ import annotations

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPointSet

from tetraskel.errors import InputError
from tetraskel.kernels.raster_mask import Mask, rasterise
from tetraskel.kernels.raster_skeleton import raster_skeleton
from tetraskel.options import RasterInputOptions
from tetraskel.vtkfilters.base import SkeletonFilter
from tetraskel.vtkfilters.convert import add_arrays, add_facts, pass_facts, to_cells, to_points
from tetraskel.vtkfilters.object_input import mesh_and_inside


class RasterSkeleton(SkeletonFilter):
    """A mask, or points or a mesh made into one, to its morphological, thinned or distance skeleton.

    An image is inside where its point array is not 0. Points and meshes are made into a mask of the given resolution:
    a mesh of tetrahedra or of triangles in an unstructured grid by its cell array Inside, or all of it; the inside of
    points is found by gates. The points of the result are grid points of the mask, joined to their neighbours; field
    data hold the grid.
    """

    options = RasterInputOptions
    input_type = "vtkDataSet"
    drawn_as = ("thin lines",)
    tells = {  # noqa: RUF012
        "Points": "Grid points of the skeleton.",
        "Lines": "Pairs of neighbours among them.",
        "Grid": "Grid points of the mask along each axis.",
    }
    input_doc = "An image that is not 0 inside, points on the surface of an object, or a mesh with a cell array Inside."

    def execute(self, inputs, outputs):
        """Make the mask and draw its skeleton."""
        source, output = inputs[0], outputs[0]
        flat_axis, mask = self._mask(source)
        skeleton = raster_skeleton(
            mask.values,
            **{name: getattr(self, name) for name in ("method", "element", "ridge_slope")},
            spacing=mask.spacing,
            origin=mask.origin,
            tick=self.tick("Drawing the skeleton of the mask", 0.5, 1.0),
        )
        self._fill(output, skeleton, flat_axis(skeleton.points))
        pass_facts(source, output)

    def _mask(self, source):
        """How points of the mask become points of space, and the mask."""
        if isinstance(source, vtkImageData):
            return self._mask_of_image(source)
        if not isinstance(source, vtkPointSet):
            raise InputError(f"expected an image, points or a mesh, got {source.GetClassName()}; resample it first.")
        telling = self.tick("Telling inside from outside", 0.2, 0.3)
        mesh, inside = mesh_and_inside(source, self.tick("Triangulating", 0.0, 0.2), telling)
        mask = rasterise(mesh, inside=inside, resolution=self.resolution, tick=self.tick("Making the mask", 0.3, 0.5))
        return (lambda points: points) if mesh.plane is None else mesh.plane.lift, mask

    def _mask_of_image(self, image):
        attributes = image.GetPointData()
        array = attributes.GetArray(self.mask_array) if self.mask_array else attributes.GetScalars()
        if array is None or array.GetNumberOfComponents() != 1:
            wanted = repr(self.mask_array) if self.mask_array else "of scalars"
            raise InputError(f"expected a point array {wanted} with one number each on the image, got none; name one.")
        turn = np.array([[image.GetDirectionMatrix().GetElement(i, j) for j in range(3)] for i in range(3)])
        extent = np.array(image.GetExtent())
        spacing = np.array(image.GetSpacing())
        values = vtk_to_numpy(array).reshape(image.GetDimensions()[::-1]).T
        start = np.array(image.GetOrigin()) + turn @ (extent[::2] * spacing)
        axes = np.flatnonzero(np.array(values.shape) > 1)
        if len(axes) < 2:  # a row of grid points, or one, is a narrow image
            axes = np.union1d(axes, np.setdiff1d([0, 1, 2], axes)[: 2 - len(axes)])
        mask = values.reshape([values.shape[axis] for axis in axes])
        ways = turn[:, axes]
        return lambda points: start + points @ ways.T, Mask(mask, spacing[axes], np.zeros(len(axes)))

    def _fill(self, output, skeleton, positions):
        output.SetPoints(to_points(positions))
        alone = np.setdiff1d(np.arange(len(skeleton)), skeleton.lines)
        if len(alone):
            output.SetVerts(to_cells(alone[:, None]))
        if len(skeleton.lines):
            output.SetLines(to_cells(skeleton.lines))
        arrays = {"MaximumInscribedSphereRadius": skeleton.radius, "GridIndex": skeleton.indices.astype(np.int32)}
        if skeleton.method == "morphological":
            arrays["Subset"] = skeleton.subset
        add_arrays(output.GetPointData(), arrays)
        output.GetPointData().SetActiveScalars("MaximumInscribedSphereRadius")
        grid = {"GridDimensions": np.array(skeleton.shape, np.int32), "GridSpacing": skeleton.spacing}
        add_arrays(output.GetFieldData(), {**grid, "GridOrigin": skeleton.origin})
        add_facts(output, {"Grid": " x ".join(map(str, skeleton.shape))})
