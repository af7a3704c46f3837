"""The solid a skeleton stands for: the balls along each edge, whose radius goes linearly from end to end.

The signed distance to the balls along one edge is the smallest over its parameter t of |x - c(t)| - r(t), a convex
function of t: the free minimum, clipped to the edge, is the minimum on the edge. Outside it is the distance to the
round cone, inside its negative, both exact; the minimum over edges has the right sign everywhere and is the distance
outside their union. Every such function changes by at most the length of the way from place to place.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


@dataclass(frozen=True)
class RoundCones:
    """Balls between two balls, or a single one.

    Attributes
    ----------
    start : (m, d) float
        Centre of the first ball.
    axis : (m, d) float
        Unit vector to the second centre, 0 for a single ball.
    length : (m,) float
        Distance between the centres.
    radius : (m,) float
        Of the first ball.
    slope : (m,) float
        Growth of the radius per length, between -1 and 1.
    lead : (m,) float
        How far ahead of its foot on the axis the ball nearest to a place lies, per distance from the axis.
    """

    start: Floats
    axis: Floats
    length: Floats
    radius: Floats
    slope: Floats
    lead: Floats

    def __len__(self) -> int:
        return len(self.start)


def round_cones(points: Floats, radius: Floats, edges: Ints) -> RoundCones:
    """The cone of each edge (m, 2); an edge from a point to itself is its ball.

    Where one ball of an edge holds the other, the edge adds nothing to the larger one. Cones begin at the end with the
    smaller coordinates, so that the direction of an edge changes no rounding.
    """
    rank = np.empty(len(points), np.int64)
    rank[np.lexsort(points.T[::-1])] = np.arange(len(points))
    turned = rank[edges[:, 0]] > rank[edges[:, 1]]
    first, second = np.where(turned, edges[:, ::-1].T, edges.T)
    way = points[second] - points[first]
    length = np.sqrt((way**2).sum(axis=1))
    growth = radius[second] - radius[first]
    single = length <= np.abs(growth)
    larger = np.where(single & (growth > 0), second, first)
    length = np.where(single, 0.0, length)
    safe = np.where(single, 1.0, length)
    slope = np.where(single, 0.0, growth / safe)
    axis = np.where(single[:, None], 0.0, way / safe[:, None])
    lead = slope / np.sqrt((1 - slope) * (1 + slope))
    return RoundCones(points[larger], axis, length, radius[larger], slope, lead)


def nearest_along(cones: RoundCones, places: Floats, which: Ints) -> tuple[Floats, Floats]:
    """Signed distance (k,) from each place (d, k) to the cone `which` (k,), and where along it the nearest ball is.

    Negative inside; the place along the axis is a length between 0 and that of the cone.
    """
    along = square = np.zeros(1)
    for start, axis, place in zip(cones.start.T, cones.axis.T, places, strict=True):
        away = place - start[which]
        square = square + away * away
        along = along + away * axis[which]
    return _signed(along, square, cones, which)


def _signed(along: Floats, square: Floats, cones: RoundCones, which: Ints) -> tuple[Floats, Floats]:
    """Signed distance and place of the nearest ball, from the foot on the axis and the squared distance to the start.

    The arguments are (..., k) and used as working memory.
    """
    work = along * along
    np.subtract(square, work, out=square)
    np.maximum(square, 0, out=square)  # squared distance from the axis
    nearest = np.sqrt(square)
    nearest *= cones.lead[which]
    nearest += along
    np.maximum(nearest, 0, out=nearest)
    np.minimum(nearest, cones.length[which], out=nearest)
    np.subtract(along, nearest, out=along)
    along *= along
    along += square
    np.sqrt(along, out=along)
    np.multiply(nearest, cones.slope[which], out=work)
    work += cones.radius[which]
    along -= work
    return along, nearest


def on_lattices(cones: RoundCones, which: Ints, ticks: Floats) -> Floats:
    """Signed distance of cone `which` (k,) on a lattice of its own each; (n, ..., n, k) for ticks (d, n, k).

    Strategy: the foot on the axis and the squared distance are sums of one term per coordinate, so the lattice is
    filled by broadcasting, the cones along the fast axis. The sums run in the order of the coordinates, so that a
    place has the same value to the last bit in every lattice that holds it.
    """
    dim, n, k = ticks.shape
    along = square = np.zeros((1,) * dim + (k,))
    for axis, tick in enumerate(ticks):
        form = (1,) * axis + (n,) + (1,) * (dim - 1 - axis) + (k,)
        away = tick - cones.start[which, axis]
        square = square + (away * away).reshape(form)
        along = along + (away * cones.axis[which, axis]).reshape(form)
    return _signed(along, square, cones, which)[0]
