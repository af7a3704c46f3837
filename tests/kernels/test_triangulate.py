"""Points in, Delaunay triangulation out."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from tetraskel import EngineError, InputError, MeshError, triangulate, triangulation_of
from tetraskel.kernels import triangulate as module
from tetraskel.kernels.adjacency import is_mesh
from tetraskel.kernels.compilation import SWITCH, numba_is_used
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


NEEDS_NUMBA = pytest.mark.skipif(not numba_is_used(), reason="numba is not installed (the extra fast)")
every_engine = pytest.mark.parametrize("engine", ["qhull", pytest.param("exact", marks=NEEDS_NUMBA)])


@every_engine
@pytest.mark.parametrize("dim", [2, 3])
def test_generic_cloud(dim, engine):
    points = np.random.default_rng(0).random((300, dim))
    mesh = triangulate(points, engine=engine)
    assert_is_delaunay(mesh)
    assert_is_mesh(mesh)
    assert np.array_equal(mesh.points, points)
    assert volumes(mesh).sum() == pytest.approx(ConvexHull(points).volume)
    assert set(mesh.simplices.ravel()) == set(range(len(points)))
    assert mesh.engine == engine


def test_auto_is_the_exact_engine_where_numba_works():
    assert triangulate(np.eye(3)).engine == ("exact" if numba_is_used() else "qhull")


@every_engine
def test_lattice_is_covered_and_order_of_points_does_not_matter(engine):
    lattice = np.stack(np.meshgrid(*[np.arange(5.0)] * 3), -1).reshape(-1, 3)
    mesh = triangulate(lattice, engine=engine)
    shuffle = np.random.default_rng(1).permutation(len(lattice))
    other = triangulate(lattice[shuffle], engine=engine)
    assert volumes(mesh).sum() == pytest.approx(64)
    assert np.array_equal(shuffle[other.simplices], mesh.simplices)


@every_engine
def test_duplicates_are_merged_and_ids_map_back(engine):
    points = np.random.default_rng(2).random((50, 3))
    doubled = np.concatenate([points, points[10:20], points[:1]])
    mesh = triangulate(doubled, engine=engine)
    assert mesh.n_merged == 11
    assert np.array_equal(mesh.points, points)
    assert np.array_equal(mesh.points[mesh.point_map], doubled)
    assert np.array_equal(doubled[mesh.original_ids], mesh.points)
    assert np.array_equal(mesh.simplices, triangulate(points, engine=engine).simplices)


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


@pytest.mark.parametrize("offset", [(4.6e6, 5e5, 0), (4.6e6, 5e5, 100), (1e9, -1e9, 1e9)])
@pytest.mark.parametrize("extent", [5, 200])
@pytest.mark.parametrize("angle", [0, 0.3, np.pi / 4])
def test_planes_far_from_the_origin(offset, extent, angle):
    flat = np.zeros((90, 3))
    flat[:, :2] = np.random.default_rng(0).random((90, 2)) * [extent, 5]
    turn = np.array([[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]])
    mesh = triangulate(flat @ turn.T + offset)
    assert {frozenset(s) for s in mesh.simplices.tolist()} == {
        frozenset(s) for s in triangulate(flat[:, :2]).simplices.tolist()
    }


def test_single_precision_far_from_the_origin_keeps_an_exact_height():
    building = np.random.default_rng(1).random((100, 3)) * [500, 500, 5] + [4.6e6, 5e5, 0]
    assert triangulate(building.astype(np.float32)).dim == 3


@pytest.mark.parametrize("seed", range(8))
def test_order_of_points_does_not_matter_on_tilted_lattices(seed):
    rng = np.random.default_rng(seed)
    lattice = np.zeros((49, 3))
    lattice[:, :2] = np.stack(np.meshgrid(np.arange(7.0), np.arange(7.0)), -1).reshape(-1, 2)
    tilted = lattice @ np.linalg.qr(rng.normal(size=(3, 3)))[0]
    shuffle = rng.permutation(len(tilted))
    one, other = triangulate(tilted), triangulate(tilted[shuffle])
    assert np.array_equal(shuffle[other.simplices], one.simplices)


@pytest.mark.parametrize("gap", [1e-9, 1e-11, 1e-12, 1e-13, 1e-15])
@pytest.mark.parametrize("seed", range(4))
@every_engine
def test_almost_coincident_points_give_a_mesh_all_the_same(gap, seed, engine):
    rng = np.random.default_rng(seed)
    points = rng.random((60, 3))
    close = np.concatenate([points, points + gap * rng.normal(size=points.shape)])
    mesh = triangulate(close, engine=engine)
    assert np.array_equal(triangulation_of(mesh.points, mesh.simplices).neighbors, mesh.neighbors)
    assert np.abs(mesh.points[mesh.point_map] - close).max() <= 1e-5
    assert set(mesh.simplices.ravel()) == set(range(len(mesh.points)))


@pytest.mark.parametrize("seed", range(4))
@every_engine
def test_clumps_and_noisy_lattices_give_a_mesh(seed, engine):
    rng = np.random.default_rng(seed)
    clump = np.concatenate([rng.random((40, 3)), 0.5 + 1e-6 * rng.random((60, 3))])
    lattice = np.stack(np.meshgrid(*[np.arange(5.0)] * 3), -1).reshape(-1, 3) + 1e-13 * rng.normal(size=(125, 3))
    for points in (clump, lattice):
        mesh = triangulate(points, engine=engine)
        assert np.array_equal(triangulation_of(mesh.points, mesh.simplices).neighbors, mesh.neighbors)


def test_a_slab_too_thin_for_qhull_is_one_clear_error():
    slab = np.random.default_rng(2).random((60, 3)) * [1, 1, 1e-13]
    with pytest.raises(EngineError, match="almost lie in a plane"):
        triangulate(slab, engine="qhull")


@NEEDS_NUMBA
def test_a_slab_too_thin_for_qhull_is_none_for_the_exact_engine():
    slab = np.random.default_rng(2).random((60, 3)) * [1, 1, 1e-13]
    assert_is_mesh(triangulate(slab, engine="exact"))


def test_what_is_no_mesh_is_recognised():
    mesh = triangulate(np.random.default_rng(8).random((50, 3)))
    assert is_mesh(mesh.simplices, mesh.neighbors)
    wrong = mesh.neighbors.copy()
    inner = int(np.flatnonzero((wrong >= 0).all(axis=1))[0])
    wrong[inner, 0], wrong[inner, 1] = wrong[inner, 1], wrong[inner, 0]
    assert not is_mesh(mesh.simplices, wrong)
    doubled = np.concatenate([mesh.simplices, mesh.simplices])
    shifted = np.where(mesh.neighbors < 0, -1, mesh.neighbors + len(mesh))
    assert not is_mesh(doubled, np.concatenate([mesh.neighbors, shifted]))


def test_joggle_is_a_share_of_the_diagonal():
    points = np.random.default_rng(9).random((2000, 3)) * [1, 2, 2]
    moved = module._displacements(points, 1e-3)
    assert np.abs(moved).max() == pytest.approx(3e-3, rel=1e-2)
    assert np.abs(moved.mean(axis=0)).max() < 2e-4


def test_a_thin_slab_is_not_a_plane():
    slab = np.random.default_rng(6).random((60, 3)) * [1, 1, 1e-9]
    assert triangulate(slab).dim == 3


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([1e-160, 1e-60, 1e-6, 1.0, 1e6, 1e60, 1e99]), st.sampled_from([2, 3]))
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
        ([[1, 2], [3]], "expected points as an array of shape"),
        (np.ma.masked_less([[0, 0], [1, 0], [0, 1]], 1), "got a masked array"),
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


def test_the_exact_engine_without_numba_is_named(monkeypatch):
    monkeypatch.setenv(SWITCH, "0")
    with pytest.raises(EngineError, match=f"needs the package numba, .* switched off by {SWITCH}=0"):
        triangulate([[0, 0], [1, 0], [0, 1]], engine="exact")
    assert triangulate([[0, 0], [1, 0], [0, 1]]).engine == "qhull"


@NEEDS_NUMBA
def test_an_engine_that_cannot_be_compiled_is_replaced_with_one_warning(monkeypatch):
    from tetraskel.kernels import compilation
    from tetraskel.kernels.exact import engine as exact

    def broken(dim):
        raise RuntimeError("LLVM is ill\nand more")

    monkeypatch.setattr(exact, "prepare", broken)
    monkeypatch.setattr(compilation, "_failures", [])
    points = np.random.default_rng(0).random((20, 3))
    with pytest.raises(EngineError, match=r"could not be compiled: LLVM is ill; repair numba"):
        triangulate(points, engine="exact")
    with pytest.warns(RuntimeWarning, match=r"numba is installed but does not work \(LLVM is ill\)"):
        assert triangulate(points).engine == "qhull"
    assert triangulate(points).engine == "qhull"  # without a second warning: warnings are errors here


@pytest.mark.parametrize(
    ("simplices", "message"),
    [
        ([[0, 1, 2], [0, 1, 3], [0, 1, 4]], "facets shared by at most two"),
        ([[0, 1, 1]], "use a point twice"),
        ([[0, 1, 9]], "expected point ids from 0 to 4, got 0 to 9"),
        ([[0, 1]], r"of shape \(m, 3\), got shape \(1, 2\)"),
        ([[0, 1, 2, 3]], r"of shape \(m, 3\), got shape \(1, 4\)"),
        ([[0, 1, 2.5]], "point ids as whole numbers"),
        ([[0, 1, 2**32 + 3]], "got 0 to 4294967299"),
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
    with pytest.raises(InputError, match="got 1 of 3 points with NaN"):
        triangulation_of([[0, 0], [1, 0], [0, np.nan]], [[0, 1, 2]])
