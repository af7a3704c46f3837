"""How wide the medial sheet is around each node: the time at which a fire from its borders has burned it.

A fire starts at every free 1-cell of the dual complex at the time of the ball there, crosses 2-cells (the faces of
the medial sheets) at unit speed, and passes a 1-cell where several 2-cells meet only when all but one of them have
burned (compare erosion thickness: Yan, Sykes, Chambers, Letscher, Ju 2016). In a tube the burn time is the radius,
in a plate about half its width.

A fire remembers where it started and its way is measured straight from there: the sum of the steps would grow with
the zigzag of small sheets, and so with the density of the samples.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.background import begin
from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.collapse import _ridges_below_inner_points
from tetraskel.kernels.compilation import numba_is_used
from tetraskel.kernels.dual_complex import DualComplex
from tetraskel.kernels.heaps import make_heap, pop, push
from tetraskel.kernels.loops_in_python import run_loop

Floats = NDArray[np.float64]

SECONDS_PER_FACET = 2e-6


def burn_times(cells: DualComplex, positions: Floats, radii: Floats, tick: Tick = silent) -> Floats:
    """(m,) burn time of each node, at least its radius, in the unit of the coordinates.

    Parameters
    ----------
    cells : DualComplex
    positions : (m, d) float
    radii : (m,) float
        Of the nodes.
    """
    ends = cells.facets
    middles = np.zeros((len(ends), 3))
    middles[:, : positions.shape[1]] = 0.5 * (positions[ends[:, 0]] + positions[ends[:, 1]])
    start = np.minimum(radii[ends[:, 0]], radii[ends[:, 1]])
    burned = np.full(len(ends), np.inf)
    alive = np.ones(cells.n_ridges, np.int8)
    alive[_ridges_below_inner_points(cells)] = 0
    run_loop(
        _burn_loop,
        (
            cells.ring_start,
            cells.ring_facets,
            cells.facet_ridges.ravel(),
            cells.facet_ridges.shape[1],
            middles.ravel(),
            start,
        ),
        (burned, alive, np.zeros(len(ends), np.int8), np.arange(len(ends), dtype=np.int32), np.zeros(len(ends), bool)),
        tick,
        SECONDS_PER_FACET * len(ends),
    )
    burned[np.isinf(burned)] = start[np.isinf(burned)]
    nodes = radii.copy()
    np.maximum.at(nodes, ends[:, 0], burned)
    np.maximum.at(nodes, ends[:, 1], burned)
    return nodes


def begin_burning(cells: DualComplex, positions: Floats, radii: Floats) -> Callable[[Tick], Floats]:
    """`burn_times` beside what comes next; what comes back waits for it, told the share of work done.

    Without numba the loop leaves no room beside it, and is run when it is waited for.
    """
    if not numba_is_used():
        return partial(burn_times, cells, positions, radii)
    wait = begin(lambda: burn_times(cells, positions, radii))
    return lambda tick: wait(tick, SECONDS_PER_FACET * len(cells.facets))


def _burn_loop(  # type: ignore[no-untyped-def]
    ring_start, ring_facets, facet_ridges, per_facet, middles, start, burned, alive, around, source, final
):
    n_facets, n_fires = len(start), 0
    times, places = make_heap(n_facets + len(ring_facets), 0.0)
    for f in range(n_facets):
        for k in range(f * per_facet, f * per_facet + per_facet):
            r = facet_ridges[k]
            if r >= 0 and alive[r]:
                around[f] += 1
        if around[f] <= 1:
            burned[f] = start[f]
            push(times, places, n_fires, start[f], f)
            n_fires += 1
    while n_fires > 0:
        time, f = pop(times, places, n_fires)
        n_fires -= 1
        if final[f] or time > burned[f]:
            continue
        final[f] = True
        for k in range(f * per_facet, f * per_facet + per_facet):
            r = facet_ridges[k]
            if r < 0 or not alive[r]:
                continue
            alive[r] = 0
            s = 3 * source[f]
            for j in range(ring_start[r], ring_start[r + 1]):
                g = ring_facets[j]
                around[g] -= 1
                if final[g] or around[g] > 1:
                    continue
                dx = middles[3 * g] - middles[s]
                dy = middles[3 * g + 1] - middles[s + 1]
                dz = middles[3 * g + 2] - middles[s + 2]
                arrival = max(time, start[source[f]] + math.sqrt(dx * dx + dy * dy + dz * dz))
                if arrival < burned[g]:
                    burned[g] = arrival
                    source[g] = source[f]
                    push(times, places, n_fires, arrival, g)
                    n_fires += 1
