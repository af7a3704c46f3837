"""The skeleton a tree draws."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from tetraskel import assemble_skeleton, build_tree, triangulate, triangulation_of
from tetraskel.kernels.forest import complete_forest
from tetraskel.kernels.skeleton import skeleton_of


def forest(parents):
    depth = []
    for parent in parents:
        depth.append(0 if parent < 0 else depth[parent] + 1)
    parent = np.array(parents, np.int32)
    return complete_forest(parent, np.array(depth, np.int32), np.zeros(len(parents), np.int32))


def branches(skeleton):
    return [
        skeleton.node[skeleton.branch_nodes[a:b]].tolist()
        for a, b in zip(skeleton.branch_offsets[:-1], skeleton.branch_offsets[1:], strict=True)
    ]


def test_branches_of_a_small_tree():
    #   0 - 1 - 2 - 4
    #         \ 3 - 5 - 6
    small = forest([-1, 0, 1, 1, 2, 3, 5])
    whole = skeleton_of(small, np.zeros((7, 3)), keep_leaves=True)
    assert branches(whole) == [[0, 1], [1, 2, 4], [1, 3, 5, 6]]
    assert whole.node_type.tolist() == [0, 2, 1, 1, 0, 1, 0]
    assert whole.branch_id.tolist() == [-1, 0, 1, 2, 1, 2, 2]
    bare = skeleton_of(small, np.zeros((7, 3)))
    assert branches(bare) == [[0, 1], [1, 2], [1, 3, 5]]


def test_a_single_node_is_a_skeleton():
    alone = skeleton_of(forest([-1]), np.zeros((1, 3)))
    assert len(alone.points) == 1
    assert branches(alone) == []


@pytest.mark.parametrize("dim", [2, 3])
def test_every_line_of_the_tree_is_in_one_branch(dim):
    tree = build_tree(triangulate(np.random.default_rng(0).random((300, dim))))
    skeleton = assemble_skeleton(tree, keep_leaves=True)
    pairs = {(a, b) for branch in branches(skeleton) for a, b in itertools.pairwise(branch)}
    assert pairs == {(tree.parent[n], n) for n in range(len(tree)) if tree.parent[n] >= 0}
    assert sum(len(branch) - 1 for branch in branches(skeleton)) == len(pairs)
    assert np.allclose(skeleton.points, tree.mesh.points[tree.mesh.simplices[tree.cell]].mean(axis=1))


def test_leaves_are_left_out_and_roots_stay():
    mesh = triangulate(np.random.default_rng(1).random((100, 3)))
    tree = build_tree(triangulation_of(mesh.points, mesh.simplices[::2]))
    skeleton = assemble_skeleton(tree)
    expected = [n for n in range(len(tree)) if tree.son_count[n] > 0 or tree.parent[n] < 0]
    assert skeleton.node.tolist() == expected
