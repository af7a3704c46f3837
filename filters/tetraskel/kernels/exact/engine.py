"""Delaunay by insertion with exact predicates: the face that `tetraskel.kernels.triangulate` calls."""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetraskel.errors import EngineError
from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.exact import canonical, tetrahedra, triangles
from tetraskel.kernels.exact.ordering import insertion_order
from tetraskel.kernels.exact.predicates import static_bounds
from tetraskel.kernels.exact.start import first_simplex
from tetraskel.kernels.exact.state import DONE, USED

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

KERNELS: dict[int, Any] = {2: triangles, 3: tetrahedra}
SEED = 20
CELLS_PER_POINT = {2: 2.1, 3: 7.2}  # of uniform points, with the infinite ones; more are made when they are needed
TICK_SECONDS = 0.1
FIRST_BATCH = 2000  # points
HIGHEST_EXPONENT = 200
LARGEST_CELLS = 2**29 - 1  # facet numbers have 31 bits


def delaunay(points: Floats, tick: Tick = silent, seed: int = SEED) -> tuple[Ints, Ints, Ints]:
    """Simplices (m, d+1), neighbours (m, d+1), and for each point the one that stands for it: itself.

    Simplices are positively oriented. Which they are depends on the coordinates alone, not on their order or the seed;
    their order, and that of the vertices in each, is a function of the points' order.

    Parameters
    ----------
    points : (n, 2) or (n, 3) array
        In an order that is coherent in space. Points that are equal get one vertex.
    tick : callable
        Told the share of points inserted; may raise `Aborted`.
    seed : int
        Of the order of insertion.

    Raises
    ------
    EngineError
        When the triangulation has more than 536,870,911 cells, or the coordinates differ in size by more than doubles
        can hold once the largest is small enough to be raised to the fifth power.
    """
    stands_for = np.arange(len(points))
    cells = _triangulated(_scaled(points), stands_for, tick, seed)
    if cells is None:
        nothing = np.empty((0, points.shape[1] + 1), np.int32)
        return nothing, nothing, stands_for
    return *_in_order(cells), stands_for


@cache
def prepare(dim: int) -> None:
    """Compile what d-dimensional points need, or load it from disk."""
    delaunay(np.concatenate([np.zeros((1, dim)), np.eye(dim), np.full((1, dim), 0.25)]))


def _scaled(points: Floats) -> Floats:
    """The points times a power of two that makes the largest coordinate almost 2**200: nothing is rounded.

    Determinants then have no overflow, and the filters trust differences down to 2**-370 of the largest coordinate.
    """
    largest = float(np.abs(points).max(initial=0.0))
    shift = HIGHEST_EXPONENT - int(np.frexp(largest)[1])
    scaled = np.ldexp(points, shift)
    if shift < 0 and not np.array_equal(np.ldexp(scaled, -shift), points):
        raise EngineError(
            "expected coordinates whose sizes differ by a factor of less than 1e300, got tiny ones beside "
            f"{largest:g}; set those to zero."
        )
    return np.ascontiguousarray(scaled)


