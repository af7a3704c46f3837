"""Skeletons of point sets by binary and ternary trees over their Delaunay triangulation."""

from tetraskel.errors import Aborted, EngineError, InputError, MeshError, TetraskelError
from tetraskel.kernels.adjacency import triangulation_of
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.tree import Tree, build_tree
from tetraskel.kernels.triangulate import triangulate

__version__ = "0.1.0"

__all__ = [
    "Aborted",
    "EngineError",
    "InputError",
    "MeshError",
    "TetraskelError",
    "Tree",
    "Triangulation",
    "build_tree",
    "triangulate",
    "triangulation_of",
]
