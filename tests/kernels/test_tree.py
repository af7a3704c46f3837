"""`build_tree` is the queue of the definition, node for node."""

from __future__ import annotations

from dataclasses import replace
from math import comb

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from paths import SAMPLES
from reference import Reference
from tetraskel import (
    EngineError,
    InputError,
    MeshError,
    Triangulation,
    assemble_skeleton,
    build_tree,
    decode_tree,
    remove_flat,
    triangulate,
    triangulation_of,
)
from tetraskel.kernels.compilation import numba_is_used
from tetraskel.kernels.forest import MANY_LEVELS

TRAVERSALS = ["breadth", "depth"]


def assert_equals_reference(mesh, traversal):
    reference = Reference(mesh.coordinates, mesh.simplices, mesh.neighbors)
    nodes = reference.breadth_first() if traversal == "breadth" else reference.depth_first()
    tree = build_tree(mesh, traversal=traversal)
    assert tree.cell.tolist() == [node.cell for node in nodes]
    assert tree.parent.tolist() == [node.parent for node in nodes]
    assert tree.depth.tolist() == [node.depth for node in nodes]
    assert tree.son_rank.tolist() == [node.son_rank for node in nodes]
    assert tree.tree_id.tolist() == [node.tree for node in nodes]
    assert [frozenset(row) for row in tree.entry_facet.tolist()] == [node.entry_facet for node in nodes]
    assert_counts(tree)


def assert_counts(tree):
    """Son counts and subtree sizes, counted again one by one."""
    sons, sizes = [0] * len(tree), [1] * len(tree)
    for node in range(len(tree) - 1, -1, -1):
        if tree.parent[node] >= 0:
            sons[tree.parent[node]] += 1
            sizes[tree.parent[node]] += sizes[node]
    assert tree.son_count.tolist() == sons
    assert tree.subtree_size.tolist() == sizes
    assert tree.is_leaf.tolist() == [count == 0 for count in sons]


def clouds(dim):
    """Clouds with ties: coordinates on coarse and fine grids, enough points to triangulate."""
    value = st.one_of(st.integers(-3, 3).map(float), st.floats(-2, 2, width=32))
    return st.lists(st.tuples(*[value] * dim), min_size=dim + 1, max_size=30, unique=True)


@pytest.mark.parametrize("traversal", TRAVERSALS)
@pytest.mark.parametrize("dim", [2, 3])
@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_equals_queue_on_any_cloud(dim, traversal, data):
    try:
        mesh = triangulate(np.array(data.draw(clouds(dim))))
    except InputError:
        return  # all on one line
    except EngineError:
        assert not numba_is_used()
        return  # so nearly on one line that Qhull gives up
    assert_equals_reference(mesh, traversal)


@pytest.mark.parametrize("traversal", TRAVERSALS)
@pytest.mark.parametrize("shape", [(5, 4), (4, 4, 4), (6, 3, 2)])
def test_equals_queue_on_lattices(shape, traversal):
    lattice = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), -1).reshape(-1, len(shape))
    assert_equals_reference(triangulate(lattice), traversal)
    assert_equals_reference(triangulate(lattice / 3), traversal)


@pytest.mark.parametrize("traversal", TRAVERSALS)
@pytest.mark.parametrize("dim", [2, 3])
def test_equals_queue_on_pieces(dim, traversal):
    points = np.random.default_rng(3).random((60, dim))
    mesh = triangulate(points)
    cells = mesh.simplices[np.random.default_rng(4).random(len(mesh)) < 0.45]
    pieces = triangulation_of(points, cells)
    assert build_tree(pieces).tree_id.max() > 3
    assert_equals_reference(pieces, traversal)


SMALL_SAMPLES = ["rectangle8.csv", "polygon.csv", "cloud20.csv"]


@pytest.mark.parametrize("traversal", TRAVERSALS)
@pytest.mark.parametrize("name", SMALL_SAMPLES)
def test_equals_queue_on_the_samples(name, traversal):
    points = np.loadtxt(SAMPLES / name, delimiter=",", skiprows=1)
    assert_equals_reference(triangulate(points), traversal)
    assert_equals_reference(triangulate(points, joggle=1e-6), traversal)


