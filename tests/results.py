"""Two data sets compared whole: points, cells and all arrays, in an order of their own."""

from __future__ import annotations

import numpy as np
import pyvista

PLACE_DIGITS = 6  # by which points are sorted
ROUNDING = 1e-9  # of the largest number, between two engines


def assert_same_data(found, wanted, *, another_engine: bool = False) -> None:
    """The same points, cells and arrays, to the last bit.

    But for what is `another_engine`'s: rounding, the numbers of simplices, the order of corners within a simplex, and
    so at which corner and in which direction a polygon around an edge, or the edge across a facet, begins.
    """
    found, wanted = pyvista.wrap(found), pyvista.wrap(wanted)
    assert type(found) is type(wanted)
    assert (found.n_points, found.n_cells) == (wanted.n_points, wanted.n_cells)
    assert set(found.point_data) == set(wanted.point_data)
    assert set(found.cell_data) == set(wanted.cell_data)
    sides = [_sorted(data, another_engine) for data in (found, wanted)]
    assert sides[0][0] == sides[1][0]
    for name, values in sides[1][1].items():
        _assert_close(sides[0][1][name], values, ROUNDING if another_engine else 0.0, name)


def _sorted(data, another_engine):
    """The cells, each by the places of its points in the order, and the arrays, in order."""
    order = np.lexsort(np.round(data.points, PLACE_DIGITS).T)
    cells = _cells(data, np.argsort(order), another_engine)
    rows = [row for _, row in cells]
    arrays = {"points": data.points[order]}
    arrays |= {f"point array {name}": values[order] for name, values in data.point_data.items()}
    arrays |= {f"cell array {name}": values[rows] for name, values in data.cell_data.items()}
    if another_engine:
        arrays.pop("point array CellId", None)
        arrays |= {name: np.sort(values, axis=1) for name, values in arrays.items() if name.endswith("EntryFacet")}
    return [cell for cell, _ in cells], arrays


def _cells(data, rank, another_engine):
    """Each cell's points by rank, and its row; sorted."""
    if isinstance(data, pyvista.UnstructuredGrid):
        parts = [(data.cells, sorted if another_engine else list)]
    else:
        canonical = _turned if another_engine else list
        parts = [(data.verts, list), (data.lines, _undirected if another_engine else list), (data.faces, canonical)]
    cells = []
    for part, canonical in parts:
        at = 0
        while at < len(part):
            cells.append((canonical(rank[part[at + 1 : at + 1 + part[at]]].tolist()), len(cells)))
            at += 1 + part[at]
    return sorted(cells)


def _undirected(line):
    """A single edge from its lower point; a polyline as it is."""
    return sorted(line) if len(line) == 2 else line


def _turned(ring):
    """A ring from its first corner, towards the lower of the two beside it."""
    at = ring.index(min(ring))
    ring = ring[at:] + ring[:at]
    return min(ring, ring[:1] + ring[:0:-1])


def _assert_close(found, wanted, rounding, name):
    found, wanted = np.asarray(found), np.asarray(wanted)
    assert (found.shape, found.dtype.kind) == (wanted.shape, wanted.dtype.kind), name
    if wanted.dtype.kind != "f":
        assert np.array_equal(found, wanted), name
    elif len(wanted):
        largest = np.abs(wanted[np.isfinite(wanted)]).max(initial=0)
        assert np.allclose(found, wanted, rtol=0, atol=rounding * largest, equal_nan=True), name
