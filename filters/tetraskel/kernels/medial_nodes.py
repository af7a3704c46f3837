"""Where the skeleton can pass: one node per interior simplex, with the radius of the ball around it.

The node is the circumcentre where it lies in the interior, else the barycentre.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import Tick, for_chunks, part, silent
from tetraskel.kernels.loops_in_python import run_loop

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

# Barycentric coordinates above this count as inside: a centre on a facet must not fall between two simplices.
ON_FACET = -1e-9
# Relative volume below which rounding of the input moves the circumcentre by more than it is worth.
FLAT = 1e-6
# A visibility walk in a Delaunay triangulation ends (Devillers, Pion, Teillaud 2002); where rounding decides, it may
# circle: around its goal, or far from it among simplices without volume. What it passes holds the goal up to this
# barycentric coordinate, or the walk has failed.
LONGEST_WALK = 500
NEARLY_INSIDE = -1e-3
# A simplex whose squared volume is below this share of what its edges could span has none: rounding made it.
EMPTY = 1e-24


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
    return first, normals, _dots(sides[:, 0], normals[:, 0])


def barycentric_coordinates(coordinates: Floats, simplices: Ints, places: Floats) -> Floats:
    """(k, d+1) barycentric coordinates of (k, d) places in k simplices; -inf in simplices without volume."""
    first, normals, volumes = barycentric_frames(coordinates, simplices)
    result = np.full(simplices.shape, -np.inf)
    solid = is_solid(coordinates, simplices, volumes)
    scale = np.where(solid, volumes, 1.0)
    weights = _dots(normals, (places - first)[:, None]) / scale[:, None]
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
    squares = _dots(sides, sides)
    product = squares[:, 0] * squares[:, 1]
    return np.asarray(product if squares.shape[1] == 2 else product * squares[:, 2])


def _dots(a: Floats, b: Floats) -> Floats:
    """Scalar products along the last axis, added from the first term on: in any loop the same to the last bit."""
    total = a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1]
    return np.asarray(total if a.shape[-1] == 2 else total + a[..., 2] * b[..., 2])


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
        solid = is_solid(coordinates, simplices[piece], volumes)
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
    """Simplex that contains each place (k,), -1 where the walk from `start` to it leaves the mesh or does not end.

    A visibility walk: out of each simplex through the facet behind which the place lies deepest and that leads
    somewhere. All places step at once; the number of rounds is the longest walk. A walker that stands again where it
    stood at a round that is a power of two (Brent 1980), and came the same way, circles and stops: in the simplex of
    the circle that holds the place best, if that one nearly does.
    """
    at, came = np.array(start, dtype=np.int64), np.full(len(start), -1)
    mark, mark_came, next_mark = at.copy(), came.copy(), 1
    active, circling = np.arange(len(at)), np.zeros(len(at), bool)
    for round_ in range(LONGEST_WALK):
        if len(active) == 0:
            break
        if round_ % 4 == 3:
            tick(1 - len(active) / len(at))
        active = active[_step(coordinates, simplices, neighbors, at, came, active, places)]
        back = (at[active] == mark[active]) & (came[active] == mark_came[active])
        circling[active[back]] = True
        active = active[~back]
        if round_ + 1 == next_mark:
            mark[active], mark_came[active], next_mark = at[active], came[active], 2 * next_mark
    at[active] = -1
    lost = np.flatnonzero(circling)
    at[lost] = _best_of_circles(coordinates, simplices, neighbors, at[lost], came[lost], places[lost])
    return at


def _best_of_circles(
    coordinates: Floats, simplices: Ints, neighbors: Ints, start: Ints, entered: Ints, places: Floats
) -> Ints:
    """Simplex of the circle of each walker (k,) that nearly contains its place, the best one; -1 where none does."""
    at, came, active = start.copy(), entered.copy(), np.arange(len(start))
    best, found = np.full(len(at), NEARLY_INSIDE), np.full(len(at), -1)
    for _ in range(LONGEST_WALK):
        if len(active) == 0:
            break
        held = barycentric_coordinates(coordinates, simplices[at[active]], places[active]).min(axis=1)
        better = active[held > best[active]]
        best[better], found[better] = held[held > best[active]], at[better]
        active = active[_step(coordinates, simplices, neighbors, at, came, active, places)]
        active = active[(at[active] != start[active]) | (came[active] != entered[active])]
    return found


def _step(
    coordinates: Floats, simplices: Ints, neighbors: Ints, at: Ints, came: Ints, active: Ints, places: Floats
) -> NDArray[np.bool_]:
    """Move the active walkers one simplex on, in place, not back to where they came from; who walks on."""
    walking = np.zeros(len(active), bool)

    def work(piece: slice) -> None:
        walkers = active[piece]
        cells = at[walkers]
        weights = barycentric_coordinates(coordinates, simplices[cells], places[walkers])
        ahead = neighbors[cells]
        arrived = weights.min(axis=1) >= ON_FACET
        weights[(ahead < 0) | (weights >= 0) | (ahead == came[walkers, None])] = np.inf  # no way, or the wrong one
        way = weights.argmin(axis=1)
        rows = np.arange(len(cells))
        target = np.where(weights[rows, way] == np.inf, -1, ahead[rows, way])
        at[walkers], came[walkers] = np.where(arrived, cells, target), cells
        walking[piece] = ~arrived & (target >= 0)

    for_chunks(work, len(active))
    return walking


def _walk_loop(  # type: ignore[no-untyped-def]
    points, simplices, neighbors, places, on_facet, nearly, empty, longest, at
):
    """Where the circumcentre of each tetrahedron lies, -1 outside.

    Centres of neighbours lie close together: the walk begins where the nearest centre of a neighbour was found, and
    again at the tetrahedron itself if that fails. The steps are those of `walk_to`.
    """
    for i in range(len(at)):
        cell, steps, nearest = i, 0, np.inf
        for k in range(4 * i, 4 * i + 4):
            j = neighbors[k]
            if 0 <= j < i and at[j] >= 0:
                x, y = 3 * i, 3 * j
                p0, p1, p2 = places[x] - places[y], places[x + 1] - places[y + 1], places[x + 2] - places[y + 2]
                away = p0 * p0 + p1 * p1 + p2 * p2
                if away < nearest:
                    nearest, cell = away, at[j]
        again, came = nearest < np.inf, -1
        mark, mark_came, next_mark = cell, came, 1
        circling, best, best_cell = False, nearly, -1
        while cell >= 0:
            s = 4 * cell
            a, b, c, d, x = 3 * simplices[s], 3 * simplices[s + 1], 3 * simplices[s + 2], 3 * simplices[s + 3], 3 * i
            u0, u1, u2 = points[b] - points[a], points[b + 1] - points[a + 1], points[b + 2] - points[a + 2]
            v0, v1, v2 = points[c] - points[a], points[c + 1] - points[a + 1], points[c + 2] - points[a + 2]
            w0, w1, w2 = points[d] - points[a], points[d + 1] - points[a + 1], points[d + 2] - points[a + 2]
            t0, t1, t2 = places[x] - points[a], places[x + 1] - points[a + 1], places[x + 2] - points[a + 2]
            n0, n1, n2 = v1 * w2 - v2 * w1, v2 * w0 - v0 * w2, v0 * w1 - v1 * w0
            volume = u0 * n0 + u1 * n1 + u2 * n2
            second, third, fourth, first = -np.inf, -np.inf, -np.inf, -np.inf
            edges = u0 * u0 + u1 * u1 + u2 * u2
            edges *= v0 * v0 + v1 * v1 + v2 * v2
            edges *= w0 * w0 + w1 * w1 + w2 * w2
            if volume * volume > empty * edges:
                second = (n0 * t0 + n1 * t1 + n2 * t2) / volume
                n0, n1, n2 = w1 * u2 - w2 * u1, w2 * u0 - w0 * u2, w0 * u1 - w1 * u0
                third = (n0 * t0 + n1 * t1 + n2 * t2) / volume
                n0, n1, n2 = u1 * v2 - u2 * v1, u2 * v0 - u0 * v2, u0 * v1 - u1 * v0
                fourth = (n0 * t0 + n1 * t1 + n2 * t2) / volume
                first = 1 - (second + third + fourth)
            held = min(first, second, third, fourth)
            if held >= on_facet:
                break
            if circling and held > best:
                best, best_cell = held, cell
            target, lowest = -1, np.inf
            if 0 <= neighbors[s] != came and first < 0:
                target, lowest = neighbors[s], first
            if 0 <= neighbors[s + 1] != came and second < 0 and second < lowest:
                target, lowest = neighbors[s + 1], second
            if 0 <= neighbors[s + 2] != came and third < 0 and third < lowest:
                target, lowest = neighbors[s + 2], third
            if 0 <= neighbors[s + 3] != came and fourth < 0 and fourth < lowest:
                target, lowest = neighbors[s + 3], fourth
            steps += 1
            came, cell = cell, target
            lost = steps >= longest
            if cell == mark and came == mark_came:
                lost, circling = lost or circling, True
            elif steps == next_mark and not circling:
                mark, mark_came, next_mark = cell, came, 2 * next_mark
            if lost:
                cell = best_cell
                if cell >= 0:
                    break
            if cell < 0 and again:
                came, cell, again = -1, i, False
                mark, mark_came, next_mark, steps = i, -1, 1, 0
                circling, best, best_cell = False, nearly, -1
        at[i] = cell


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
    centres, circumradii, seen_through = circumcentres(coordinates, simplices, part(tick, 0.0, 0.3))
    homes = _homes(coordinates, simplices, neighbors, centres, seen_through, part(tick, 0.3, 1.0))
    homes[np.isnan(circumradii)] = -1
    flat = relative_volumes(coordinates, simplices) < FLAT
    borrow_centres(neighbors, flat, centres, circumradii, homes)
    return _with_barycentres(coordinates, simplices, centres, circumradii, homes)


def relative_volumes(coordinates: Floats, simplices: Ints) -> Floats:
    """(m,) volumes (times d!) over the d-th power of the root of the summed squared edges at the first corner."""
    result = np.empty(len(simplices))

    def work(piece: slice) -> None:
        corners = coordinates[simplices[piece]]
        squares = ((corners[:, 1:] - corners[:, :1]) ** 2).sum(axis=(1, 2))
        volumes = np.abs(barycentric_frames(coordinates, simplices[piece])[2])
        result[piece] = volumes / np.maximum(squares ** (0.5 * coordinates.shape[1]), 1e-300)

    for_chunks(work, len(simplices))
    return result


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


def _homes(
    coordinates: Floats, simplices: Ints, neighbors: Ints, centres: Floats, seen_through: Ints, tick: Tick
) -> Ints:
    """(m,) simplex that contains each circumcentre, -1 outside."""
    homes = np.arange(len(simplices))
    if simplices.shape[1] == 4:
        inputs = (
            coordinates.ravel(),
            simplices.ravel(),
            neighbors.ravel(),
            centres.ravel(),
            ON_FACET,
            NEARLY_INSIDE,
            EMPTY,
            LONGEST_WALK,
        )
        run_loop(_walk_loop, inputs, (homes,), tick, 2e-6 * len(homes))
        return homes
    away = np.flatnonzero(seen_through >= 0)
    first_step = neighbors[away, seen_through[away]]
    homes[away] = -1
    away, first_step = away[first_step >= 0], first_step[first_step >= 0]
    homes[away] = walk_to(coordinates, simplices, neighbors, first_step, centres[away], tick)
    return homes


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
