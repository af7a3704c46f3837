"""The exact engine against exact arithmetic, against Qhull, and against itself."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import ConvexHull, Delaunay

from adversarial import FAMILIES
from checks import euler_characteristic
from rationals import assert_delaunay, triangulation_by_definition
from tetraskel import Aborted, EngineError, triangulate
from tetraskel.kernels.adjacency import facet_neighbors
from tetraskel.kernels.compilation import numba_is_used
from tetraskel.kernels.points import morton_order

if not numba_is_used():
    pytest.skip("the exact engine needs numba (the extra fast)", allow_module_level=True)

from tetraskel.kernels.exact import engine
from tetraskel.kernels.exact.start import first_simplex

SETS = 70  # of each family and dimension: 2,100 in all


def as_sets(simplices):
    return {frozenset(row) for row in simplices.tolist()}


def sorted_rows(simplices):
    rows = np.sort(simplices, axis=1)
    return rows[np.lexsort(rows.T)]


def lattice(n, dim):
    return np.stack(np.meshgrid(*[np.arange(float(n))] * dim), -1).reshape(-1, dim)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("family", FAMILIES)
def test_adversarial_sets_in_exact_arithmetic(family, dim):
    """Spheres empty, orientation positive, neighbours mutual, hull filled; the same from any order and seed."""
    flat = 0
    for seed in range(SETS):
        rng = np.random.default_rng(seed)
        points = np.unique(FAMILIES[family](rng, dim) + 0.0, axis=0)
        points = points[morton_order(points)]
        simplices, neighbors, _ = engine.delaunay(points)
        if len(simplices) == 0:
            assert first_simplex(points) is None
            flat += 1
            continue
        assert_delaunay(points, simplices, neighbors)
        shuffle = rng.permutation(len(points))
        permuted, _, _ = engine.delaunay(points[shuffle], seed=seed)
        assert as_sets(shuffle[permuted]) == as_sets(simplices)
        again, again_neighbors, _ = engine.delaunay(points, seed=seed)
        assert np.array_equal(again, simplices)
        assert np.array_equal(again_neighbors, neighbors)
    assert flat < SETS / 4


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("family", ["lattice", "one_sphere", "centred_lattice", "line_and_others", "plane_and_apex"])
def test_ties_are_settled_as_tiny_heights_would_settle_them(family, dim):
    for seed in range(8):
        points = FAMILIES[family](np.random.default_rng(seed), dim)
        points = np.unique(points[:9] if family == "line_and_others" else points[-8:], axis=0)
        if first_simplex(points) is not None:
            assert as_sets(engine.delaunay(points)[0]) == triangulation_by_definition(points)


@pytest.mark.parametrize(("n", "dim"), [(10_000, 3), (100_000, 3), (100_000, 2)])
def test_generic_clouds_have_the_simplices_of_qhull(n, dim):
    points = np.random.default_rng(0).random((n, dim))
    points = points[morton_order(points)]
    simplices, neighbors, stands_for = engine.delaunay(points)
    assert np.array_equal(sorted_rows(simplices), sorted_rows(Delaunay(points).simplices))
    assert np.array_equal(neighbors, facet_neighbors(simplices))
    assert np.array_equal(stands_for, np.arange(n))


@pytest.mark.parametrize("kind", ["lattice", "decimal lattice", "turned lattice", "sphere", "surface", "clusters"])
def test_larger_sets(kind):
    """Every point used, Euler's relation, neighbours, hull and volume; the same from any order and seed."""
    rng = np.random.default_rng(0)
    directions = rng.normal(size=(3000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    points = {
        "lattice": lattice(13, 3),
        "decimal lattice": lattice(13, 3) * 0.1,
        "turned lattice": lattice(13, 3) @ np.linalg.qr(rng.normal(size=(3, 3)))[0],
        "sphere": directions,
        "surface": directions * [3, 2, 1] * rng.normal(1, 1e-3, (3000, 1)),
        "clusters": np.concatenate([rng.random((1500, 3)), 0.3 + 1e-9 * rng.random((1500, 3))]),
    }[kind]
    mesh = triangulate(points, engine="exact")
    shuffle = rng.permutation(len(points))
    assert np.array_equal(shuffle[triangulate(points[shuffle], engine="exact").simplices], mesh.simplices)
    assert set(mesh.simplices.ravel().tolist()) == set(range(len(points)))
    assert np.array_equal(mesh.neighbors, facet_neighbors(mesh.simplices))
    assert euler_characteristic(mesh.simplices) == 1
    corners = points[mesh.simplices]
    volumes = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
    assert volumes.sum() == pytest.approx(ConvexHull(points).volume, rel=1e-9)
    if kind == "lattice":
        assert volumes.min() > 0.1  # no tetrahedron without volume


@pytest.mark.parametrize("dim", [2, 3])
def test_the_hull_has_the_facets_of_convexhull(dim):
    points = np.random.default_rng(1).normal(size=(2000, dim))
    points = points[morton_order(points)]
    simplices, neighbors, _ = engine.delaunay(points)
    cells, opposite = np.nonzero(neighbors < 0)
    facets = [np.delete(simplices[c], k) for c, k in zip(cells, opposite, strict=True)]
    assert as_sets(np.array(facets)) == as_sets(ConvexHull(points).simplices)


def test_simplices_come_in_an_order_that_only_the_points_decide():
    points = np.random.default_rng(2).random((500, 3))
    simplices, _, _ = engine.delaunay(points)
    assert (simplices[:, 0] == simplices.min(axis=1)).all()
    assert (simplices[:, 1] == np.sort(simplices, axis=1)[:, 1]).all()
    assert np.array_equal(np.lexsort(simplices.T[::-1]), np.arange(len(simplices)))


@pytest.mark.parametrize("dim", [2, 3])
def test_equal_points_get_one_vertex(dim):
    points = np.random.default_rng(3).integers(0, 4, (60, dim)).astype(float)
    simplices, neighbors, stands_for = engine.delaunay(points)
    distinct = np.unique(points, axis=0)
    used = np.unique(simplices)
    assert len(used) == len(distinct)
    assert np.array_equal(np.unique(stands_for), used)
    assert np.array_equal(points[stands_for], points)
    assert np.array_equal(neighbors, facet_neighbors(simplices))


def test_a_point_that_sees_a_hull_of_thousands_of_facets():
    """A star too large for the table of pairs, and cavities that outgrow their arrays."""
    rng = np.random.default_rng(4)
    directions = rng.normal(size=(4000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    points = np.concatenate([directions, [[0, 0, 0], [0, 0, 1000]]])
    simplices, neighbors, _ = engine.delaunay(points)
    assert np.bincount(simplices.ravel())[4000] > 4000
    assert np.array_equal(neighbors, facet_neighbors(simplices))
    assert euler_characteristic(simplices) == 1


def test_two_lines_that_make_quadratically_many_cells():
    n = 120
    lines = np.zeros((2 * n, 3))
    lines[:n, 0] = lines[n:, 1] = np.arange(n)
    lines[n:, 2] = 1
    simplices, neighbors, _ = engine.delaunay(lines)
    assert len(simplices) == (n - 1) ** 2
    assert np.array_equal(neighbors, facet_neighbors(simplices))


@pytest.mark.parametrize(
    "points",
    [
        np.zeros((1, 3)),
        lattice(3, 2),
        np.c_[np.arange(9.0), 2 * np.arange(9.0)],
        np.outer(np.arange(7.0), [1, 2, 3]),
        np.c_[lattice(4, 2), lattice(4, 2).sum(axis=1)],
    ],
)
def test_points_that_do_not_span_have_no_simplices(points):
    if points.shape == (9, 2) and first_simplex(points) is not None:
        assert len(engine.delaunay(points)[0]) == 8
    else:
        assert len(engine.delaunay(points)[0]) == 0


@pytest.mark.parametrize("scale", [1e-160, 1e-60, 1.0, 1e60, 1e99])
def test_scale_does_not_matter(scale):
    points = np.random.default_rng(5).random((60, 3))
    assert np.array_equal(
        triangulate(points * scale, engine="exact").simplices, triangulate(points, engine="exact").simplices
    )


def test_tiny_coordinates_beside_huge_ones_are_refused_where_doubles_end():
    points = np.random.default_rng(6).random((10, 3))
    points[:, 0] *= 1e99
    points[3] = 1e-300, 0.5, 0.5
    with pytest.raises(EngineError, match="sizes differ by a factor of less than 1e300"):
        triangulate(points, engine="exact")


def test_too_many_cells_are_an_error(monkeypatch):
    monkeypatch.setattr(engine, "LARGEST_CELLS", 2000)
    with pytest.raises(EngineError, match="holds 2000 cells, and 1000 points need more"):
        engine.delaunay(np.random.default_rng(7).random((1000, 3)))


@pytest.mark.parametrize("dim", [2, 3])
def test_what_lies_in_fresh_memory_does_not_matter(dim, monkeypatch):
    """Arrays that grow several times, and hold numbers of insertions to come where nothing was written yet."""
    points = np.random.default_rng(9).random((1500, dim))
    expected = engine.delaunay(points)
    monkeypatch.setattr(engine, "CELLS_PER_POINT", {2: 0, 3: 0})
    monkeypatch.setattr(
        engine.np, "empty", lambda shape, kind=float: np.arange(np.prod(shape)).reshape(shape).astype(kind)
    )
    for found, right in zip(engine.delaunay(points), expected, strict=True):
        assert np.array_equal(found, right)


def test_insertion_is_told_of_and_stopped():
    shares = []

    def tick(share):
        shares.append(share)
        if share > 0.3:
            raise Aborted("enough")

    with pytest.raises(Aborted):
        triangulate(np.random.default_rng(8).random((60_000, 3)), engine="exact", tick=tick)
    assert shares == sorted(shares)
    assert shares[-1] < 0.9
