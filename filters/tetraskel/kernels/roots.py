"""Where a walk begins: the first hull facet of each piece, in exact arithmetic."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.adjacency import facet_points
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.predicates import exact_integers

Ints = NDArray[np.integer]
Floats = NDArray[np.float64]


def first_facets_by_piece(mesh: Triangulation, pieces: Ints) -> tuple[Ints, NDArray[np.uint8]]:
    """Simplex and local index of the vertex opposite the first hull facet of each piece, first piece first.

    First is the facet whose barycentre has the smallest first coordinate, then second, then third; exact ties go
    to the smallest sorted point ids.
    """
    on_hull = np.flatnonzero(mesh.neighbors.ravel() < 0)
    cells, entries = np.divmod(on_hull, mesh.dim + 1)
    facets = facet_points(mesh.simplices, on_hull)
    candidates = np.arange(len(cells))
    for axis in mesh.coordinates.T:
        corners = axis[facets[candidates]]
        candidates = candidates[_near_minimum(corners, pieces[cells[candidates]])]
        corners = axis[facets[candidates]]
        candidates = candidates[_exact_minimum(corners, pieces[cells[candidates]])]
    chosen = candidates[_first_of_each(facets[candidates], pieces[cells[candidates]])]
    order = _order(mesh.coordinates[facets[chosen]], facets[chosen])
    return cells[chosen][order], entries[chosen][order].astype(np.uint8)


def _near_minimum(corners: Floats, piece: Ints) -> NDArray[np.bool_]:
    """Facets whose coordinate sum may be the smallest of their piece, rounding considered."""
    total = corners.sum(axis=1)
    error = 2.0**-50 * np.abs(corners).max(axis=1, initial=0.0)  # d <= 3 summands, each sum off by at most 2**-53
    lowest = np.full(piece.max(initial=0) + 1, np.inf)
    np.minimum.at(lowest, piece, total + error)
    return np.asarray(total - error <= lowest[piece])


def _exact_minimum(corners: Floats, piece: Ints) -> NDArray[np.bool_]:
    """Facets whose exact coordinate sum is the smallest of their piece."""
    counts = np.bincount(piece)
    keep = counts[piece] == 1
    unsure = np.flatnonzero(~keep)
    if len(unsure):
        totals = exact_integers(corners[unsure]).sum(axis=1)
        lowest: dict[int, int] = {}
        for label, total in zip(piece[unsure].tolist(), totals, strict=True):
            lowest[label] = min(total, lowest.get(label, total))
        keep[unsure] = [total == lowest[label] for label, total in zip(piece[unsure].tolist(), totals, strict=True)]
    return np.asarray(keep)


def _first_of_each(facets: Ints, piece: Ints) -> Ints:
    """Index of the facet with the smallest sorted point ids in each piece."""
    order = np.lexsort([*facets.T[::-1], piece])
    return order[np.flatnonzero(np.diff(piece[order], prepend=-1))]


def _order(corners: Floats, facets: Ints) -> Ints:
    """Order of (p, d, d) root facets by the same rule: exact sums along each axis, then point ids."""
    if len(corners) == 1:
        return np.zeros(1, np.intp)
    sums = [exact_integers(corners[:, :, axis]).sum(axis=1).tolist() for axis in range(corners.shape[2])]
    keys = list(zip(*sums, *facets.T.tolist(), strict=True))
    return np.array(sorted(range(len(keys)), key=keys.__getitem__), dtype=np.intp)
