"""Points in: checked, duplicates merged, put in an order that does not depend on theirs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.errors import InputError
from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.plane import on_one_line, plane_of, plane_of_mesh, roundings_by_axis

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LARGEST = 1e100  # squares and volumes of coordinates have to stay finite
PIECE = 1 << 18  # points of a file looked at together
MORTON_BITS = {2: 31, 3: 21}


@dataclass(frozen=True)
class DistinctPoints:
    """The distinct points of a cloud.

    Attributes
    ----------
    points : (n, e) float
        In the order in which they first appear in the input.
    original_ids : (n,) int
        Input id of each.
    point_map : (n_input,) int
        For every input point its row in `points`.
    roundoff : (e,) float
        What rounding may have done to each of the input's coordinates, in their unit.
    """

    points: Floats
    original_ids: Ints
    point_map: Ints
    roundoff: Floats


def distinct_points(points: ArrayLike) -> DistinctPoints:
    """Check a cloud (see `finite_points`) and merge points that are equal."""
    whole = finite_points(points)
    return _merge_equal(whole, roundings_by_axis(whole, np.asarray(points).dtype))


def finite_points(points: ArrayLike) -> Floats:
    """A cloud as a new array of doubles.

    Parameters
    ----------
    points : (n, 2) or (n, 3) array of numbers

    Raises
    ------
    InputError
        For another shape, entries that are not numbers, or coordinates that are not finite (they are counted).
    """
    if np.ma.is_masked(points):
        raise InputError("expected points without a mask, got a masked array; pass points.compressed() or fill it.")
    try:
        given = np.asarray(points)
    except ValueError as error:
        raise InputError(f"expected points as an array of shape (n, 2) or (n, 3), got {error}.") from error
    if given.size == 0 and given.ndim < 2:
        given = np.empty((0, 3))
    if given.ndim != 2 or given.shape[1] not in (2, 3):
        raise InputError(f"expected points as an array of shape (n, 2) or (n, 3), got shape {given.shape}.")
    if given.dtype.kind not in "fiub":
        raise InputError(f"expected points as real numbers, got an array of type {given.dtype}.")
    whole = np.array(given, dtype=np.float64, order="C")
    bad = count_bad(whole)
    if bad:
        raise InputError(bad_coordinates(bad, len(whole)))
    return whole + 0.0  # -0.0 and 0.0 are one place


def count_bad(points: Floats) -> int:
    """How many points have a coordinate that is NaN, infinite or too large to be squared."""
    return int((~(np.abs(points) < LARGEST)).any(axis=1).sum())


def bad_coordinates(bad: int, n: int) -> str:
    """What to say of them."""
    return (
        f"expected finite coordinates below {LARGEST:g}, got {bad} of {n} points with NaN, infinity or larger values; "
        "remove these points first."
    )


def checked_box(points: NDArray[Any], tick: Tick = silent) -> tuple[Floats, Floats]:
    """Smallest and largest coordinates of (n, d) points, looked at a piece at a time; they may be in a file.

    Raises
    ------
    InputError
        For coordinates that are not finite (they are counted).
    """
    bad, low, high = 0, np.full(points.shape[1], np.inf), np.full(points.shape[1], -np.inf)
    for start in range(0, len(points), PIECE):
        tick(start / len(points))
        piece = np.asarray(points[start : start + PIECE], float)
        bad += count_bad(piece)
        low, high = np.minimum(low, piece.min(axis=0)), np.maximum(high, piece.max(axis=0))
    if bad:
        raise InputError(bad_coordinates(bad, len(points)))
    return low, high


def unit_box(points: Floats) -> tuple[Floats, int]:
    """Moved to the origin and divided by a power of two, and its exponent: squares neither overflow nor vanish."""
    moved = points - points.min(axis=0, initial=np.inf)
    exponent = int(np.frexp(moved.max(initial=0.0))[1])
    return np.ldexp(moved, -exponent), exponent


def _merge_equal(points: Floats, roundoff: Floats) -> DistinctPoints:
    order = lexicographic_order(points)
    ranked = points[order]
    new = np.ones(len(points), bool)
    new[1:] = (ranked[1:] != ranked[:-1]).any(axis=1)
    group = np.cumsum(new) - 1
    first = np.flatnonzero(new)
    smallest = np.minimum.reduceat(order, first) if len(points) else order
    kept = np.sort(smallest)
    row_of_group = np.searchsorted(kept, smallest)
    point_map = np.empty(len(points), np.int64)
    point_map[order] = row_of_group[group]
    return DistinctPoints(points[kept], kept, point_map, roundoff)


def lexicographic_order(points: Floats) -> Ints:
    """Indices that sort points by first coordinate, then second, then third."""
    order = np.argsort(points[:, 0], kind="stable")
    first = points[order, 0]
    if np.any(first[1:] == first[:-1]):
        order = np.lexsort(points.T[::-1])
    return order


def morton_order(points: Floats) -> Ints:
    """Indices that sort points along a Morton (Z) curve over their bounding box; ties by coordinates.

    A function of the coordinates alone: a permuted cloud is sorted into the same sequence. Neighbours in space are
    mostly neighbours in the sequence, which triangulation engines like.
    """
    low = points.min(axis=0, initial=np.inf)
    code = morton_codes(points, low, float((points - low).max(initial=0.0)))
    order = np.argsort(code, kind="stable")
    if np.any(code[order][1:] == code[order][:-1]):
        order = np.lexsort([*points.T[::-1], code])
    return order


def morton_codes(points: Floats, low: Floats, extent: float) -> NDArray[np.uint64]:
    """(n,) places of points along the Morton curve over a cube with lowest corner `low` and sides of `extent`."""
    bits = MORTON_BITS[points.shape[1]]
    cells = np.minimum((points - low) / (extent or 1.0) * 2.0**bits, 2.0**bits - 1).astype(np.uint64)
    code = np.zeros(len(points), np.uint64)
    for axis, column in enumerate(cells.T):
        code |= _spread_bits(column, points.shape[1]) << np.uint64(axis)
    return code


def _spread_bits(values: NDArray[np.uint64], dim: int) -> NDArray[np.uint64]:
    """Move bit i of each value to bit dim * i (Morton 1966; the usual halving of blocks)."""
    masks = {
        2: [0x00000000FFFFFFFF, 0x0000FFFF0000FFFF, 0x00FF00FF00FF00FF, 0x0F0F0F0F0F0F0F0F, 0x3333333333333333,
            0x5555555555555555],
        3: [0x00000000001FFFFF, 0x001F00000000FFFF, 0x001F0000FF0000FF, 0x100F00F00F00F00F, 0x10C30C30C30C30C3,
            0x1249249249249249],
    }[dim]  # fmt: skip
    shifts = {2: [16, 8, 4, 2, 1], 3: [32, 16, 8, 4, 2]}[dim]
    spread = values & np.uint64(masks[0])
    for shift, mask in zip(shifts, masks[1:], strict=True):
        spread = (spread | (spread << np.uint64(shift))) & np.uint64(mask)
    return spread


def full_dimensional(distinct: DistinctPoints) -> Floats:
    """(n, d) coordinates in which the cloud fills its space: its own, or those of the plane that holds it.

    Raises
    ------
    InputError
        For fewer than d+1 distinct points, or when all lie on one line.
    """
    points, n = distinct.points, len(distinct.points)
    merged = len(distinct.point_map) - n
    if n < 3:
        raise InputError(
            f"expected at least 3 distinct points (4 in space), got {n}"
            + (f" after merging {merged} duplicates" if merged else "")
            + "; a triangulation needs more."
        )
    flat = points.shape[1] == 3 and plane_of(points, distinct.roundoff) is not None
    coordinates = plane_of_mesh(points).project(points) if flat else points
    if coordinates.shape[1] == 2 and on_one_line(coordinates, float(distinct.roundoff.max())):
        raise InputError(f"expected points that span a plane or space, got {n} points on one line.")
    return coordinates
