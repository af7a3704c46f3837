"""Where the skeleton can pass: one node per interior simplex, with the radius of the ball around it.

The node is the circumcentre where it lies in the interior, else the barycentre.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.barycentric import ON_FACET, barycentric_frames, is_solid
from tetraskel.kernels.chunks import Tick, for_chunks, part, silent
from tetraskel.kernels.loops_in_python import run_compiled
from tetraskel.kernels.walking import homes_of_circumcentres

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

# Volume, over the d-th power of the root of the summed squared edges at the first corner, up to which rounding of the
# input moves the circumcentre by more than it is worth.
FLAT = 1e-6


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
    is_medial : (m,) bool
        The position is a circumcentre.
    """

    positions: Floats
    radii: Floats
    homes: Ints
    is_medial: Bools


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
    centres, circumradii, flat, seen_through = circumcentres(coordinates, simplices, part(tick, 0.0, 0.3))
    homes = homes_of_circumcentres(coordinates, simplices, neighbors, centres, seen_through, part(tick, 0.3, 1.0))
    homes[np.isnan(circumradii)] = -1
    borrow_centres(neighbors, flat, centres, circumradii, homes)
    return _with_barycentres(coordinates, simplices, centres, circumradii, homes)


def circumcentres(
    coordinates: Floats, simplices: Ints, tick: Tick = silent
) -> tuple[Floats, Floats, Bools, NDArray[np.int8]]:
    """Circumcentres (m, d), circumradii (m,), which simplices are flat, and through which facet the centre is seen.

    That facet (opposite that vertex) is -1 where a triangle contains its centre, and in space, where nobody asks. A
    simplex without volume has its barycentre for centre, radius nan.
    """
    m, width = simplices.shape
    centres, radii, flat = np.empty((m, width - 1)), np.empty(m), np.empty(m, bool)
    seen_through = np.full(m, -1, np.int8)
    if width == 4 and run_compiled("circumcentres", (coordinates, FLAT), (simplices,), (centres, radii, flat), tick):
        return centres, radii, flat, seen_through

    def work(piece: slice) -> None:
        first, normals, volumes = barycentric_frames(coordinates, simplices[piece])
        corners = coordinates[simplices[piece]]
        sides = corners[:, 1:] - corners[:, :1]
        squares = (sides**2).sum(axis=2)
        flat[piece] = _is_flat(sides, volumes)
        solid = is_solid(coordinates, simplices[piece], volumes)
        volume = np.where(solid, volumes, 1.0)[:, None]
        offset = np.einsum("ki,kia->ka", squares, normals) / (2 * volume)
        centres[piece] = np.where(solid[:, None], first + offset, corners.mean(axis=1))
        radii[piece] = np.where(solid, np.sqrt((offset**2).sum(axis=1)), np.nan)
        if width == 3:
            weights = np.einsum("kia,ka->ki", normals, offset) / volume
            weights = np.concatenate([1 - weights.sum(axis=1, keepdims=True), weights], axis=1)
            seen_through[piece] = np.where(solid & (weights.min(axis=1) < ON_FACET), weights.argmin(axis=1), -1)

    for_chunks(work, m, tick)
    return centres, radii, flat, seen_through


def _is_flat(sides: Floats, volumes: Floats) -> Bools:
    """(k,) simplices, by their (k, d, d) sides from the first corner, whose volume (times d!) is next to nothing."""
    squares = (sides**2).sum(axis=2)
    total = squares[:, 0] + squares[:, 1]
    if squares.shape[1] == 2:
        return np.asarray(np.abs(volumes) <= FLAT * total)
    total = total + squares[:, 2]
    return np.asarray(np.abs(volumes) <= FLAT * total * np.sqrt(total))


def borrow_centres(neighbors: Ints, flat: Bools, centres: Floats, circumradii: Floats, homes: Ints) -> None:
    """Give flat simplices the centre of a neighbour, in place, one ring of simplices after another.

    Four points almost on one circle, as the mirrored vertices of a symmetric mesh are, have no centre of their own:
    every point of the axis between the centres on both sides is as good.
    """
    homes[flat] = -1
    waiting = np.flatnonzero(flat)
    known = ~flat & (homes >= 0)
    while len(waiting):
        beside = neighbors[waiting]
        usable = (beside >= 0) & known[beside]
        size = np.where(usable, circumradii[beside], -1.0)
        best = size.argmax(axis=1)
        rows = np.flatnonzero(usable.any(axis=1))
        if len(rows) == 0:
            return
        lender = beside[rows, best[rows]]
        borrower = waiting[rows]
        centres[borrower], circumradii[borrower], homes[borrower] = centres[lender], circumradii[lender], homes[lender]
        known[borrower] = True
        waiting = np.delete(waiting, rows)


def _with_barycentres(
    coordinates: Floats, simplices: Ints, centres: Floats, circumradii: Floats, homes: Ints
) -> MedialNodes:
    """Nodes, the barycentre where the circumcentre lies in no interior simplex."""
    lost = np.flatnonzero(homes < 0)
    corners = coordinates[simplices[lost]]
    centres[lost] = corners.mean(axis=1)
    circumradii[lost] = np.sqrt(((corners - centres[lost, None]) ** 2).sum(axis=2).min(axis=1))
    is_medial = homes >= 0
    homes[lost] = lost
    return MedialNodes(centres, circumradii, homes, is_medial)


def facing(coordinates: Floats, simplices: Ints, nodes: MedialNodes, tick: Tick = silent) -> Floats:
    """(m,) how well the corners of each simplex face one another across its node, from 0 to 1.

    1 when every corner has one opposite to it: the node lies midway between two sides of the object. Less where
    three sides meet, or where a branch dives from a wide place into a narrow one: there the surface is near on one
    side only. It is the least, over the corners, of (1 - cos) / 2 of the largest angle to another corner.
    """
    result = np.empty(len(simplices))
    constants, inputs = (coordinates,), (simplices, nodes.positions)
    if simplices.shape[1] == 4 and run_compiled("facing", constants, inputs, (result,), tick):
        return np.clip(result, 1e-3, 1)

    def work(piece: slice) -> None:
        ways = coordinates[simplices[piece]] - nodes.positions[piece, None]
        ways = ways / np.maximum(np.sqrt((ways**2).sum(axis=2, keepdims=True)), 1e-300)
        width = ways.shape[1]
        cosines = np.ones((len(ways), width, width))
        for i, j in combinations(range(width), 2):
            cosines[:, i, j] = cosines[:, j, i] = (ways[:, i] * ways[:, j]).sum(axis=1)
        result[piece] = ((1 - cosines.min(axis=2)) / 2).min(axis=1)

    for_chunks(work, len(simplices), tick)
    return np.clip(result, 1e-3, 1)
