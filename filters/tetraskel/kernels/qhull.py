"""Delaunay by Qhull, through SciPy: uses every point, and the hull is the convex hull."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tetraskel.errors import EngineError
from tetraskel.kernels.adjacency import is_mesh
from tetraskel.kernels.background import wait_for
from tetraskel.kernels.chunks import Tick

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

SECONDS_PER_POINT = 4e-5  # 3D on a slow machine, for the progress bar only
# Points nearer than this many box sizes are merged when Qhull cannot keep them apart; tried in order.
MERGED_WITHIN = (0.0, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6)


def delaunay(points: Floats, tick: Tick) -> tuple[Ints, Ints, Ints]:
    """Simplices (m, d+1), neighbours (m, d+1), and for each point the one that stands for it.

    Qhull leaves out a point whose distance to another is within its rounding; the nearest vertex stands for it. Where
    points almost coincide its facets may be no triangulation, or have its point at infinity among their corners; then
    points are merged within growing distances until they are one.

    Raises
    ------
    EngineError
        When Qhull gives up; its first line of explanation is quoted.
    """
    for distance in MERGED_WITHIN:
        stands_for = _merged(points, distance)
        kept = np.flatnonzero(stands_for == np.arange(len(points)))
        if distance and len(kept) == len(points):
            continue
        simplices, neighbors, left_out = _qhull(points[kept], tick)
        if simplices.max(initial=-1) < len(kept) and is_mesh(simplices, neighbors):
            stands_for[kept] = kept[left_out]
            return kept[simplices], neighbors, stands_for[stands_for]
    raise EngineError(
        f"Qhull made no triangulation of {len(points)} points that almost coincide or almost lie in a plane; "
        "joggle by 1e-6."
    )


def _qhull(points: Floats, tick: Tick) -> tuple[Ints, Ints, Ints]:
    from scipy.spatial import Delaunay, QhullError

    try:
        found = wait_for(lambda: Delaunay(points), tick, SECONDS_PER_POINT * len(points))
    except QhullError as error:
        reason = str(error).strip().splitlines()[0]
        raise EngineError(f"Qhull could not triangulate {len(points)} points: {reason}; joggle by 1e-6.") from error
    stands_for = np.arange(len(points))
    merged = found.coplanar[(found.coplanar[:, [0, 2]] < len(points)).all(axis=1)]  # without the point at infinity
    stands_for[merged[:, 0]] = merged[:, 2]
    return found.simplices, found.neighbors, stands_for


def _merged(points: Floats, distance: float) -> Ints:
    """For each point the first one it is chained to by steps of at most `distance`."""
    n = len(points)
    if distance == 0:
        return np.arange(n)
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    pairs = cKDTree(points).query_pairs(distance, output_type="ndarray")
    links = coo_matrix((np.ones(len(pairs)), pairs.T), (n, n))
    label = connected_components(links, directed=False)[1]
    return np.unique(label, return_index=True)[1][label]
