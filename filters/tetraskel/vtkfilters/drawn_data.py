"""What a comparison draws, as polygonal data."""

from __future__ import annotations

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkPolyData

from tetraskel.kernels.drawn import Drawn
from tetraskel.kernels.object_boundary import Boundary
from tetraskel.vtkfilters.convert import add_arrays, to_cells, to_points


def data_of_drawn(drawn: Drawn) -> vtkPolyData:
    """Points with radii, lines and polygons; points that are in neither as vertices."""
    data = vtkPolyData()
    data.SetPoints(to_points(drawn.points))
    alone = np.ones(len(drawn), bool)
    alone[drawn.edges] = alone[drawn.connectivity] = False
    if alone.any():
        data.SetVerts(to_cells(np.flatnonzero(alone)[:, None]))
    if len(drawn.edges):
        data.SetLines(to_cells(drawn.edges))
    if len(drawn.offsets) > 1:
        data.SetPolys(to_cells(drawn.connectivity, drawn.offsets))
    add_arrays(data.GetPointData(), {"MaximumInscribedSphereRadius": drawn.radius})
    data.GetPointData().SetActiveScalars("MaximumInscribedSphereRadius")
    return data


def data_of_boundary(boundary: Boundary, points: np.ndarray) -> vtkPolyData:
    """The triangles, or in the plane the segments, with these points for its vertices."""
    data = vtkPolyData()
    data.SetPoints(to_points(points))
    if boundary.facets.shape[1] == 3:
        data.SetPolys(to_cells(boundary.facets))
    else:
        data.SetLines(to_cells(boundary.facets))
    return data
