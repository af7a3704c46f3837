"""Tree and triangulation determine each other."""

from __future__ import annotations

import numpy as np
import pytest

from tetraskel import InputError, binarize, build_tree, decode_tree, remove_flat, triangulate, triangulation_of

CLOUDS = {
    "square": np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float),
    "uniform 2D": np.random.default_rng(1).random((300, 2)),
    "uniform 3D": np.random.default_rng(2).random((300, 3)),
    "lattice": np.stack(np.meshgrid(*[np.arange(4.0)] * 3), -1).reshape(-1, 3),
}


@pytest.mark.parametrize("traversal", ["breadth", "depth"])
@pytest.mark.parametrize("name", CLOUDS)
def test_decoding_gives_the_mesh_back(name, traversal):
    mesh = triangulate(CLOUDS[name])
    decoded = decode_tree(build_tree(mesh, traversal=traversal))
    assert np.array_equal(decoded.simplices, mesh.simplices)
    assert np.array_equal(decoded.neighbors, mesh.neighbors)
    assert np.array_equal(decoded.points, mesh.points)


def test_pieces_are_decoded_too():
    mesh = triangulate(CLOUDS["uniform 3D"])
    pieces = triangulation_of(mesh.points, mesh.simplices[::3])
    assert np.array_equal(decode_tree(build_tree(pieces)).simplices, pieces.simplices)


def test_a_contracted_tree_cannot_be_decoded():
    tree = remove_flat(build_tree(triangulate(CLOUDS["uniform 3D"])), threshold=0.3)
    with pytest.raises(InputError, match="expected a whole tree"):
        decode_tree(tree)


@pytest.mark.parametrize("name", CLOUDS)
def test_binary_tree_has_the_same_nodes(name):
    tree = build_tree(triangulate(CLOUDS[name]))
    binary = binarize(tree)
    assert np.array_equal(binary.parents(), tree.parent)
    for node in range(len(tree)):
        sons, son = [], binary.left[node]
        while son >= 0:
            sons.append(son)
            son = binary.right[son]
        assert sons == np.flatnonzero(tree.parent == node).tolist()
