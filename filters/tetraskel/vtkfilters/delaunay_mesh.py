"""The filter that triangulates points."""

from __future__ import annotations

from tetraskel.kernels.triangulate import triangulate
from tetraskel.options import DelaunayOptions
from tetraskel.vtkfilters.base import SkeletonFilter
from tetraskel.vtkfilters.convert import add_arrays, add_facts, copy_rows, fill_grid, points_of


class DelaunayMesh(SkeletonFilter):
    """Points to the tetrahedra (triangles, if they lie in a plane) of their Delaunay triangulation.

    Equal points are merged; the point array `OriginalPointIds` names the input point of each, and the other point
    arrays are carried over. Field data: `Engine`, `InputPoints`, `DuplicatesMerged` (points for which another one
    stands) and `Noise` (what was taken out, in the unit of the points).
    """

    options = DelaunayOptions
    input_doc = "The points; cells are ignored."
    output_type = "vtkUnstructuredGrid"
    drawn_as = ("mesh",)
    tells = {  # noqa: RUF012
        "Engine": "Who computed the triangulation.",
        "InputPoints": "Points that came in.",
        "DuplicatesMerged": "Points for which another one stands, because they are equal or closer than the noise.",
        "Cells": "Tetrahedra, or triangles of a plane.",
        "Noise": "What was taken out of the points, in their unit.",
    }

    def execute(self, inputs, outputs):
        """Triangulate the points of the input."""
        source, grid = inputs[0], outputs[0]
        options = {"engine": self.engine, "joggle": self.joggle, "denoise": self.denoise}
        mesh = triangulate(points_of(source), **options, tick=self.tick("Triangulating"))
        fill_grid(grid, mesh)
        copy_rows(source.GetPointData(), grid.GetPointData(), mesh.original_ids)
        add_arrays(grid.GetPointData(), {"OriginalPointIds": mesh.original_ids})
        grid.GetFieldData().PassData(source.GetFieldData())
        facts = {"Engine": mesh.engine, "InputPoints": len(mesh.point_map), "DuplicatesMerged": mesh.n_merged}
        add_facts(grid, {**facts, "Noise": mesh.noise})
