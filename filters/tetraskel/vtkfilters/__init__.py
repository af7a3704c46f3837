"""VTK filters that chain: usable in any VTK pipeline, in PyVista, and as the base of the ParaView plugin."""

from tetraskel.vtkfilters.base import SkeletonFilter
from tetraskel.vtkfilters.bezier_skeleton import BezierSkeleton
from tetraskel.vtkfilters.curve_skeleton import CurveSkeleton
from tetraskel.vtkfilters.delaunay_mesh import DelaunayMesh
from tetraskel.vtkfilters.flat_tetra_removal import FlatTetraRemoval
from tetraskel.vtkfilters.interior_cells import InteriorCells
from tetraskel.vtkfilters.point_thinning import PointThinning
from tetraskel.vtkfilters.raster_skeleton import RasterSkeleton
from tetraskel.vtkfilters.skeleton_output import SkeletonOutput
from tetraskel.vtkfilters.skeleton_surface import SkeletonSurface
from tetraskel.vtkfilters.tree_builder import TreeBuilder
from tetraskel.vtkfilters.voronoi_skeleton import VoronoiSkeleton

__all__ = [
    "BezierSkeleton",
    "CurveSkeleton",
    "DelaunayMesh",
    "FlatTetraRemoval",
    "InteriorCells",
    "PointThinning",
    "RasterSkeleton",
    "SkeletonFilter",
    "SkeletonOutput",
    "SkeletonSurface",
    "TreeBuilder",
    "VoronoiSkeleton",
]
