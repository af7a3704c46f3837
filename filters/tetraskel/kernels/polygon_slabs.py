"""Convex polygons of a plane cut by straight segments into what is inside and what is outside.

Each polygon is cut into slabs by parallel lines through every corner and every end of a segment. Nothing ends within a
slab, so its walls can be sorted, and between two of them all is inside or all is outside. There is no case to get
wrong: segments that miss each other by rounding leave a gap as thin as the rounding.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.barycentric import dots

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

# Slabs thinner than this share of the polygon's width are rounding.
THIN = 1e-10
BOTTOM, TOP, ENTER, LEAVE = 0, 1, 2, 3  # kinds of walls, from below: the polygon's own, and the segments'
OUTSIDE, INSIDE, UNSURE, NOTHING = 0, 1, 2, 3


@dataclass(frozen=True)
class Walls:
    """Straight pieces from left to right, in the planes of their polygons.

    Attributes
    ----------
    polygon : (w,) int
    ends : (w, 2, 2) float
        Left and right end, (u, v).
    kind : (w,) int
        BOTTOM and TOP of the convex polygon; ENTER where inside lies above, LEAVE where it lies below.
    """

    polygon: Ints
    ends: Floats
    kind: Ints


@dataclass(frozen=True)
class Trapezoids:
    """Parts of the polygons that are inside, slab after slab of each, from below.

    Attributes
    ----------
    polygon : (t,) int
    slab : (t,) int
        Numbered over all polygons; neighbours in one polygon have consecutive numbers.
    u : (t, 2) float
        Left and right.
    low, high : (t, 2) float
        Lower and upper v, left and right.
    """

    polygon: Ints
    slab: Ints
    u: Floats
    low: Floats
    high: Floats


def walls_from(polygon: Ints, ends: Floats, kind: Ints) -> Walls:
    """Walls with their left end first; those straight up are none.

    Turning a segment around exchanges the names of its ends, not its sides: the kinds are given for what is seen.
    """
    turned = ends[:, 0, 0] > ends[:, 1, 0]
    ends = np.where(turned[:, None, None], ends[:, ::-1], ends)
    kept = ends[:, 0, 0] < ends[:, 1, 0]
    return Walls(polygon[kept], ends[kept], kind[kept])


def in_groups(group: Ints, value: Floats, last: Ints) -> Ints:
    """Order by group, then value, then a last number, then place: `np.lexsort`, several times faster.

    Values alone and small numbers alone are quickly sorted; equal values in a group are few and put right afterwards.
    """
    small = np.uint16 if group.max(initial=0) < 1 << 16 else np.int64
    by_value = np.argsort(value)
    order = by_value[np.argsort(group.astype(small)[by_value], kind="stable")]
    ranked = group[order]
    equal = np.flatnonzero((ranked[1:] == ranked[:-1]) & (value[order[1:]] == value[order[:-1]]))
    if len(equal):
        tied = np.zeros(int(group.max()) + 1, bool)
        tied[ranked[equal]] = True
        places = np.flatnonzero(tied[ranked])
        rows = np.sort(order[places])
        order[places] = rows[np.lexsort([last[rows], value[rows], group[rows]])]
    return np.asarray(order)


def slab_lines(walls: Walls, n_polygons: int) -> tuple[Floats, Ints]:
    """The u of the lines, ascending in each polygon, and (w, 2) the lines through each wall's left and right end.

    Lines closer than rounding are one.
    """
    polygon, u = np.repeat(walls.polygon, 2), walls.ends[:, :, 0].ravel()
    order = in_groups(polygon, u, np.zeros(len(u), np.int8))
    polygon, u = polygon[order], u[order]
    first = np.searchsorted(polygon, np.arange(n_polygons))
    last = np.searchsorted(polygon, np.arange(n_polygons) + 1)
    size = np.zeros(n_polygons)
    some = last > first
    size[some] = u[last[some] - 1] - u[first[some]]
    kept = np.ones(len(u), bool)
    kept[1:] = (np.diff(polygon) != 0) | (np.diff(u) > THIN * size[polygon[1:]])
    line = np.empty(len(u), np.int64)
    line[order] = np.cumsum(kept) - 1
    return u[kept], line.reshape(-1, 2)


def cut_into_slabs(walls: Walls, n_polygons: int) -> tuple[Ints, Floats, Ints, Floats]:
    """Walls of each slab, from below.

    Returns
    -------
    slab : (k,) int
        Number of the line on its left.
    u : (k, 2) float
        Left and right of the slab.
    wall : (k,) int
    heights : (k, 2) float
        v of the wall, left and right.
    """
    lines, ends = slab_lines(walls, n_polygons)
    left, right = ends.T
    counts = right - left  # none: a wall as short as rounding
    wall = np.repeat(np.arange(len(counts)), counts)
    slab = np.arange(counts.sum()) + np.repeat(left - (np.cumsum(counts) - counts), counts)
    u = np.stack([lines[slab], lines[slab + 1]], axis=1) if len(slab) else np.empty((0, 2))
    heights = _heights(walls.ends[wall], u)
    order = in_groups(slab, heights[:, 0] + heights[:, 1], walls.kind[wall])
    return slab[order], u[order], wall[order], heights[order]


def _heights(ends: Floats, u: Floats) -> Floats:
    """v of walls at the sides of a slab; exactly an end's where the wall ends there."""
    start, stop = ends[:, 0], ends[:, 1]
    share = (u - start[:, :1]) / (stop[:, :1] - start[:, :1])
    share = np.clip(share, 0.0, 1.0)
    return np.where(share == 1, stop[:, 1:], start[:, 1:] + share * (stop[:, 1:] - start[:, 1:]))


