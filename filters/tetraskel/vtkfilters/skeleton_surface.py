"""The filter that rebuilds an object from its skeleton."""

from __future__ import annotations

import itertools

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkFiltersGeneral import vtkContourTriangulator

from tetraskel.kernels.skeleton_surface import RebuiltSurface, skeleton_surface
from tetraskel.kernels.surface_error import surface_error
from tetraskel.options import SurfaceOptions
from tetraskel.vtkfilters.base import SkeletonFilter
from tetraskel.vtkfilters.convert import add_arrays, add_facts, points_of, surface_of_data, to_cells, to_points
from tetraskel.vtkfilters.skeletondata import balls_of, lies_in_plane

MANY_THICKENED = 0.01  # of the points


class SkeletonSurface(SkeletonFilter):
    """A skeleton with radii back to the object: the surface of its balls and of the cones between neighbouring ones.

    Faces, as of medial sheets, count by their sides: where they are smaller than the radii they give back plates. In
    space a watertight surface of triangles; in the plane the region's closed outline, inside to the left, with
    the region as triangles. Give the original points or surface at the second input to have the error in percent of
    their diagonal in the field data: ErrorMean and ErrorMax from the original to the rebuilt surface, with an original
    surface also BackErrorMean and BackErrorMax the other way.
    """

    options = SurfaceOptions
    input_doc = "A skeleton: lines with a point array of radii; faces count by their sides, points alone are balls."
    input_type = "vtkPolyData"
    drawn_as = ("surface",)
    tells = {  # noqa: RUF012
        "Polygons": "Triangles of the surface or of the region.",
        "Spacing": "Side of the cells it was found on.",
        "Thickened": "Balls thinner than these cells can show, which were drawn thicker.",
        "ErrorMean": "Mean distance from the original to the rebuilt surface, in percent of the diagonal.",
        "ErrorMax": "Largest distance from the original to the rebuilt surface, in percent of the diagonal.",
    }
    second_input = ("Original", 1, "vtkPointSet", "The points or the surface the skeleton was made from, to compare.")

    def execute(self, inputs, outputs):
        """Rebuild the surface and compare it with the original."""
        source, original = inputs
        graph = balls_of(source, self.radius_array, faces=True)
        in_plane = self.dimension == "plane" or (self.dimension == "auto" and lies_in_plane(source))
        surface = skeleton_surface(
            graph,
            spacing=self.spacing,
            cells_per_radius=self.cells_per_radius,
            max_cells=self.max_cells,
            dimension="plane" if in_plane else "space",
            tick=self.tick("Rebuilding the surface", 0.0, 0.8 if original is not None else 1.0),
        )
        fill_surface(outputs[0], surface)
        outputs[0].GetFieldData().PassData(source.GetFieldData())
        facts = {"Spacing": surface.spacing, "Thickened": surface.thickened, "Capped": int(surface.capped)}
        add_facts(outputs[0], facts)
        self._say(surface, len(graph))
        if original is not None and len(graph):
            add_facts(outputs[0], self._error(surface, original, in_plane))

    def _error(self, surface, original, in_plane):
        triangles = None
        points = points_of(original)
        if not in_plane and isinstance(original, vtkPolyData) and original.GetNumberOfPolys():
            points, triangles = surface_of_data(original)
        return surface_error(surface, points, triangles, tick=self.tick("Comparing", 0.8, 1.0))

    def _say(self, surface, n_points):
        if surface.capped:
            self.warn(f"cells of {surface.spacing:g} are larger than the radii ask for; raise MaxCells or set Spacing.")
        if surface.thickened > MANY_THICKENED * n_points:
            self.warn(
                f"{surface.thickened} of {n_points} balls are thinner than the cells of {surface.spacing:g} can show "
                "and were drawn thicker; lower Spacing."
            )


def fill_surface(output: vtkPolyData, surface: RebuiltSurface) -> None:
    """A rebuilt surface as polygonal data; a region of the plane as its outline and, filled, as triangles."""
    output.SetPoints(to_points(surface.points))
    arrays = {"MaximumInscribedSphereRadius": surface.radius, "BranchId": surface.branch.astype(np.int32)}
    if surface.simplices.shape[1] == 3:
        output.SetPolys(to_cells(surface.simplices))
        add_arrays(output.GetPointData(), {"Normals": surface.normals.astype(np.float32)})
        output.GetPointData().SetActiveNormals("Normals")
    elif len(surface):
        _fill_region(output, surface)
    add_arrays(output.GetPointData(), arrays)
    output.GetPointData().SetActiveScalars("BranchId")


def _fill_region(output, surface):
    offsets, ids = surface.loops
    rows = [ids[start:stop] for start, stop in itertools.pairwise(offsets)]
    closed = np.concatenate([np.append(row, row[0]) for row in rows])
    output.SetLines(to_cells(closed, np.concatenate([[0], np.cumsum([len(row) + 1 for row in rows])])))
    outline = vtkPolyData()
    outline.SetPoints(output.GetPoints())
    outline.SetLines(to_cells(surface.simplices))
    filled = vtkContourTriangulator()
    filled.SetInputData(outline)
    filled.Update()
    output.SetPolys(filled.GetOutput().GetPolys())
