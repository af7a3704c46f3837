"""Which loops of the graph are the object's, and which are false bridges of noisy sampling.

The maximum spanning forest of the graph by passage width leaves out one edge per loop, the narrowest passage of the
loop it closes. A passage that is hardly wider than the spacing of the points around it is a gap between samples
that the inside leaked through: the loop is refused, and everything is cut where a path would cross the bridge.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.collapse import Collapse
from tetraskel.kernels.dual_complex import DualComplex
from tetraskel.kernels.loops_in_python import run_loop

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

CLASSES_AT_ONCE = 62  # bits of a signed integer
SECONDS_PER_CELL = 3e-7


@dataclass(frozen=True)
class Loops:
    """The loops of an interior.

    Attributes
    ----------
    closing : (k,) int
        1-cell at the narrowest passage of each loop that is kept, widest first.
    refused : (q,) int
        Likewise of each loop that is not, widest first.
    cut : (f,) bool
        1-cells that no path may use: together they are surfaces across the false bridges.
    crossings : (f, w) int64
        Bit b of word w: the 1-cell crosses a surface that cuts kept loop 62 w + b open, and no other loop. The sum
        modulo 2 along a closed path says which loops it goes round.
    """

    closing: Ints
    refused: Ints
    cut: Bools
    crossings: NDArray[np.int64]


def find_loops(
    cells: DualComplex,
    collapse: Collapse,
    widths: Floats,
    spacing_at: Callable[[Ints], Floats],
    *,
    loop_spacings: float,
    tick: Tick = silent,
) -> Loops:
    """Sort the loops of the graph into kept and refused.

    Parameters
    ----------
    widths : (f,) float
        Passage widths.
    spacing_at : function
        Distance between points around each of some 1-cells, in the same unit; asked about few.
    loop_spacings : float
        How many spacings wide the narrowest passage of a real loop is at least.
    """
    closing = _left_out(cells, collapse, widths, tick)
    real = widths[closing] > loop_spacings * spacing_at(closing)
    kept, refused = closing[real], closing[~real]
    cut = np.zeros(len(widths), bool)
    for word in _annotate(cells, collapse, refused, tick):
        cut |= word != 0
    words = list(_annotate(cells, collapse, kept, tick))
    crossings = np.stack(words, axis=1) if words else np.zeros((len(widths), 0), np.int64)
    return Loops(kept, refused, cut, crossings)


def _left_out(cells: DualComplex, collapse: Collapse, widths: Floats, tick: Tick) -> Ints:
    """Edges of the graph that its maximum spanning forest leaves out, widest first."""
    edges = np.flatnonzero(collapse.kept)
    edges = edges[np.argsort(-widths[edges], kind="stable")]
    in_forest = np.zeros(len(edges), np.int8)
    parent = np.arange(cells.n_nodes)
    ends = cells.facets[edges]
    run_loop(
        _forest_loop,
        (np.ascontiguousarray(ends[:, 0]), np.ascontiguousarray(ends[:, 1])),
        (parent, in_forest),
        tick,
        SECONDS_PER_CELL * len(edges),
    )
    return edges[in_forest == 0]


def _forest_loop(first, second, parent, in_forest):  # type: ignore[no-untyped-def]
    """Kruskal's forest by union and find with path halving."""
    for i in range(len(first)):
        a = first[i]
        b = second[i]
        while parent[a] != a:
            parent[a] = parent[parent[a]]
            a = parent[a]
        while parent[b] != b:
            parent[b] = parent[parent[b]]
            b = parent[b]
        if a != b:
            parent[b] = a
            in_forest[i] = 1


def _annotate(cells: DualComplex, collapse: Collapse, loops: Ints, tick: Tick):  # type: ignore[no-untyped-def]
    """Per 62 loops, (f,) bits of the cut surfaces that each 1-cell crosses.

    A surface that cuts one loop open and no other is a cocycle modulo 2: 1 on the closing edge, 0 on the rest of
    the graph, and even around every 2-cell. Undoing the collapse fixes its value on one 1-cell at a time.
    """
    for start in range(0, len(loops), CLASSES_AT_ONCE):
        bits = np.zeros(len(cells.facets), np.int64)
        some = loops[start : start + CLASSES_AT_ONCE]
        bits[some] = np.int64(1) << np.arange(len(some))
        run_loop(
            _annotate_loop,
            (collapse.facets, collapse.ridges, cells.ring_start, cells.ring_facets),
            (bits,),
            tick,
            SECONDS_PER_CELL * len(bits),
        )
        yield bits


def _annotate_loop(facets, ridges, ring_start, ring_facets, bits):  # type: ignore[no-untyped-def]
    for back in range(len(facets)):
        i = len(facets) - 1 - back
        total = 0
        for k in range(ring_start[ridges[i]], ring_start[ridges[i] + 1]):
            total ^= bits[ring_facets[k]]
        bits[facets[i]] ^= total
