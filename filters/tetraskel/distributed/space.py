"""Whether points spread over ranks fill space."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tetraskel.distributed.blocks import affine_basis
from tetraskel.distributed.communicator import Communicator
from tetraskel.kernels.plane import dot, plane_of

Floats = NDArray[np.float64]

CAUTION = 8  # times the rounding below which points count as flat when they are all on one rank


def fills_space(comm: Communicator, points: Floats, roundoff: Floats) -> bool:
    """Whether (k, 3) points of all ranks are clearly not in one plane.

    Where they are close to one, the answer is no: one rank, which sees all of them, then decides.

    Parameters
    ----------
    roundoff : (3,) float
        What rounding may have done to each coordinate of this rank's points.
    """
    tolerance = CAUTION * comm.highest(roundoff)
    chosen = np.concatenate(comm.allgather(points[affine_basis(points)]))
    if len(chosen) < 4 or plane_of(chosen, tolerance) is not None:
        return not _in_plane_of(comm, chosen, points, tolerance)
    return True


def _in_plane_of(comm: Communicator, chosen: Floats, points: Floats, tolerance: Floats) -> bool:
    plane = plane_of(chosen, tolerance) if len(chosen) >= 4 else None
    if plane is None:
        return True  # too few points to tell
    normal = np.cross(*plane.directions)
    heights = dot(points - plane.origin, normal)
    low = float(comm.lowest(np.array([heights.min(initial=np.inf)]))[0])
    high = float(comm.highest(np.array([heights.max(initial=-np.inf)]))[0])
    return high - low <= float(dot(np.abs(normal), tolerance))
