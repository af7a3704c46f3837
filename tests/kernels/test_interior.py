from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from checks import count_pieces, euler_characteristic, overlap
from shapes import FLATS, SOLIDS, comb, torus
from tetraskel import InputError, InsideWarning, build_tree, interior, submesh, triangulate

# the plate and the wall of the vessel are thin: half the points leave gaps half as wide as they are thick
DENSITIES = [(name, n) for name in [*SOLIDS, *FLATS] for n in ((10_000, 20_000) if name in ("plate", "vessel") else
                                                               (5_000, 10_000))]  # fmt: skip


@pytest.mark.parametrize(("name", "n"), DENSITIES)
def test_inside_of_known_shapes(name, n):
    shape = {**SOLIDS, **FLATS}[name]()
    mesh = triangulate(shape.sample(n, np.random.default_rng(n)))
    inside = interior(mesh)
    assert overlap(mesh, inside, shape) >= 0.97
    assert count_pieces(mesh.neighbors, inside) == shape.components
    assert count_pieces(mesh.neighbors, ~inside, outside_too=True) == shape.outside_pieces
    assert euler_characteristic(mesh.simplices[inside]) == shape.euler


@pytest.fixture(scope="module")
def ring():
    points = torus().sample(4000, np.random.default_rng(11))
    return points, sorted_cells(points, np.arange(len(points)))


def sorted_cells(points, ids):
    mesh = triangulate(points)
    cells = np.sort(ids[mesh.simplices[interior(mesh)]], axis=1)
    return cells[np.lexsort(cells.T)]


@pytest.mark.parametrize("change", ["rotate", "shrink", "grow", "shift", "permute"])
def test_inside_follows_the_cloud(ring, change):
    points, expected = ring
    rng = np.random.default_rng(12)
    ids = rng.permutation(len(points)) if change == "permute" else np.arange(len(points))
    diagonal = np.linalg.norm(np.ptp(points, axis=0))
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    moved = {"rotate": points @ turn, "shrink": points * 1e-6, "grow": points * 1e6,
             "shift": points + 1000 * diagonal, "permute": points[ids]}[change]  # fmt: skip
    assert np.array_equal(sorted_cells(moved, ids), expected)


@pytest.mark.parametrize(("inner", "outer"), [(3000, 3000), (6000, 2000), (1500, 9000)])
def test_a_ring_with_unlike_gaps_on_both_sides_is_found(inner, outer):
    rng = np.random.default_rng(inner)
    angles = rng.uniform(0, 2 * np.pi, inner + outer)
    radii = np.where(np.arange(inner + outer) < inner, 1.5, 2.5)
    mesh = triangulate(radii[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1))
    assert np.array_equal(interior(mesh), has_both(mesh, 2.0))


def has_both(mesh, radius):
    """Triangles with corners on both sides of a circle."""
    outside = np.linalg.norm(mesh.points, axis=1)[mesh.simplices] > radius
    return outside.any(axis=1) & ~outside.all(axis=1)


@pytest.mark.parametrize("n", [300, 1000])
def test_few_points_of_a_surface_are_enough_and_it_is_said(n):
    mesh = triangulate(torus().sample(n, np.random.default_rng(5)))
    with pytest.warns(InsideWarning, match="times larger than its door"):
        inside = interior(mesh, ratio=4.0)
    assert overlap(mesh, inside, torus()) > 0.85
    assert euler_characteristic(mesh.simplices[inside]) == torus().euler


def test_a_missing_patch_smaller_than_half_the_object_closes():
    points = torus().sample(8000, np.random.default_rng(13))
    top = np.array([1.0, 0, 0.4])
    for size, closes in [(0.15, True), (0.75, False)]:
        holed = points[np.linalg.norm(points - top, axis=1) > size]
        mesh = triangulate(holed)
        if closes:
            assert overlap(mesh, interior(mesh), torus()) > 0.95
        else:
            with pytest.warns(InsideWarning):
                assert not interior(mesh).any()


def test_noise_keeps_its_shape_and_its_small_rooms_out():
    rng = np.random.default_rng(14)
    points = torus().sample(20_000, rng) + rng.normal(0, 0.015, (20_000, 3))
    mesh = triangulate(points)
    for noise in (0.0, 2.0):
        assert overlap(mesh, interior(mesh, noise=noise), torus()) > 0.9
    with pytest.warns(InsideWarning):
        assert not interior(mesh, noise=100).any()


@pytest.mark.parametrize("cloud", ["plane patch", "volume", "disc with scatter"])
def test_no_inside_is_empty_and_says_why(cloud):
    rng = np.random.default_rng(15)
    points = {"plane patch": np.c_[rng.random((2000, 2)), rng.normal(0, 1e-3, 2000)],
              "volume": rng.random((3000, 3)), "disc with scatter": rng.normal(size=(2000, 2))}[cloud]  # fmt: skip
    with pytest.warns(InsideWarning, match="nothing lies inside.*method 'all'"):
        assert not interior(triangulate(points)).any()


def test_all_and_labels():
    mesh = triangulate(np.random.default_rng(16).random((50, 3)))
    assert interior(mesh, method="all").all()
    labels = np.arange(len(mesh)) % 3
    assert np.array_equal(interior(mesh, method="array", labels=labels), labels > 0)


@pytest.mark.parametrize("labels", [None, [1, 0], ["a"] * 2, "nan"])
def test_bad_labels_are_refused(labels):
    mesh = triangulate([[0, 0], [1, 0], [0, 1], [1.0, 1.1], [2, 3]])
    if labels == "nan":
        labels = np.full(len(mesh), np.nan)
    elif labels is not None and isinstance(labels[0], str):
        labels = ["a"] * len(mesh)
    elif labels is not None:
        labels = labels * len(mesh)
    with pytest.raises(InputError, match="label"):
        interior(mesh, method="array", labels=labels)


@pytest.mark.parametrize("options", [{"method": "rays"}, {"ratio": 0.5}, {"noise": -1}])
def test_options_out_of_bounds_are_refused(options):
    with pytest.raises(InputError, match=next(iter(options))):
        interior(triangulate(np.eye(3)[:, :2]), **options)


@pytest.mark.parametrize("method", ["surface", "outline"])
def test_a_missing_second_input_is_refused(method):
    with pytest.raises(InputError, match="second input"):
        interior(triangulate(np.eye(3)[:, :2]), method=method)


def test_no_points_have_no_inside():
    assert interior(triangulate(np.empty((0, 3)))).shape == (0,)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([2, 3]))
def test_submesh_keeps_cells_and_renumbers_neighbours(seed, dim):
    rng = np.random.default_rng(seed)
    mesh = triangulate(rng.random((40, dim)))
    kept = rng.random(len(mesh)) < 0.6
    part, ids = submesh(mesh, kept), np.flatnonzero(kept)
    assert np.array_equal(part.simplices, mesh.simplices[kept])
    expected = mesh.neighbors[kept]
    there = (expected >= 0) & kept[expected]
    assert np.array_equal(part.neighbors >= 0, there)
    assert np.array_equal(ids[part.neighbors[there]], expected[there])


def test_the_tree_runs_on_the_inside():
    mesh = triangulate(comb().sample(2000, np.random.default_rng(17)))
    part = submesh(mesh, interior(mesh))
    assert len(build_tree(part)) == len(part)
