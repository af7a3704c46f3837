"""Points to curve skeleton: the stages in order, and what is kept so that another detail is drawn at once."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from tetraskel.errors import InputError, TetraskelError
from tetraskel.kernels.branches import FINEST, Branches, grow_branches
from tetraskel.kernels.burning import burn_times
from tetraskel.kernels.chains import merge_close_junctions, trace_chains
from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.collapse import Collapse, collapse_to_graph
from tetraskel.kernels.core import Core, loop_core
from tetraskel.kernels.dual_complex import DualComplex, dual_complex
from tetraskel.kernels.inner_mesh import InnerMesh, inner_mesh
from tetraskel.kernels.interior import interior
from tetraskel.kernels.loops import Loops, find_loops
from tetraskel.kernels.medial_nodes import MedialNodes, medial_nodes
from tetraskel.kernels.medial_tree import medial_tree
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.passage_widths import passage_widths
from tetraskel.kernels.skeleton import Skeleton
from tetraskel.kernels.skeleton_arrays import assemble
from tetraskel.kernels.smoothing import Lines, smooth_lines
from tetraskel.kernels.triangulate import triangulate
from tetraskel.options import CurveOptions

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

NEAREST = 6  # points whose mean distance is the local spacing
# detail -> least significance drawn; logarithms are interpolated in between
DETAILS = (0.0, 0.5, 1.0)
SIGNIFICANCES = (0.15, 0.052, 0.006)


@dataclass(frozen=True)
class CurveModel:
    """All that does not depend on the detail.

    Attributes
    ----------
    inner : InnerMesh
    nodes : MedialNodes
    core : Core
        With the medial tree.
    branches : Branches
    loops : Loops
    cavities : int
    """

    inner: InnerMesh
    nodes: MedialNodes
    core: Core
    branches: Branches
    loops: Loops
    cavities: int
