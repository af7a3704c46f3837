"""Barycentric coordinates: where a place lies in a simplex, and which simplices have a volume at all."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

# Barycentric coordinates above this count as inside: a centre on a facet must not fall between two simplices.
ON_FACET = -1e-9
# A simplex whose squared volume is below this share of what its edges could span has none: rounding made it.
EMPTY = 1e-24


def barycentric_frames(coordinates: Floats, simplices: Ints) -> tuple[Floats, Floats, Floats]:
    """First corners (k, d), their sides (k, d, d), and the inverses' rows times volume, with the volumes.

    Returns
    -------
    first : (k, d) float
    normals : (k, d, d) float
        `normals[:, i] . (x - first)` is barycentric coordinate i+1 of x times the volume (times d!).
    volumes : (k,) float
        Signed, times d!.
    """
    corners = coordinates[simplices]
    first = corners[:, 0]
    sides = corners[:, 1:] - corners[:, :1]
    normals = np.empty_like(sides)
    if sides.shape[1] == 2:
        normals[:, 0, 0], normals[:, 0, 1] = sides[:, 1, 1], -sides[:, 1, 0]
        normals[:, 1, 0], normals[:, 1, 1] = -sides[:, 0, 1], sides[:, 0, 0]
    else:
        for i in range(3):
            u, v = sides[:, (i + 1) % 3], sides[:, (i + 2) % 3]
            for axis in range(3):
                p, q = (axis + 1) % 3, (axis + 2) % 3
                normals[:, i, axis] = u[:, p] * v[:, q] - u[:, q] * v[:, p]
    return first, normals, dots(sides[:, 0], normals[:, 0])


def barycentric_coordinates(coordinates: Floats, simplices: Ints, places: Floats) -> Floats:
    """(k, d+1) barycentric coordinates of (k, d) places in k simplices; -inf in simplices without volume."""
    first, normals, volumes = barycentric_frames(coordinates, simplices)
    result = np.full(simplices.shape, -np.inf)
    solid = is_solid(coordinates, simplices, volumes)
    scale = np.where(solid, volumes, 1.0)
    weights = dots(normals, (places - first)[:, None]) / scale[:, None]
    total = weights[:, 0] + weights[:, 1]
    if weights.shape[1] == 3:
        total = total + weights[:, 2]
    result[solid, 1:] = weights[solid]
    result[solid, 0] = 1 - total[solid]
    return result


def is_solid(coordinates: Floats, simplices: Ints, volumes: Floats) -> Bools:
    """(k,) simplices with more volume than rounding gives them."""
    return np.asarray(volumes * volumes > EMPTY * _edge_products(coordinates, simplices))


def _edge_products(coordinates: Floats, simplices: Ints) -> Floats:
    """(k,) product of the squared edges at the first corner: the largest squared volume (times d!) they can span."""
    sides = coordinates[simplices[:, 1:]] - coordinates[simplices[:, :1]]
    squares = dots(sides, sides)
    product = squares[:, 0] * squares[:, 1]
    return np.asarray(product if squares.shape[1] == 2 else product * squares[:, 2])


def dots(a: Floats, b: Floats) -> Floats:
    """Scalar products along the last axis, added from the first term on: in any loop the same to the last bit."""
    total = a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1]
    return np.asarray(total if a.shape[-1] == 2 else total + a[..., 2] * b[..., 2])
