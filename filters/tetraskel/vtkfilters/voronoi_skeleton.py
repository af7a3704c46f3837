"""The filter that draws one of the four Voronoi skeletons."""

from __future__ import annotations

import numpy as np

from tetraskel.kernels.voronoi_skeleton import voronoi_skeleton
from tetraskel.options import VoronoiOptions
from tetraskel.vtkfilters.base import SkeletonFilter
from tetraskel.vtkfilters.convert import add_arrays, add_facts, holds_simplices, to_cells, to_points
from tetraskel.vtkfilters.object_input import mesh_and_inside


class VoronoiSkeleton(SkeletonFilter):
    """Points of a surface, or a mesh with a cell array Inside, to one of the four Voronoi skeletons of the object.

    Sk1 is the Voronoi vertices inside, sk2 all of the Voronoi edges and faces that is inside, sk3 the Voronoi elements
    wholly inside, sk4 the duals of the Delaunay cells inside. In space the result has sheets. A mesh of tetrahedra or
    of triangles in an unstructured grid is taken as it is: inside where its cell array Inside is not 0, or everywhere.
    The inside of points is found by gates.
    """

    options = VoronoiOptions
    input_doc = "Points on the surface of an object, or a mesh with a cell array Inside."
    drawn_as = ("thin lines",)
    tells = {  # noqa: RUF012
        "Points": "Points of the skeleton, Voronoi vertices or places where elements are cut.",
        "Lines": "Edges that are drawn.",
        "Polygons": "Faces that are drawn.",
        "Engine": "Who computed the triangulation.",
        "DuplicatesMerged": "Points for which another one stands, because they are equal or closer than the noise.",
    }

    def execute(self, inputs, outputs):
        """Draw the skeleton."""
        source, output = inputs[0], outputs[0]
        given = holds_simplices(source)
        telling = self.tick("Telling inside from outside", 0.4, 0.6)
        mesh, inside = mesh_and_inside(source, self.tick("Triangulating", 0.0, 0.4), telling)
        skeleton = voronoi_skeleton(
            mesh,
            inside=inside,
            **{name: getattr(self, name) for name in ("method", "least_separation", "least_angle")},
            tick=self.tick("Drawing the Voronoi skeleton", 0.0 if given else 0.6, 1.0),
        )
        _fill(output, skeleton)
        output.GetFieldData().PassData(source.GetFieldData())
        if not given:  # a mesh brings these facts from where it was made
            add_facts(output, {"Engine": mesh.engine, "DuplicatesMerged": mesh.n_merged})


def _fill(output, skeleton):
    """Vertices, lines and polygons with radii, and what each element was judged by."""
    output.SetPoints(to_points(skeleton.points))
    if len(skeleton.vertices):
        output.SetVerts(to_cells(skeleton.vertices[:, None]))
    if len(skeleton.lines):
        output.SetLines(to_cells(skeleton.lines))
    if skeleton.n_polygons:
        output.SetPolys(to_cells(skeleton.connectivity, skeleton.offsets))
    points = {"MaximumInscribedSphereRadius": skeleton.radius, "CellId": skeleton.cells.astype(np.int64)}
    add_arrays(output.GetPointData(), points)
    add_arrays(output.GetCellData(), {"Separation": skeleton.separation, "SeparationAngle": skeleton.angle})
    output.GetPointData().SetActiveScalars("MaximumInscribedSphereRadius")
