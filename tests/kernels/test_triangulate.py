"""Points in, Delaunay triangulation out."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from tetraskel import EngineError, InputError, MeshError, triangulate, triangulation_of
from tetraskel.kernels import triangulate as module
from tetraskel.kernels.quality import volumes


def assert_is_delaunay(mesh):
    """Every open circumball is empty of points, up to rounding."""
    corners = mesh.coordinates[mesh.simplices]
    edges = corners[:, 1:] - corners[:, :1]
    centre = corners[:, 0] + np.linalg.solve(2 * edges, (edges**2).sum(axis=2)[..., None])[..., 0]
    radius = np.linalg.norm(centre - corners[:, 0], axis=1)
    for c, r in zip(centre, radius, strict=True):
        assert np.linalg.norm(mesh.coordinates - c, axis=1).min() >= r * (1 - 1e-7)


def assert_is_mesh(mesh):
    """Neighbours are mutual and share a facet; orientation is positive."""
    for cell, row in enumerate(mesh.neighbors):
        for k, other in enumerate(row):
            if other >= 0:
                facet = set(np.delete(mesh.simplices[cell], k))
                assert facet < set(mesh.simplices[other])
                assert cell in mesh.neighbors[other]
    corners = mesh.coordinates[mesh.simplices]
    assert (np.linalg.det(corners[:, 1:] - corners[:, :1]) >= 0).all()


@pytest.mark.parametrize("dim", [2, 3])
def test_generic_cloud(dim):
    points = np.random.default_rng(0).random((300, dim))
    mesh = triangulate(points)
    assert_is_delaunay(mesh)
    assert_is_mesh(mesh)
    assert np.array_equal(mesh.points, points)
    assert volumes(mesh).sum() == pytest.approx(ConvexHull(points).volume)
    assert set(mesh.simplices.ravel()) == set(range(len(points)))
    assert mesh.engine == "qhull"


def test_lattice_is_covered_and_order_of_points_does_not_matter():
    lattice = np.stack(np.meshgrid(*[np.arange(5.0)] * 3), -1).reshape(-1, 3)
    mesh = triangulate(lattice)
    shuffle = np.random.default_rng(1).permutation(len(lattice))
    other = triangulate(lattice[shuffle])
    assert volumes(mesh).sum() == pytest.approx(64)
    assert np.array_equal(shuffle[other.simplices], mesh.simplices)


def test_duplicates_are_merged_and_ids_map_back():
    points = np.random.default_rng(2).random((50, 3))
    doubled = np.concatenate([points, points[10:20], points[:1]])
    mesh = triangulate(doubled)
    assert mesh.n_merged == 11
    assert np.array_equal(mesh.points, points)
    assert np.array_equal(mesh.points[mesh.point_map], doubled)
    assert np.array_equal(doubled[mesh.original_ids], mesh.points)
    assert np.array_equal(mesh.simplices, triangulate(points).simplices)


def test_negative_zero_is_zero():
    mesh = triangulate([[0.0, 0.0], [-0.0, 0.0], [1, 0], [0, 1]])
    assert mesh.n_merged == 1


@pytest.mark.parametrize("gap", [1e-17, 1e-16])
def test_points_closer_than_rounding_still_map_to_a_vertex(gap):
    points = np.random.default_rng(3).random((40, 3))
    close = np.concatenate([points, points + gap, points - gap])
    mesh = triangulate(close)
    assert len(mesh.point_map) == len(close)
    assert np.abs(mesh.points[mesh.point_map] - close).max() < 1e-14
    assert set(mesh.simplices.ravel()) == set(range(len(mesh.points)))


@pytest.mark.parametrize("joggle", [1e-9, 1e-6, 1e-4])
def test_joggle_keeps_coordinates_and_is_reproducible(joggle):
    lattice = np.stack(np.meshgrid(*[np.arange(4.0)] * 3), -1).reshape(-1, 3)
    mesh = triangulate(lattice, joggle=joggle)
    assert np.array_equal(mesh.points, lattice)
    assert np.array_equal(mesh.simplices, triangulate(lattice, joggle=joggle).simplices)
    assert volumes(mesh).sum() == pytest.approx(27, rel=1e-3)


@pytest.mark.parametrize("kind", [np.float64, np.float32])
def test_points_of_a_plane_in_space_are_triangulated_in_it(kind):
    rng = np.random.default_rng(4)
    flat = np.zeros((80, 3))
    flat[:, :2] = rng.random((80, 2))
    reference = triangulate(flat[:, :2])
    assert np.array_equal(triangulate(flat).simplices, reference.simplices)
    for seed in range(5):
        rotation = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
        tilted = (flat @ rotation + 10).astype(kind)
        mesh = triangulate(tilted)
        assert mesh.simplices.shape == reference.simplices.shape
        assert np.array_equal(mesh.points, tilted)
        assert {frozenset(s) for s in mesh.simplices.tolist()} == {frozenset(s) for s in reference.simplices.tolist()}


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_planes_normal_to_an_axis_keep_the_other_coordinates(axis):
    flat = np.random.default_rng(5).random((30, 3))
    flat[:, axis] = 7
    assert np.array_equal(triangulate(flat).coordinates, np.delete(flat, axis, axis=1))


def test_a_thin_slab_is_not_a_plane():
    slab = np.random.default_rng(6).random((60, 3)) * [1, 1, 1e-9]
    assert triangulate(slab).dim == 3


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([1e-60, 1e-6, 1.0, 1e6, 1e60]), st.sampled_from([2, 3]))
def test_scale_does_not_matter(seed, scale, dim):
    points = np.random.default_rng(seed).random((30, dim))
    scaled = points * scale
    assert np.array_equal(triangulate(points).simplices, triangulate(scaled).simplices)


def test_far_from_the_origin():
    points = np.round(np.random.default_rng(7).random((200, 3)), 6)
    shifted = triangulate(points + 2.0**20)
    assert len(shifted.points) == 200
    assert_is_mesh(shifted)


@pytest.mark.parametrize("kind", [int, np.float32, ">f8", np.uint8, bool])
def test_any_real_type_is_taken(kind):
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]).astype(kind)
    assert triangulate(corners).simplices.shape == (1, 4)
    assert triangulate(np.asfortranarray(corners)).points.dtype == np.float64


@pytest.mark.parametrize("nothing", [[], np.empty((0, 2)), np.empty((0, 3))])
def test_no_points_no_simplices(nothing):
    mesh = triangulate(nothing)
    assert len(mesh) == 0
    assert mesh.neighbors.shape == mesh.simplices.shape


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([[0, 0, 0], [1, np.nan, 0], [np.inf, 0, 0]], "got 2 of 3 points with NaN, infinity"),
        ([[0, 0, 0], [1, 1, 1e200]], "got 1 of 2"),
        ([[0, 0]], "expected at least 3 distinct points .* got 1;"),
        ([[0, 0], [1, 1], [1, 1]], "got 2 after merging 1 duplicates"),
        ([[0, 0], [1, 1], [2, 2], [5, 5]], "got 4 points on one line"),
        ([[0, 0, 0], [1, 2, 3], [2, 4, 6]], "got 3 points on one line"),
        ([[1, 2, 3, 4]], r"shape \(n, 2\) or \(n, 3\), got shape \(1, 4\)"),
        ([1, 2, 3], "got shape"),
        ([["a", "b"]], "expected points as real numbers"),
        ([[1 + 2j, 0]], "expected points as real numbers"),
    ],
)
def test_unusable_points_are_refused(points, message):
    with pytest.raises(InputError, match=message):
        triangulate(points)


def test_options_are_checked():
    with pytest.raises(InputError, match="engine must be one of"):
        triangulate([[0, 0], [1, 0], [0, 1]], engine="cgal")
    with pytest.raises(InputError, match=r"joggle must lie between 0 and 0\.01; got 1"):
        triangulate([[0, 0], [1, 0], [0, 1]], joggle=1)


def test_a_missing_engine_is_named(monkeypatch):
    monkeypatch.setattr(module.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(EngineError, match="the qhull engine needs the package scipy"):
        triangulate([[0, 0], [1, 0], [0, 1]], engine="qhull")
    assert "vtk" in module.ENGINE_MODULES


@pytest.mark.parametrize(
    ("simplices", "message"),
    [
        ([[0, 1, 2], [0, 1, 3], [0, 1, 4]], "facets shared by at most two"),
        ([[0, 1, 1]], "use a point twice"),
        ([[0, 1, 9]], "expected point ids from 0 to 4, got 0 to 9"),
        ([[0, 1]], "shape"),
    ],
)
def test_unusable_meshes_are_refused(simplices, message):
    with pytest.raises(MeshError, match=message):
        triangulation_of(np.random.default_rng(0).random((5, 2)), simplices)


def test_a_surface_that_bends_is_not_a_mesh_of_triangles():
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    bent = triangulation_of(corners, [[0, 1, 2], [0, 1, 3]])
    with pytest.raises(InputError, match="triangles that bend in space"):
        bent.coordinates  # noqa: B018


def test_given_mesh_with_nan_is_refused():
    with pytest.raises(MeshError, match="finite"):
        triangulation_of([[0, 0], [1, 0], [0, np.nan]], [[0, 1, 2]])
