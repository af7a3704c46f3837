"""Where a node is drawn: barycentre, incentre or circumcentre of its simplex."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import Tick, for_chunks, silent
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.predicates import determinant
from tetraskel.options import TreeOptions

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]


def centres(mesh: Triangulation, kind: str = TreeOptions.centre, tick: Tick = silent) -> Floats:
    """(m, e) centre of each simplex, in the input's space.

    Parameters
    ----------
    kind : {"barycentre", "incentre", "circumcentre"}
        The mean of the vertices (the paper's iso-centre), the centre of the inscribed ball, or that of the
        circumscribed ball. A flat simplex has no circumcentre; its barycentre is given.
    """
    TreeOptions(centre=kind)
    if kind == "barycentre":
        return weighted_centres(mesh, None, tick)
    weights = inscribed_weights(mesh) if kind == "incentre" else circumscribed_weights(mesh)
    return weighted_centres(mesh, weights, tick)


def weighted_centres(mesh: Triangulation, weights: Floats | None, tick: Tick = silent) -> Floats:
    """(m, e) sums of the vertices times their (m, d+1) weights; without weights, their mean."""
    found = np.empty((len(mesh), mesh.points.shape[1]))

    def place(piece: slice) -> None:
        vertices = np.ascontiguousarray(mesh.simplices[piece].T)
        for axis, column in enumerate(mesh.points.T):
            corners = column[vertices]
            if weights is None:
                found[piece, axis] = _sum(corners) / len(corners)
            else:
                found[piece, axis] = _sum(corners * weights[piece].T)

    for_chunks(place, len(mesh), tick)
    return found


def _sum(rows: Floats) -> Floats:
    """Sum over the first axis, in order: the same last bit everywhere."""
    total = rows[0].copy()
    for row in rows[1:]:
        total += row
    return total


def inscribed_weights(mesh: Triangulation) -> Floats:
    """(m, d+1) barycentric coordinates of the incentres: proportional to the size of the opposite facet."""
    corners = mesh.coordinates[mesh.simplices]
    corners = corners - corners[:, :1]
    reach = np.abs(corners).max(axis=(1, 2), keepdims=True)
    corners /= np.where(reach > 0, np.exp2(np.floor(np.log2(np.where(reach > 0, reach, 1.0)))), 1.0)  # in any unit
    sizes = np.stack([_facet_size(np.delete(corners, k, axis=1)) for k in range(mesh.dim + 1)], axis=1)
    total = sizes.sum(axis=1, keepdims=True)
    return np.where(total > 0, sizes / np.where(total > 0, total, 1.0), 1 / (mesh.dim + 1))


def _facet_size(corners: Floats) -> Floats:
    """Length (m,) of edges (m, 2, 2) or twice the area of triangles (m, 3, 3)."""
    first = corners[:, 1] - corners[:, 0]
    vector = first if corners.shape[1] == 2 else np.cross(first, corners[:, 2] - corners[:, 0])
    return np.sqrt((vector**2).sum(axis=1))


def circumscribed_weights(mesh: Triangulation) -> Floats:
    """(m, d+1) barycentric coordinates of the circumcentres; a flat simplex gets those of its barycentre."""
    corners = mesh.coordinates[mesh.simplices]
    return _circumscribed(corners[:, 1:] - corners[:, :1])[1]


def _circumscribed(edges: Floats) -> tuple[Floats, Floats]:
    """Circumcentres (m, d) relative to the first vertex, and their barycentric coordinates (m, d+1).

    The circumcentre c = p0 + x solves (pi - p0) . x = |pi - p0|^2 / 2; Cramer's rule gives the barycentric coordinates.
    All are non-negative where the simplex contains its circumcentre.
    """
    centre = circumcentre_offsets(edges)
    columns = [list(row) for row in np.moveaxis(edges, 0, -1)]  # [vertex][axis] -> (m,)
    whole, dim = determinant(columns), len(columns)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        parts = [determinant([*columns[:k], list(centre.T), *columns[k + 1 :]]) / whole for k in range(dim)]
        weights = np.stack([1 - _sum(np.stack(parts)), *parts], axis=1)
    weights[~np.isfinite(weights).all(axis=1)] = 1 / (dim + 1)
    return centre, weights


def circumcentre_offsets(edges: Floats) -> Floats:
    """(m, d) circumcentres relative to the first vertex, from the (m, d, d) edges that leave it; NaN if flat."""
    squares = (edges**2).sum(axis=2)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        if edges.shape[2] == 2:
            a, b = edges[:, 0], edges[:, 1]
            turn = squares[:, :1] * b[:, ::-1] - squares[:, 1:] * a[:, ::-1]
            return turn * [1, -1] / (2 * (a[:, :1] * b[:, 1:] - a[:, 1:] * b[:, :1]))
        a, b, c = edges[:, 0], edges[:, 1], edges[:, 2]
        bc, ca, ab = np.cross(b, c), np.cross(c, a), np.cross(a, b)
        return (squares[:, :1] * bc + squares[:, 1:2] * ca + squares[:, 2:] * ab) / (2 * (a * bc).sum(axis=1)[:, None])


def circumballs(mesh: Triangulation, tick: Tick = silent) -> tuple[Floats, Bools]:
    """Circumradius (m,) of each simplex and whether it contains its circumcentre.

    A flat simplex has an infinite radius and contains nothing.
    """
    radii, inside = np.empty(len(mesh)), np.empty(len(mesh), bool)
    coordinates = mesh.coordinates

    def measure(piece: slice) -> None:
        corners = coordinates[mesh.simplices[piece]]
        offsets, weights = _circumscribed(corners[:, 1:] - corners[:, :1])
        with np.errstate(invalid="ignore", over="ignore"):
            radius = np.sqrt((offsets**2).sum(axis=1))
        radii[piece] = np.where(np.isfinite(radius), radius, np.inf)
        inside[piece] = np.isfinite(radius) & (weights >= 0).all(axis=1)

    for_chunks(measure, len(mesh), tick)
    return radii, inside
