"""Tree and triangulation determine each other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tetraskel import InputError, binarize, build_tree, decode_tree, remove_flat, triangulate, triangulation_of
from tetraskel.kernels.decode import decode_simplices, encode_tree

CLOUDS = {
    "square": np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float),
    "uniform 2D": np.random.default_rng(1).random((300, 2)),
    "uniform 3D": np.random.default_rng(2).random((300, 3)),
    "lattice": np.stack(np.meshgrid(*[np.arange(4.0)] * 3), -1).reshape(-1, 3),
}


def vertex_sets(simplices):
    return [frozenset(row) for row in simplices.tolist()]


@pytest.mark.parametrize("traversal", ["breadth", "depth"])
@pytest.mark.parametrize("name", CLOUDS)
def test_decoding_gives_the_mesh_back(name, traversal):
    mesh = triangulate(CLOUDS[name])
    decoded = decode_tree(build_tree(mesh, traversal=traversal))
    assert vertex_sets(decoded.simplices) == vertex_sets(mesh.simplices)
    assert vertex_sets(decoded.neighbors) == vertex_sets(mesh.neighbors)
    assert np.array_equal(decoded.points, mesh.points)
    assert np.array_equal(build_tree(decoded).cell, build_tree(mesh).cell)


@pytest.mark.parametrize("name", CLOUDS)
def test_the_code_is_all_that_is_used(name):
    """Parents, points left behind, apexes and one facet: simplices in the order of the traversal."""
    tree = build_tree(triangulate(CLOUDS[name]))
    code = encode_tree(tree.parent, tree.entry_facet, tree.apex)
    assert code.root_facets.shape == (1, tree.mesh.dim)
    assert vertex_sets(decode_simplices(code, tree.depth)) == vertex_sets(tree.mesh.simplices[tree.cell])


@pytest.mark.parametrize("field", ["apex", "left", "root_facets"])
def test_a_wrong_value_in_the_code_is_a_wrong_mesh(field):
    tree = build_tree(triangulate(CLOUDS["uniform 3D"]))
    code = encode_tree(tree.parent, tree.entry_facet, tree.apex)
    values = getattr(code, field).copy()
    values.flat[min(7, values.size - 1)] += 1
    wrong = decode_simplices(replace(code, **{field: values}), tree.depth)
    assert vertex_sets(wrong) != vertex_sets(tree.mesh.simplices[tree.cell])


def test_pieces_are_decoded_too():
    mesh = triangulate(CLOUDS["uniform 3D"])
    pieces = triangulation_of(mesh.points, mesh.simplices[::3])
    assert vertex_sets(decode_tree(build_tree(pieces)).simplices) == vertex_sets(pieces.simplices)


def test_nothing_decodes_to_nothing():
    assert len(decode_tree(build_tree(triangulate(np.empty((0, 3)))))) == 0


def test_a_contracted_tree_cannot_be_decoded():
    tree = remove_flat(build_tree(triangulate(CLOUDS["uniform 3D"])), threshold=0.3)
    with pytest.raises(InputError, match="expected a whole tree"):
        decode_tree(tree)


@pytest.mark.parametrize("name", [*CLOUDS, "pieces"])
def test_binary_tree_has_the_same_nodes(name):
    mesh = triangulate(CLOUDS.get(name, CLOUDS["uniform 3D"]))
    tree = build_tree(triangulation_of(mesh.points, mesh.simplices[::3]) if name == "pieces" else mesh)
    binary = binarize(tree)
    assert np.array_equal(binary.parents(), tree.parent)
    for node in range(-1, len(tree)):
        sons, son = [], tree.forest.roots[0] if node < 0 else binary.left[node]
        while son >= 0:
            sons.append(son)
            son = binary.right[son]
        assert sons == np.flatnonzero(tree.parent == node).tolist()