@dataclass
class Cells:
    """The growing triangulation, in flat arrays.

    Attributes
    ----------
    far : int
        The vertex at infinity; the others are the points.
    vertices, mates : (d+1 times c,) int32
        See `tetrahedra`. A free cell has -1 for its first vertex.
    marks : (c,) int32
        In which insertion a cell was last asked about, and with what result.
    cavity, border, free : (k,) int32
        Cells of the present cavity, facets of its border, cells that can be used again.
    state : (5,) int64
        Numbers the loops keep between calls; see `tetrahedra`.
    """

    far: int
    width: int
    vertices: NDArray[np.int32]
    mates: NDArray[np.int32]
    marks: NDArray[np.int32]
    cavity: NDArray[np.int32]
    border: NDArray[np.int32]
    free: NDArray[np.int32]
    state: NDArray[np.int64]

    def grow(self) -> None:
        """Make room for half as many cells again.

        Raises
        ------
        EngineError
            When there would be more cells than facet numbers.
        """
        n = min(len(self.marks) + len(self.marks) // 2 + 64, LARGEST_CELLS)
        if n == len(self.marks):
            raise EngineError(
                f"the exact engine holds {LARGEST_CELLS} cells, and {self.far} points need more; use fewer points."
            )
        for name in ("vertices", "mates", "marks", "cavity", "border", "free"):
            old = getattr(self, name)
            wide = np.zeros(n * len(old) // len(self.marks) if name in ("vertices", "mates") else n, np.int32)
            wide[: len(old)] = old
            setattr(self, name, wide)


def _triangulated(points: Floats, stands_for: Ints, tick: Tick, seed: int) -> Cells | None:
    n, dim = points.shape
    kernel = KERNELS[dim]
    order = insertion_order(points, seed)
    bounds, flat = static_bounds(points), points.ravel()
    first = first_simplex(points)
    if first is None:
        return None
    used = np.zeros(n, bool)
    used[first] = True
    order = np.concatenate([first, order[~used[order]]])
    cells = _first_cells(n, first)
    scratch = kernel.scratch(n)
    state, stop, batch = cells.state, dim + 1, FIRST_BATCH
    while state[DONE] < n:
        started, before = time.perf_counter(), state[DONE]
        stop = min(before + batch, n)
        kernel.insert(
            flat, order, stop, n, bounds, cells.vertices, cells.mates, cells.marks, cells.cavity, cells.border,
            cells.free, state, stands_for, *scratch,
        )  # fmt: skip
        if state[DONE] < stop:
            cells.grow()
        elif time.perf_counter() - started < TICK_SECONDS / 2:
            batch *= 2
        elif time.perf_counter() - started > TICK_SECONDS:
            batch = max(batch // 2, 1)
        tick(state[DONE] / n)
    return cells


def _first_cells(n: int, first: Ints) -> Cells:
    """One simplex, and an infinite cell behind each of its facets."""
    width = len(first)
    room = min(int(CELLS_PER_POINT[width - 1] * n) + 1000, LARGEST_CELLS)
    slots, behind = _first_slots(width)
    vertices, mates = np.empty(width * room, np.int32), np.empty(width * room, np.int32)
    vertices[: slots.size] = np.append(first, n)[slots.ravel()]
    mates[: slots.size] = behind.ravel()
    cavity, border, free = (np.empty(room, np.int32) for _ in range(3))
    state = np.zeros(5, np.int64)
    state[USED], state[DONE] = width + 1, width
    return Cells(n, width, vertices, mates, np.zeros(room, np.int32), cavity, border, free, state)


@cache
def _first_slots(width: int) -> tuple[Ints, Ints]:
    """The first cells by the places of their vertices (the last one is the vertex at infinity), and their mates.

    In the cell behind a facet two vertices change places, because its orientation is the other one.
    """
    slots = np.tile(np.arange(width), (width + 1, 1))
    for k in range(width):
        slots[1 + k, k] = width
        a, b = [slot for slot in range(width) if slot != k][:2]
        slots[1 + k, [a, b]] = slots[1 + k, [b, a]]
    facet_of = {(frozenset(row) - {v}, cell): k for cell, row in enumerate(slots.tolist()) for k, v in enumerate(row)}
    mates = np.empty((width + 1, width), np.int64)
    for (facet, cell), k in facet_of.items():
        other = next(c for f, c in facet_of if f == facet and c != cell)
        mates[cell, k] = width * other + facet_of[facet, other]
    return slots, mates


def _in_order(cells: Cells) -> tuple[Ints, Ints]:
    used, width = int(cells.state[USED]), cells.width
    new_id = np.empty(used, np.int32)
    order = canonical.sorted_cells(cells.vertices, used, cells.far, width, new_id)
    simplices, neighbors = np.empty(len(order) * width, np.int32), np.empty(len(order) * width, np.int32)
    canonical.simplices_and_neighbors(cells.vertices, cells.mates, width, order, new_id, simplices, neighbors)
    return simplices.reshape(-1, width), neighbors.reshape(-1, width)
