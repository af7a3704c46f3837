"""Which simplex lies across which facet, from the simplices alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.errors import MeshError
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.points import finite_points

Ints = NDArray[np.integer]


def facet_neighbors(simplices: Ints) -> NDArray[np.int32]:
    """(m, d+1) simplex across the facet opposite each vertex, -1 where there is none.

    Strategy: every vertex gets a random-looking 64-bit number and a facet the sum of its vertices', which does not
    depend on their order; sorting these sums brings the two sides of a facet together. That two facets with one
    sum are one facet is then checked, not believed.

    Raises
    ------
    MeshError
        When a facet belongs to more than two simplices, or a simplex uses a point twice.
    """
    m, width = simplices.shape
    if m == 0:
        return np.empty((0, width), np.int32)
    numbers = scramble(simplices.astype(np.uint64))
    keys = (numbers.sum(axis=1, dtype=np.uint64)[:, None] - numbers).ravel()
    order = np.argsort(keys, kind="stable")
    same = np.flatnonzero(keys[order[1:]] == keys[order[:-1]])
    left, right = order[same], order[same + 1]
    _check_pairs(simplices, same, left, right)
    neighbors = np.full(m * width, -1, np.int32)
    neighbors[left], neighbors[right] = right // width, left // width
    return neighbors.reshape(m, width)


def is_mesh(simplices: Ints, neighbors: Ints) -> bool:
    """Whether neighbours are mutual across common facets, and no facet belongs to more than two simplices.

    Strategy: with the facet sums of `facet_neighbors`, what one simplex of a pair says of their facet must add up to
    what the other says, and among the facets of the lower simplex of each pair no sum may come twice.
    """
    m = len(simplices)
    numbers = scramble(simplices.astype(np.uint64))
    keys = numbers.sum(axis=1, dtype=np.uint64)[:, None] - numbers
    cells = np.broadcast_to(np.arange(m)[:, None], neighbors.shape)
    lower, upper = neighbors > cells, (neighbors >= 0) & (neighbors < cells)
    low_says = scramble(keys[lower] ^ _pair_numbers(cells[lower], neighbors[lower], m))
    high_says = scramble(keys[upper] ^ _pair_numbers(neighbors[upper], cells[upper], m))
    if low_says.sum(dtype=np.uint64) != high_says.sum(dtype=np.uint64):
        return False
    ordered = np.sort(keys[lower])
    return not bool((ordered[1:] == ordered[:-1]).any())


def _pair_numbers(low: Ints, high: Ints, m: int) -> NDArray[np.uint64]:
    """A random-looking number for each pair of simplices."""
    return scramble(low.astype(np.uint64) * np.uint64(m) + high.astype(np.uint64))


def scramble(ids: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """The finaliser of splitmix64 (Steele, Lea, Flood 2014): a bijection of 64-bit numbers without visible order."""
    mixed = ids + np.uint64(0x9E3779B97F4A7C15)
    mixed = (mixed ^ (mixed >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    mixed = (mixed ^ (mixed >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return mixed ^ (mixed >> np.uint64(31))


def _check_pairs(simplices: Ints, same: Ints, left: Ints, right: Ints) -> None:
    ordered = np.sort(simplices, axis=1)
    repeated = int((ordered[:, 1:] == ordered[:, :-1]).any(axis=1).sum())
    if repeated:
        raise MeshError(
            f"expected simplices with distinct points, got {repeated} that use a point twice; clean the mesh."
        )
    crowded = int((same[1:] == same[:-1] + 1).sum())
    if crowded or not np.array_equal(facet_points(simplices, left), facet_points(simplices, right)):
        raise MeshError(
            f"expected facets shared by at most two simplices, got {max(crowded, 1)} shared by more; "
            "remove duplicate or overlapping cells first."
        )


def facet_points(simplices: Ints, half_facets: Ints) -> Ints:
    """Sorted point ids (k, d) of facets numbered simplex * (d+1) + opposite vertex."""
    width = simplices.shape[1]
    cells, opposite = np.divmod(half_facets, width)
    others = np.arange(width)[None, :] != opposite[:, None]
    return np.sort(simplices[cells][others].reshape(len(cells), width - 1), axis=1)


def triangulation_of(points: ArrayLike, simplices: ArrayLike) -> Triangulation:
    """A triangulation made by others, checked and with its neighbours found.

    Parameters
    ----------
    points : (n, 2) or (n, 3) array
    simplices : (m, 3) or (m, 4) array of point ids
        Tetrahedra, triangles of the plane, or triangles of one plane in space.

    Raises
    ------
    InputError
        For points that are not finite numbers.
    MeshError
        For ids out of range, points used twice in a simplex, or facets shared by more than two simplices.
    """
    coordinates = finite_points(points)
    cells = np.asarray(simplices)
    if cells.size == 0 and cells.ndim < 2:
        cells = np.empty((0, coordinates.shape[1] + 1), np.int32)
    widths = (3, 4) if coordinates.shape[1] == 3 else (3,)
    if cells.ndim != 2 or cells.shape[1] not in widths:
        wanted = " or ".join(f"(m, {width})" for width in widths)
        raise MeshError(f"expected simplices as an array of shape {wanted}, got shape {cells.shape}.")
    if cells.dtype.kind not in "iu":
        raise MeshError(f"expected point ids as whole numbers, got an array of type {cells.dtype}.")
    if len(cells) and not 0 <= cells.min() <= cells.max() < len(coordinates):
        raise MeshError(f"expected point ids from 0 to {len(coordinates) - 1}, got {cells.min()} to {cells.max()}.")
    cells = np.array(cells, dtype=np.int32, order="C")
    ids = np.arange(len(coordinates))
    return Triangulation(coordinates, cells, facet_neighbors(cells), ids, ids)
