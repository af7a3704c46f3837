"""Skeletons of point sets by binary and ternary trees over their Delaunay triangulation."""

from tetraskel.errors import Aborted, EngineError, InputError, InsideWarning, MeshError, TetraskelError
from tetraskel.kernels.adjacency import triangulation_of
from tetraskel.kernels.interior import interior
from tetraskel.kernels.mesh import Triangulation, submesh
from tetraskel.kernels.tree import Tree, build_tree
from tetraskel.kernels.triangulate import triangulate

__version__ = "0.1.0"

__all__ = [
    "Aborted",
    "EngineError",
    "InputError",
    "InsideWarning",
    "MeshError",
    "TetraskelError",
    "Tree",
    "Triangulation",
    "build_tree",
    "interior",
    "submesh",
    "triangulate",
    "triangulation_of",
]
