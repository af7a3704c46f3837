"""Which simplex contains a place: walks through the triangulation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.adjacency import scramble
from tetraskel.kernels.barycentric import EMPTY, ON_FACET, barycentric_coordinates
from tetraskel.kernels.chunks import Tick, for_chunks, silent
from tetraskel.kernels.loops_in_python import run_loop

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# A visibility walk in a Delaunay triangulation ends (Devillers, Pion, Teillaud 2002); where rounding decides, it may
# circle: around its goal, or far from it among simplices without volume. What it passes holds the goal up to this
# barycentric coordinate, or the walk has failed.
LONGEST_WALK = 500
NEARLY_INSIDE = -1e-3


@dataclass(frozen=True)
class _Ground:
    """What is walked on: points (n, d), simplices and neighbours (m, d+1)."""

    coordinates: Floats
    simplices: Ints
    neighbors: Ints

    def weights(self, cells: Ints, places: Floats) -> Floats:
        """(k, d+1) barycentric coordinates of places in simplices."""
        return barycentric_coordinates(self.coordinates, self.simplices[cells], places)


def walk_to(
    coordinates: Floats, simplices: Ints, neighbors: Ints, start: Ints, places: Floats, tick: Tick = silent
) -> Ints:
    """Simplex that contains each place (k,), -1 where the walk from `start` to it leaves the mesh or does not end.

    A visibility walk: out of each simplex through the facet behind which the place lies deepest and that leads
    somewhere. All places step at once; the number of rounds is the longest walk. A walker that stands again where it
    stood at a round that is a power of two (Brent 1980), and came the same way, circles and stops. It walks on by lot,
    as does one that came out of the mesh through a simplex without volume.
    """
    ground = _Ground(coordinates, simplices, neighbors)
    at, came = np.array(start, dtype=np.int64), np.full(len(start), -1)
    mark, mark_came, next_mark = at.copy(), came.copy(), 1
    active, lost, misled = np.arange(len(at)), np.zeros(len(at), bool), np.zeros(len(at), bool)
    for round_ in range(LONGEST_WALK):
        if len(active) == 0:
            break
        if round_ % 4 == 3:
            tick(1 - len(active) / len(at))
        active = active[_step(ground, at, came, active, places, misled)]
        back = (at[active] == mark[active]) & (came[active] == mark_came[active])
        lost[active[back]] = True
        active = active[~back]
        if round_ + 1 == next_mark:
            mark[active], mark_came[active], next_mark = at[active], came[active], 2 * next_mark
    at[active] = -1
    lost[misled & (at < 0)] = True
    rows = np.flatnonzero(lost)
    begin = np.where(at[rows] < 0, came[rows], at[rows])
    at[rows] = _by_lot(ground, begin, places[rows])
    return at


def _by_lot(ground: _Ground, start: Ints, places: Floats) -> Ints:
    """Simplex that nearly contains each place, the best one of a walk; -1 where none does.

    Simplices without volume show no way and are left by a facet drawn by lot. A walk may come out on the wrong side,
    and is sent back by the next simplex, until it is lucky. One that comes back to its start and has met none of them
    would go the same way again.
    """
    at, active = np.array(start, dtype=np.int64), np.arange(len(start))
    best, found = np.full(len(at), NEARLY_INSIDE), np.full(len(at), -1)
    drawn = np.zeros(len(at), bool)
    for turn in range(LONGEST_WALK):
        if len(active) == 0:
            break
        cells = at[active]
        weights = ground.weights(cells, places[active])
        held = weights.min(axis=1)
        better = held > best[active]
        best[active[better]], found[active[better]] = held[better], cells[better]
        drawn[active] |= np.isneginf(held)
        ahead = ground.neighbors[cells]
        lots = scramble(scramble(ahead.astype(np.uint64)) + np.uint64(turn)) >> np.uint64(11)
        weights = np.where(np.isneginf(weights), -1.0 - lots.astype(float), weights)
        weights[(ahead < 0) | (weights >= 0)] = np.inf
        way, rows = weights.argmin(axis=1), np.arange(len(cells))
        at[active] = np.where(np.isinf(weights[rows, way]), -1, ahead[rows, way])
        again = (at[active] == start[active]) & ~drawn[active]
        active = active[(held < ON_FACET) & (at[active] >= 0) & ~again]
    return found


def _step(
    ground: _Ground, at: Ints, came: Ints, active: Ints, places: Floats, misled: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Move the active walkers one simplex on, in place, not back to where they came from; who walks on.

    Those that meet a simplex without volume, which shows no way, are noted in `misled`.
    """
    walking = np.zeros(len(active), bool)

    def work(piece: slice) -> None:
        walkers = active[piece]
        cells = at[walkers]
        weights = ground.weights(cells, places[walkers])
        ahead = ground.neighbors[cells]
        held = weights.min(axis=1)
        arrived = held >= ON_FACET
        misled[walkers[np.isneginf(held)]] = True
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
    again at the tetrahedron itself if that fails. The steps are those of `walk_to`; a walk that circles ends in the
    tetrahedron of its circle that holds the place best, if that one nearly does.
    """
    for i in range(len(at)):
        cell, nearest = i, np.inf
        for k in range(4 * i, 4 * i + 4):
            j = neighbors[k]
            if 0 <= j < i and at[j] >= 0:
                x, y = 3 * i, 3 * j
                p0, p1, p2 = places[x] - places[y], places[x + 1] - places[y + 1], places[x + 2] - places[y + 2]
                away = p0 * p0 + p1 * p1 + p2 * p2
                if away < nearest:
                    nearest, cell = away, at[j]
        for attempt in range(2 if nearest < np.inf else 1):
            if attempt == 1:
                cell = i
            came, steps = -1, 0
            mark, mark_came, next_mark = cell, -1, 1
            circling, best, best_cell = False, nearly, -1
            while cell >= 0:
                s = 4 * cell
                a, b, x = 3 * simplices[s], 3 * simplices[s + 1], 3 * i
                c, d = 3 * simplices[s + 2], 3 * simplices[s + 3]
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
                    break
            if cell >= 0:
                break
        at[i] = cell


def homes_of_circumcentres(
    coordinates: Floats, simplices: Ints, neighbors: Ints, centres: Floats, seen_through: Ints, tick: Tick
) -> Ints:
    """(m,) simplex that contains the circumcentre of each simplex, -1 outside."""
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
