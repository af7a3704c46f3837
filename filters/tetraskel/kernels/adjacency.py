"""Which simplex lies across which facet, from the simplices alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.errors import MeshError
from tetraskel.kernels.mesh import Triangulation

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
    numbers = _scramble(simplices.astype(np.uint64))
    keys = (numbers.sum(axis=1, dtype=np.uint64)[:, None] - numbers).ravel()
    order = np.argsort(keys, kind="stable")
    same = np.flatnonzero(keys[order[1:]] == keys[order[:-1]])
    left, right = order[same], order[same + 1]
    _check_pairs(simplices, same, left, right)
    neighbors = np.full(m * width, -1, np.int32)
    neighbors[left], neighbors[right] = right // width, left // width
    return neighbors.reshape(m, width)


def _scramble(ids: NDArray[np.uint64]) -> NDArray[np.uint64]:
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
    MeshError
        For ids out of range, points used twice in a simplex, or facets shared by more than two simplices.
    """
    coordinates = np.array(points, dtype=np.float64, order="C")
    cells = np.array(simplices, dtype=np.int32, order="C")
    if cells.ndim != 2 or cells.shape[1] not in (3, 4):
        raise MeshError(f"expected simplices as an array of shape (m, 3) or (m, 4), got shape {cells.shape}.")
    if len(cells) and not 0 <= cells.min() <= cells.max() < len(coordinates):
        raise MeshError(f"expected point ids from 0 to {len(coordinates) - 1}, got {cells.min()} to {cells.max()}.")
    if not np.isfinite(coordinates).all():
        raise MeshError("expected finite coordinates, got NaN or infinity; clean the mesh.")
    ids = np.arange(len(coordinates))
    return Triangulation(coordinates, cells, facet_neighbors(cells), ids, ids)