@pytest.mark.parametrize("traversal", TRAVERSALS)
def test_equals_queue_on_the_displaced_box(traversal):
    box = np.array([[x, y, z] for x in (0, 3) for y in (0, 2) for z in (0, 1)], float)
    assert_equals_reference(triangulate(box, joggle=1e-6), traversal)


@pytest.mark.parametrize("cloud", ["lattice", "thin"])
def test_order_of_vertices_in_a_simplex_does_not_matter(cloud):
    rng = np.random.default_rng(2)
    points = np.stack(np.meshgrid(*[np.arange(4.0)] * 3), -1).reshape(-1, 3) / 3
    if cloud == "thin":
        points = rng.random((60, 3)) * [1, 1, 1e-7]
    mesh = triangulate(points)
    turn = np.argsort(rng.random(mesh.simplices.shape), axis=1)
    turned = replace(
        mesh,
        simplices=np.take_along_axis(mesh.simplices, turn, axis=1),
        neighbors=np.take_along_axis(mesh.neighbors, turn, axis=1),
    )
    assert_equals_reference(turned, "breadth")


def mesh_of_tetrahedra(*corners):
    """Separate tetrahedra, each by its four corners."""
    return triangulation_of(np.concatenate(corners), np.arange(4 * len(corners)).reshape(-1, 4))


def test_roots_with_equal_and_almost_equal_barycentres():
    base = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    ulp = np.nextafter(1, 2) - 1
    for shift in ([0, 5, 0], [0, 0, 5], [0, 0, 0], [ulp, 5, 0], [-ulp, 5, 0], [0, -5, 0]):
        assert_equals_reference(mesh_of_tetrahedra(base, base + shift), "breadth")
    third = np.array([0.1, 0.2, 0.3])  # equal sums in another order, rounded otherwise
    for k in range(3):
        sums = np.array([np.roll(third, k), np.roll(third, k + 1), np.roll(third, k + 2)])
        tetrahedron = np.concatenate([sums.T, [[1, 1, 1]]])
        assert_equals_reference(mesh_of_tetrahedra(tetrahedron, tetrahedron + [0, 7, 0]), "breadth")


def strip(n):
    """A strip of n triangles in a row."""
    points = np.stack([np.arange(n + 2) / 2, np.arange(n + 2) % 2], axis=1)
    return triangulation_of(points, np.stack([np.arange(n), np.arange(1, n + 1), np.arange(2, n + 2)], axis=1))


@pytest.mark.parametrize("traversal", TRAVERSALS)
def test_a_path_of_many_levels(traversal):
    tree = build_tree(strip(MANY_LEVELS + 5), traversal=traversal)
    assert tree.depth.max() == MANY_LEVELS + 4
    assert_counts(tree)


def test_equals_queue_on_uniform_cloud():
    assert_equals_reference(triangulate(np.random.default_rng(0).random((300, 3))), "breadth")


def test_reversed_simplices_make_the_same_tree():
    mesh = triangulate(np.random.default_rng(5).random((50, 3)))
    mirrored = Triangulation(mesh.points, mesh.simplices[:, ::-1], mesh.neighbors[:, ::-1])
    assert build_tree(mirrored).parent.tolist() == build_tree(mesh).parent.tolist()


@pytest.mark.parametrize("dim", [2, 3])
def test_permuted_points_change_ids_only(dim):
    rng = np.random.default_rng(6)
    points = rng.random((400, dim))
    shuffle = rng.permutation(len(points))
    one, other = triangulate(points), triangulate(points[shuffle])
    assert np.array_equal(shuffle[other.simplices], one.simplices)
    a, b = build_tree(one), build_tree(other)
    assert np.array_equal(a.cell, b.cell)
    assert np.array_equal(a.parent, b.parent)
    assert np.array_equal(shuffle[b.apex], a.apex)


