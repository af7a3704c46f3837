"""Delaunay by Qhull, through SciPy: uses every point, and the hull is the convex hull."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tetraskel.errors import EngineError
from tetraskel.kernels.background import wait_for
from tetraskel.kernels.chunks import Tick

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

SECONDS_PER_POINT = 4e-5  # 3D on a slow machine, for the progress bar only


def delaunay(points: Floats, tick: Tick) -> tuple[Ints, Ints, Ints]:
    """Simplices (m, d+1), neighbours (m, d+1), and for each point the one that stands for it.

    Qhull leaves out a point whose distance to another is within its rounding; the nearest vertex stands for it.

    Raises
    ------
    EngineError
        When Qhull gives up; its first line of explanation is quoted.
    """
    from scipy.spatial import Delaunay, QhullError

    try:
        found = wait_for(lambda: Delaunay(points), tick, SECONDS_PER_POINT * len(points))
    except QhullError as error:
        reason = str(error).strip().splitlines()[0]
        raise EngineError(
            f"Qhull could not triangulate {len(points)} points: {reason}; try a joggle of 1e-6."
        ) from error
    stands_for = np.arange(len(points))
    stands_for[found.coplanar[:, 0]] = found.coplanar[:, 2]
    return found.simplices, found.neighbors, stands_for
