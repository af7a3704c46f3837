from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import minimum_spanning_tree

from tetraskel import gate_arrays, gate_tree, triangulate
from tetraskel.kernels.passage_widths import widths_and_rooms
from tetraskel.kernels.spanning_tree import maximum_spanning_tree, rooted


def test_spanning_tree_weighs_what_kruskals_does():
    rng = np.random.default_rng(0)
    first, second = rng.integers(0, 300, (2, 2000))
    apart = first != second
    first, second = first[apart], second[apart]
    pairs = np.unique(np.stack([np.minimum(first, second), np.maximum(first, second)]), axis=1)
    weight = rng.uniform(1, 2, pairs.shape[1])
    links = maximum_spanning_tree(300, *pairs, weight)
    kruskal = minimum_spanning_tree(coo_matrix((3 - weight, tuple(pairs)), shape=(300, 300)).tocsr())
    assert weight[links].sum() == pytest.approx((3 - kruskal.data).sum(), rel=1e-12)


def test_equal_weights_still_give_a_tree():
    grid = np.arange(400).reshape(20, 20)
    first = np.concatenate([grid[:, 1:].ravel(), grid[1:].ravel()])
    second = np.concatenate([grid[:, :-1].ravel(), grid[:-1].ravel()])
    links = maximum_spanning_tree(400, first, second, np.ones(len(first)))
    tree = rooted(400, first[links], second[links], 7)
    assert len(links) == 399
    assert sorted(np.concatenate(tree.levels)) == list(range(400))


@pytest.mark.parametrize(
    "points",
    [
        np.random.default_rng(3).normal(size=(600, 3)),
        np.stack(np.meshgrid(*[np.arange(6.0)] * 3), -1).reshape(-1, 3),
        np.random.default_rng(4).normal(size=(600, 2)),
    ],
    ids=["3D", "lattice", "2D"],
)
def test_gates_are_the_widest_ways_out(points):
    mesh = triangulate(points)
    m = len(mesh)
    widths, rooms = widths_and_rooms(mesh.coordinates, mesh.simplices)
    tree = gate_tree(mesh)
    # narrowest gate on the way out of each basin, down the tree ...
    way = tree.width.copy()
    for level in tree.tree.levels[1:]:
        above = tree.tree.parent[level]
        way[level] = np.minimum(way[level], way[above])
    # ... against relaxing each simplex over its facets until nothing gets wider
    best = np.append(np.zeros(m), np.inf)
    while True:
        wider = np.maximum(best[:-1], np.minimum(widths, best[mesh.neighbors]).max(axis=1))
        if np.array_equal(wider, best[:-1]):
            break
        best[:-1] = wider
    entered = way[tree.basins.of_simplex[:-1]]
    lost = best[:-1] < entered  # inside its basin a simplex may sit behind a facet of its own
    assert np.all(best[:-1] <= entered)
    assert np.all(widths[lost].max(axis=1) >= best[:-1][lost])
    assert tree.room_radius[tree.outside] == rooms.max()


def test_gate_arrays_lead_out_across_a_facet_of_the_gates_width():
    mesh = triangulate(np.random.default_rng(5).normal(size=(500, 3)))
    tree = gate_tree(mesh)
    arrays = gate_arrays(tree, mesh.neighbors)
    basin = tree.basins.of_simplex
    gated = np.isfinite(arrays.width)
    assert np.array_equal(
        basin[np.where(arrays.parent < 0, len(mesh), arrays.parent)[gated]], tree.tree.parent[basin[:-1][gated]]
    )
    assert np.all(arrays.parent[~gated] == -1)
    assert np.all(arrays.room_radius >= 0)