def sides_between(walls: Walls, slab: Ints, wall: Ints, own_says: Ints) -> Ints:
    """(k - 1,) what lies between each wall and the next: INSIDE, OUTSIDE, UNSURE, or NOTHING between two slabs.

    Unsure is where the two walls say different things, which they do where the boundary touches more than it crosses.

    Parameters
    ----------
    own_says : (k,) int
        For BOTTOM and TOP walls what their own edge says of the place: INSIDE, OUTSIDE or UNSURE.
    """
    says_above, says_below = own_says.copy(), own_says.copy()
    kind = walls.kind[wall]
    says_above[kind == ENTER] = says_below[kind == LEAVE] = INSIDE
    says_above[kind == LEAVE] = says_below[kind == ENTER] = OUTSIDE
    above, below = says_above[:-1], says_below[1:]
    result = np.where(above == below, above, UNSURE)
    none = (slab[1:] != slab[:-1]) | (kind[:-1] == TOP) | (kind[1:] == BOTTOM)
    result[none] = NOTHING
    return result


def trapezoids_of(walls: Walls, cut: tuple[Ints, Floats, Ints, Floats], places: Ints) -> Trapezoids:
    """The parts between walls `places` and the next ones, those without height left out."""
    slab, u, wall, heights = cut
    low, high = heights[places], np.maximum(heights[places + 1], heights[places])
    gap = high - low
    kept = gap[:, 0] + gap[:, 1] > 0
    places, low, high = places[kept], low[kept], high[kept]
    return Trapezoids(walls.polygon[wall[places]], slab[places], u[places], low, high)


def monotone_polygons(parts: Trapezoids) -> tuple[Ints, Ints, Floats]:
    """Trapezoids one after another in consecutive slabs of one polygon as one polygon, others alone.

    Returns
    -------
    polygon : (p,) int
    starts : (p+1,) int
    corners : (total, 2) float
        Counter-clockwise; corners on straight lines and repeated ones are left out.
    """
    if len(parts.polygon) == 0:
        return np.empty(0, np.int64), np.zeros(1, np.int64), np.empty((0, 2))
    alone = np.bincount(parts.slab)[parts.slab] > 1
    begins = np.ones(len(alone), bool)
    begins[1:] = (np.diff(parts.polygon) != 0) | (np.diff(parts.slab) != 1) | alone[1:] | alone[:-1]
    apart = (parts.high[:-1, 1] <= parts.low[1:, 0]) | (parts.high[1:, 0] <= parts.low[:-1, 1])
    begins[1:] |= apart
    piece = np.cumsum(begins) - 1
    n_pieces = int(piece[-1]) + 1
    lower = np.stack([parts.u, parts.low], axis=2).reshape(-1, 2)
    upper = np.stack([parts.u, parts.high], axis=2).reshape(-1, 2)[::-1]
    owner = np.repeat(piece, 2)
    owners = np.concatenate([owner, owner[::-1]])
    corners = np.concatenate([lower, upper])
    order = np.argsort(owners, kind="stable")
    polygon = parts.polygon[begins]
    owners, corners = owners[order], corners[order]
    for wanted in (_moves, _bends):  # between two equal corners there is no straight line
        kept = wanted(owners, corners, n_pieces)
        owners, corners = owners[kept], corners[kept]
    counts = np.bincount(owners, minlength=n_pieces)
    whole = counts >= 3
    kept = whole[owners]
    return polygon[whole], np.concatenate([[0], np.cumsum(counts[whole])]), corners[kept]


def _moves(owners: Ints, corners: Floats, n_pieces: int) -> Bools:
    """Corners that are away from the one before."""
    before, _, first = _beside(owners, n_pieces)
    step = np.maximum(*np.abs(corners - corners[before]).T)
    reach = np.maximum(*np.abs(corners - corners[first[owners]]).T)
    size = np.maximum.reduceat(reach, first) if len(first) else reach
    return np.asarray(step > THIN * size[owners])


def _bends(owners: Ints, corners: Floats, n_pieces: int) -> Bools:
    """Corners that are not on a straight line with their neighbours."""
    before, after, _ = _beside(owners, n_pieces)
    back, ahead = corners - corners[before], corners[after] - corners
    turn = back[:, 0] * ahead[:, 1] - back[:, 1] * ahead[:, 0]
    lengths = dots(back, back) * dots(ahead, ahead)
    return np.asarray(np.abs(turn) > THIN * np.sqrt(lengths))


def _beside(owners: Ints, n_pieces: int) -> tuple[Ints, Ints, Ints]:
    """The corner before and the one after each, around its polygon, and where each polygon begins."""
    first = np.searchsorted(owners, np.arange(n_pieces))
    last = np.searchsorted(owners, np.arange(n_pieces) + 1) - 1
    before, after = np.arange(len(owners)) - 1, np.arange(len(owners)) + 1
    some = last >= first
    before[first[some]], after[last[some]] = last[some], first[some]
    return before, after, first
