"""Skeletons of point sets by binary and ternary trees over their Delaunay triangulation."""

from tetraskel.comparison import Row, compare
from tetraskel.errors import Aborted, EngineError, InputError, InsideWarning, MeshError, TetraskelError
from tetraskel.kernels.adjacency import triangulation_of
from tetraskel.kernels.bezier_skeleton import BezierSkeleton, bezier_skeleton
from tetraskel.kernels.binary import BinaryTree, binarize
from tetraskel.kernels.curve import CurveModel, curve_model, curve_skeleton, draw_curve
from tetraskel.kernels.curve_skeleton import Skeleton
from tetraskel.kernels.decode import decode_tree
from tetraskel.kernels.denoise import Denoised, denoised
from tetraskel.kernels.flat import remove_flat
from tetraskel.kernels.gates import gate_arrays, gate_tree
from tetraskel.kernels.interior import interior
from tetraskel.kernels.measures import measure
from tetraskel.kernels.medial_mesh import MedialMesh, medial_mesh
from tetraskel.kernels.mesh import Triangulation, submesh
from tetraskel.kernels.outline import inside_by_outline
from tetraskel.kernels.raster_mask import Mask, rasterise
from tetraskel.kernels.raster_skeleton import RasterSkeleton, morphological_reversal, raster_skeleton
from tetraskel.kernels.skeleton import TreeSkeleton, assemble_skeleton
from tetraskel.kernels.skeleton_surface import RebuiltSurface, skeleton_surface
from tetraskel.kernels.surface_error import surface_error
from tetraskel.kernels.thinning import Thinned, thinned
from tetraskel.kernels.tree import Tree, build_tree
from tetraskel.kernels.triangulate import triangulate
from tetraskel.kernels.voronoi_simplification import VoronoiSkeleton
from tetraskel.kernels.voronoi_skeleton import voronoi_skeleton
from tetraskel.pipeline import tree_skeleton

__version__ = "0.1.0"

__all__ = [
    "Aborted",
    "BezierSkeleton",
    "BinaryTree",
    "CurveModel",
    "Denoised",
    "EngineError",
    "InputError",
    "InsideWarning",
    "Mask",
    "MedialMesh",
    "MeshError",
    "RasterSkeleton",
    "RebuiltSurface",
    "Row",
    "Skeleton",
    "TetraskelError",
    "Thinned",
    "Tree",
    "TreeSkeleton",
    "Triangulation",
    "VoronoiSkeleton",
    "assemble_skeleton",
    "bezier_skeleton",
    "binarize",
    "build_tree",
    "compare",
    "curve_model",
    "curve_skeleton",
    "decode_tree",
    "denoised",
    "draw_curve",
    "gate_arrays",
    "gate_tree",
    "inside_by_outline",
    "interior",
    "measure",
    "medial_mesh",
    "morphological_reversal",
    "raster_skeleton",
    "rasterise",
    "remove_flat",
    "skeleton_surface",
    "submesh",
    "surface_error",
    "thinned",
    "tree_skeleton",
    "triangulate",
    "triangulation_of",
    "voronoi_skeleton",
]