@pytest.mark.parametrize("scale", [1e-6, 1e-3, 2.0**40])
def test_unit_of_length_does_not_matter(scale):
    points = np.random.default_rng(7).random((300, 3))
    one, other = build_tree(triangulate(points)), build_tree(triangulate(points * scale))
    assert np.array_equal(one.parent, other.parent)
    assert np.array_equal(one.mesh.simplices, other.mesh.simplices)


def triangulations_of_polygon(vertices):
    """Every triangulation of a convex polygon, as lists of triangles."""
    if len(vertices) < 3:
        yield []
        return
    first, last = vertices[0], vertices[-1]
    for k in range(1, len(vertices) - 1):
        for left in triangulations_of_polygon(vertices[: k + 1]):
            for right in triangulations_of_polygon(vertices[k:]):
                yield [(first, vertices[k], last), *left, *right]


def shape_of(tree):
    """The binary tree without its numbers: per node, in order, which of its two edges lead on."""
    left_right = [["", ""] for _ in range(len(tree))]
    for node in range(len(tree) - 1, -1, -1):
        left, right = left_right[node]
        word = f"({left or '.'}{right or '.'})"
        parent = tree.parent[node]
        if parent < 0:
            return word
        left_right[parent][side_of(tree, node)] = word
    raise AssertionError("no root")


def side_of(tree, node):
    """0 when the node lies across its parent's left edge, 1 across the right, from the points alone."""
    parent = tree.parent[node]
    a, b = tree.entry_facet[parent]
    apex = tree.apex[parent]
    points = tree.mesh.points
    (u, v), (s, t) = points[b] - points[a], points[apex] - points[a]
    left_foot = a if u * t - v * s > 0 else b
    return 0 if left_foot in tree.entry_facet[node] else 1


@pytest.mark.parametrize("n", range(3, 10))
def test_polygon_triangulations_and_binary_trees_are_one_to_one(n):
    angles = np.sort(np.random.default_rng(n).random(n)) * 2 * np.pi
    points = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    shapes = set()
    for triangles in triangulations_of_polygon(list(range(n))):
        tree = build_tree(triangulation_of(points, triangles))
        assert len(tree) == n - 2
        shapes.add(shape_of(tree))
    assert len(shapes) == comb(2 * (n - 2), n - 2) // (n - 1)  # Catalan number C(n-2)


def test_no_simplex_no_node():
    tree = build_tree(triangulate(np.empty((0, 3))))
    assert len(tree) == 0
    assert tree.apex.shape == (0,)
    assert tree.entry_facet.shape == (0, 3)


def test_unknown_traversal_is_refused():
    with pytest.raises(InputError, match="traversal must be one of breadth, depth; got 'zigzag'"):
        build_tree(triangulate([[0, 0], [1, 0], [0, 1]]), traversal="zigzag")


@pytest.mark.parametrize("function", [build_tree, remove_flat, decode_tree, assemble_skeleton])
@pytest.mark.parametrize("thing", [None, "points", np.eye(3)])
def test_other_objects_are_refused(function, thing):
    with pytest.raises(InputError, match=r"expected a (Tree|Triangulation), got"):
        function(thing)


def test_doubled_cells_are_refused():
    points = np.random.default_rng(1).random((10, 2))
    with pytest.raises(MeshError, match="got 2 simplices without one; remove doubled cells"):
        build_tree(triangulation_of(points, [[0, 1, 2], [2, 1, 0], [3, 4, 5]]))


def test_input_is_not_written_to():
    mesh = triangulate(np.random.default_rng(8).random((100, 3)))
    for array in (mesh.points, mesh.simplices, mesh.neighbors):
        array.setflags(write=False)
    build_tree(mesh)
    build_tree(mesh, traversal="depth")


def test_progress_is_told_and_can_stop_the_walk():
    mesh = triangulate(np.random.default_rng(9).random((2000, 3)))
    told = []
    build_tree(mesh, tick=told.append)
    assert told
    assert max(told) <= 1

    def stop(_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        build_tree(mesh, tick=stop)
