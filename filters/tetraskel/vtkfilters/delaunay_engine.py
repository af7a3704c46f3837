"""Delaunay by VTK, for a ParaView without SciPy: the hull may miss slivers, which the engine's name tells.

vtkDelaunay3D drops points nearer than its tolerance (0.001 of the diagonal by default; 128 of 100,000 uniform ones in
VTK 9.7) and begins from a bounding triangulation whose distance decides how much of the hull is covered, so both are
set.
"""

from __future__ import annotations

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkPolyData, vtkStaticPointLocator
from vtkmodules.vtkFiltersCore import vtkDelaunay2D, vtkDelaunay3D

from tetraskel.errors import EngineError
from tetraskel.kernels.adjacency import facet_neighbors
from tetraskel.vtkfilters.convert import simplices_of, to_points

TOLERANCE = 1e-9
OFFSET = 100


def delaunay(points, tick):
    """Simplices, neighbours, and for each point the one that stands for it; see `tetraskel.kernels.qhull`."""
    cloud = vtkPolyData()
    cloud.SetPoints(to_points(points))
    engine = vtkDelaunay2D() if points.shape[1] == 2 else vtkDelaunay3D()
    engine.SetInputData(cloud)
    engine.SetTolerance(TOLERANCE)
    engine.SetOffset(OFFSET)
    engine.AddObserver("ProgressEvent", lambda *_: tick(engine.GetProgress()))
    engine.Update()
    simplices = simplices_of(engine.GetOutput())
    if len(simplices) == 0:
        raise EngineError(f"VTK's Delaunay found no simplex in {len(points)} points; use the qhull engine.")
    simplices = simplices.astype(np.int32)
    return simplices, facet_neighbors(simplices), _stands_for(points, simplices)


def _stands_for(points, simplices):
    """Each point itself where it is used, else the nearest point that is."""
    used = np.unique(simplices)
    stands_for = np.arange(len(points))
    dropped = np.setdiff1d(stands_for, used)
    if len(dropped):
        cloud = vtkPolyData()
        cloud.SetPoints(to_points(points[used]))
        locator = vtkStaticPointLocator()
        locator.SetDataSet(cloud)
        locator.BuildLocator()
        lost = np.zeros((len(dropped), 3))
        lost[:, : points.shape[1]] = points[dropped]
        stands_for[dropped] = used[[locator.FindClosestPoint(point) for point in lost]]
    return stands_for
