"""Where the skeleton can pass: one node per interior simplex, with the radius of the ball around it.

The node is the circumcentre where it lies in the interior, else the barycentre.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import Tick, for_chunks, silent

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

# Barycentric coordinates above this count as inside: a centre on a facet must not fall between two simplices.
ON_FACET = -1e-9
# A visibility walk in a Delaunay triangulation ends (Devillers, Pion, Teillaud 2002); in one that is not, or where
# rounding decides, it may circle and is given up.
LONGEST_WALK = 2000


@dataclass(frozen=True)
class MedialNodes:
    """One node per simplex.

    Attributes
    ----------
    positions : (m, d) float
        Circumcentre or barycentre.
    radii : (m,) float
        Distance to the nearest corner of the simplex; by Delaunay's property the circumradius is the distance to
        the nearest point of all.
    homes : (m,) int
        Simplex that contains the position.
    """

    positions: Floats
    radii: Floats
    homes: Ints


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
    return first, normals, np.einsum("ka,ka->k", sides[:, 0], normals[:, 0])


def barycentric_coordinates(coordinates: Floats, simplices: Ints, places: Floats) -> Floats:
    """(k, d+1) barycentric coordinates of (k, d) places in k simplices; -inf in simplices without volume."""
    first, normals, volumes = barycentric_frames(coordinates, simplices)
    result = np.full(simplices.shape, -np.inf)
    solid = volumes != 0
    weights = np.einsum("kia,ka->ki", normals[solid], (places - first)[solid]) / volumes[solid, None]
    result[solid, 1:] = weights
    result[solid, 0] = 1 - weights.sum(axis=1)
    return result


def circumcentres(coordinates: Floats, simplices: Ints, tick: Tick = silent) -> tuple[Floats, Floats, NDArray[np.int8]]:
    """Circumcentres (m, d), circumradii (m,), and through which facet (opposite that vertex) the centre is seen.

    -1 where the simplex contains its centre. A simplex without volume has its barycentre for centre, radius nan.
    """
    m, width = simplices.shape
    centres, radii = np.empty((m, width - 1)), np.empty(m)
    seen_through = np.empty(m, np.int8)

    def work(piece: slice) -> None:
        first, normals, volumes = barycentric_frames(coordinates, simplices[piece])
        corners = coordinates[simplices[piece]]
        squares = ((corners[:, 1:] - corners[:, :1]) ** 2).sum(axis=2)
        solid = volumes != 0
        volume = np.where(solid, volumes, 1.0)[:, None]
        offset = np.einsum("ki,kia->ka", squares, normals) / (2 * volume)
        weights = np.einsum("kia,ka->ki", normals, offset) / volume
        weights = np.concatenate([1 - weights.sum(axis=1, keepdims=True), weights], axis=1)
        lowest = weights.argmin(axis=1)
        centres[piece] = np.where(solid[:, None], first + offset, corners.mean(axis=1))
        radii[piece] = np.where(solid, np.sqrt((offset**2).sum(axis=1)), np.nan)
        seen_through[piece] = np.where(solid & (weights.min(axis=1) < ON_FACET), lowest, -1)

    for_chunks(work, m, tick)
    return centres, radii, seen_through


def walk_to(
    coordinates: Floats, simplices: Ints, neighbors: Ints, start: Ints, places: Floats, tick: Tick = silent
) -> Ints:
    """Simplex that contains each place (k,), -1 where the walk from `start` to it leaves the mesh.

    Strategy: all walkers step at once, each through the facet behind which its place lies deepest and that leads
    somewhere; those that arrived drop out. The number of rounds is the longest walk, the work the sum of all.
    """
    at = np.array(start, dtype=np.int64)
    active = np.arange(len(at))
    for round_ in range(LONGEST_WALK):
        if len(active) == 0:
            break
        if round_ % 16 == 15:
            tick(1 - len(active) / len(at))
        active = active[_step(coordinates, simplices, neighbors, at, active, places)]
    at[active] = -1
    return at


def _step(
    coordinates: Floats, simplices: Ints, neighbors: Ints, at: Ints, active: Ints, places: Floats
) -> NDArray[np.bool_]:
    """Move the active walkers one simplex on, in place; who walks on."""
    walking = np.zeros(len(active), bool)

    def work(piece: slice) -> None:
        walkers = active[piece]
        cells = at[walkers]
        weights = barycentric_coordinates(coordinates, simplices[cells], places[walkers])
        ahead = neighbors[cells]
        arrived = weights.min(axis=1) >= ON_FACET
        weights[(ahead < 0) | (weights >= 0)] = np.inf  # no way there, or the wrong way
        way = weights.argmin(axis=1)
        rows = np.arange(len(cells))
        blocked = np.isinf(weights[rows, way]) & (weights[rows, way] > 0)
        target = np.where(blocked, -1, ahead[rows, way])
        at[walkers] = np.where(arrived, cells, target)
        walking[piece] = ~arrived & (target >= 0)

    for_chunks(work, len(active))
    return walking


def medial_nodes(coordinates: Floats, simplices: Ints, neighbors: Ints, tick: Tick = silent) -> MedialNodes:
    """Nodes of an interior mesh.

    Parameters
    ----------
    coordinates : (n, d) float
    simplices, neighbors : (m, d+1) int
        The interior alone: beyond its boundary there is no neighbour (-1).

    Returns
    -------
    MedialNodes
        In the order of the simplices.
    """
    centres, circumradii, seen_through = circumcentres(coordinates, simplices, lambda share: tick(0.3 * share))
    homes = np.arange(len(simplices))
    away = np.flatnonzero(seen_through >= 0)
    first_step = neighbors[away, seen_through[away]]
    homes[away] = -1
    away, first_step = away[first_step >= 0], first_step[first_step >= 0]
    homes[away] = walk_to(
        coordinates, simplices, neighbors, first_step, centres[away], lambda share: tick(0.3 + 0.7 * share)
    )
    homes[np.isnan(circumradii)] = -1
    return _with_barycentres(coordinates, simplices, centres, circumradii, homes)


def _with_barycentres(
    coordinates: Floats, simplices: Ints, centres: Floats, circumradii: Floats, homes: Ints
) -> MedialNodes:
    """Nodes, the barycentre where the circumcentre lies in no interior simplex."""
    lost = np.flatnonzero(homes < 0)
    corners = coordinates[simplices[lost]]
    centres[lost] = corners.mean(axis=1)
    circumradii[lost] = np.sqrt(((corners - centres[lost, None]) ** 2).sum(axis=2).min(axis=1))
    homes[lost] = lost
    return MedialNodes(centres, circumradii, homes)
