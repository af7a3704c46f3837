"""Flat simplices: the measure, and what their removal leaves."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reference import contracted
from tetraskel import InputError, build_tree, remove_flat, triangulate, triangulation_of
from tetraskel.kernels.flat import contract
from tetraskel.kernels.forest import complete_forest
from tetraskel.kernels.quality import qualities, volumes

REGULAR_TETRAHEDRON = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], float)
REGULAR_TRIANGLE = np.array([[0, 0], [1, 0], [0.5, np.sqrt(3) / 2]])
BOX = np.array([[x, y, z] for x in (0, 3) for y in (0, 2) for z in (0, 1)], float)


def quality_of(points):
    return qualities(triangulation_of(points, [range(len(points))]))[0]


@pytest.mark.parametrize("regular", [REGULAR_TETRAHEDRON, REGULAR_TRIANGLE])
def test_regular_simplex_has_quality_one(regular):
    assert quality_of(regular) == pytest.approx(1, abs=1e-15)


def test_flat_simplex_has_quality_zero():
    assert quality_of(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])) == 0
    assert quality_of(np.array([[0, 0], [1, 1], [3, 3]])) == 0


def test_known_quality():
    corner = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    # V = 1/6, h^2 = 3 + 6 = 9: beta h^3 / V = sqrt(3)/216 * 27 * 6
    assert 1 / quality_of(corner) == pytest.approx(np.sqrt(3) / 216 * 27 * 6)


@given(st.integers(0, 10**6), st.floats(1e-9, 1e9), st.sampled_from([2, 3]))
def test_quality_does_not_see_rotation_scale_or_shift(seed, scale, dim):
    rng = np.random.default_rng(seed)
    points = rng.random((dim + 1, dim))
    rotation = np.linalg.qr(rng.normal(size=(dim, dim)))[0]
    moved = (points @ rotation) * scale + rng.normal(size=dim) * scale
    assert quality_of(moved) == pytest.approx(quality_of(points), abs=1e-9)
    assert 0 <= quality_of(points) <= 1 + 1e-12


def test_volumes_add_up_to_the_box():
    assert volumes(triangulate(BOX)).sum() == pytest.approx(6)


def on_a_side(points):
    """Whether a point lies on the border of the box, up to the displacement."""
    return bool(((np.abs(points) < 1e-3) | (np.abs(points - [3, 2, 1]) < 1e-3)).any())


def test_displaced_box_grows_branches_on_its_sides_and_loses_them():
    mesh = triangulate(BOX, joggle=1e-6)
    tree = build_tree(mesh)
    centre = mesh.points[mesh.simplices].mean(axis=1)
    assert any(on_a_side(centre[cell]) for cell in tree.cell), "figure 17"
    kept = remove_flat(tree)
    assert not any(on_a_side(centre[cell]) for cell in kept.cell), "figure 18"
    assert volumes(mesh)[kept.cell].sum() == pytest.approx(6)


def ordered_sons(forest):
    sons = {node: [] for node in range(len(forest))}
    for node in np.lexsort((forest.son_rank, forest.parent)):
        if forest.parent[node] >= 0:
            sons[forest.parent[node]].append(int(node))
    return sons


@st.composite
def forests_and_flats(draw):
    """Random forests numbered breadth first, tree by tree, and random flat nodes."""
    parents, depths, trees = [], [], []
    for tree in range(draw(st.integers(1, 3))):
        start = len(parents)
        parents.append(-1), depths.append(0), trees.append(tree)
        node = start
        while node < len(parents) and len(parents) < start + 20:
            for _ in range(draw(st.integers(0, 3))):
                parents.append(node), depths.append(depths[node] + 1), trees.append(tree)
            node += 1
    flat = draw(st.lists(st.booleans(), min_size=len(parents), max_size=len(parents)))
    return np.array(parents, np.int32), np.array(depths, np.int32), np.array(trees, np.int32), np.array(flat)


@given(forests_and_flats())
def test_contraction_is_the_definition(case):
    parent, depth, tree_id, flat = case
    sons, roots = contracted(parent.tolist(), flat.tolist())
    forest, kept = contract(complete_forest(parent, depth, tree_id), flat, "breadth")
    assert sorted(kept.tolist()) == sorted(sons)
    assert {int(kept[n]): [int(kept[s]) for s in below] for n, below in ordered_sons(forest).items()} == sons
    assert kept[forest.roots].tolist() == roots
    assert np.array_equal(forest.tree_id, tree_id[kept])
    for node in range(len(forest)):
        above = forest.parent[node]
        assert above < node
        assert forest.depth[node] == (0 if above < 0 else forest.depth[above] + 1)


def test_contraction_of_a_depth_first_tree_is_the_definition():
    tree = build_tree(triangulate(np.random.default_rng(3).random((80, 3))), traversal="depth")
    flat = np.random.default_rng(4).random(len(tree)) < 0.5
    flat[0] = True
    sons, roots = contracted(tree.parent.tolist(), flat.tolist())
    forest, kept = contract(tree.forest, flat, "depth")
    assert {int(kept[n]): [int(kept[s]) for s in below] for n, below in ordered_sons(forest).items()} == sons
    assert kept[forest.roots].tolist() == roots
    visited, todo = [], [0]
    while todo:
        visited.append(todo.pop())
        todo += ordered_sons(forest)[visited[-1]][::-1]
    assert visited == list(range(len(forest)))


def test_quality_equal_to_the_threshold_is_kept():
    tree = build_tree(triangulate(BOX))
    quality = qualities(tree.mesh)
    assert len(remove_flat(tree, threshold=float(quality.min()))) == len(tree)


@pytest.mark.parametrize("traversal", ["breadth", "depth"])
@pytest.mark.parametrize("dim", [2, 3])
def test_nothing_but_flat_nodes_disappears(dim, traversal):
    tree = build_tree(triangulate(np.random.default_rng(1).random((500, dim))), traversal=traversal)
    flat = qualities(tree.mesh) < 0.3
    kept = remove_flat(tree, threshold=0.3)
    assert set(kept.cell.tolist()) == set(np.flatnonzero(~flat).tolist())
    cells = tree.cell.tolist()
    for node, cell in enumerate(kept.cell.tolist()):
        above = tree.parent[cells.index(cell)]
        while above >= 0 and flat[tree.cell[above]]:
            above = tree.parent[above]
        if above >= 0:
            assert kept.cell[kept.parent[node]] == tree.cell[above]


def test_threshold_zero_keeps_everything():
    tree = build_tree(triangulate(BOX))
    assert np.array_equal(remove_flat(tree, threshold=0).cell, tree.cell)


def test_all_flat_leaves_an_empty_tree():
    tree = build_tree(triangulate(BOX))
    assert len(remove_flat(tree, threshold=1)) == 0


@pytest.mark.parametrize("threshold", [-0.1, 1.5, np.nan])
def test_threshold_out_of_range_is_refused(threshold):
    with pytest.raises(InputError, match="threshold must"):
        remove_flat(build_tree(triangulate(BOX)), threshold=threshold)
