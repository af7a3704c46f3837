"""From points to the skeleton of their tree: the kernels in order."""

from __future__ import annotations

from numpy.typing import ArrayLike

from tetraskel.errors import InputError
from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.flat import all_flat, remove_flat
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.skeleton import TreeSkeleton, assemble_skeleton
from tetraskel.kernels.tree import build_tree
from tetraskel.kernels.triangulate import triangulate
from tetraskel.options import DelaunayOptions, FlatOptions, SkeletonOptions, TreeOptions


def tree_skeleton(
    points: ArrayLike | Triangulation,
    *,
    engine: str = DelaunayOptions.engine,
    joggle: float = DelaunayOptions.joggle,
    denoise: bool = DelaunayOptions.denoise,
    traversal: str = TreeOptions.traversal,
    centre: str = TreeOptions.centre,
    threshold: float = FlatOptions.threshold,
    keep_leaves: bool = SkeletonOptions.keep_leaves,
    tick: Tick = silent,
) -> TreeSkeleton:
    """The paper's chain: triangulate, build the tree, remove flat simplices, draw the rest.

    Parameters
    ----------
    points : (n, 2) or (n, 3) array, or Triangulation
        A cloud, or a mesh to walk as it is (`engine`, `joggle` and `denoise` are then not used).
    engine, joggle, denoise, traversal, centre, threshold, keep_leaves
        See the options of each stage in `tetraskel.options`.
    tick : callable, optional
        Told the share of each stage done; may raise `Aborted`.

    Raises
    ------
    InputError
        For points that cannot be triangulated, or when all simplices are flat.

    Examples
    --------
    >>> import numpy as np
    >>> cloud = np.random.default_rng(0).random((100, 3))
    >>> tree_skeleton(cloud).points.shape[1]
    3
    """
    if isinstance(points, Triangulation):
        mesh = points
    else:
        mesh = triangulate(points, engine=engine, joggle=joggle, denoise=denoise, tick=tick)
    tree = remove_flat(build_tree(mesh, traversal=traversal, tick=tick), threshold=threshold, tick=tick)
    if len(mesh) and len(tree) == 0:
        raise InputError(all_flat(len(mesh), threshold))
    return assemble_skeleton(tree, centre=centre, keep_leaves=keep_leaves)
