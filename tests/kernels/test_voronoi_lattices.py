"""Voronoi skeletons where points are exactly cospherical: faces shrink to nothing, vertices lie on the boundary."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from nasty import Nasty
from tetraskel import Triangulation, triangulate, voronoi_skeleton
from tetraskel.kernels.polygon_slabs import BOTTOM, TOP, cut_into_slabs, walls_from
from tetraskel.kernels.voronoi_diagram import voronoi_diagram
from tetraskel.kernels.voronoi_sides import locate
from voronoi_reference import half_spaces, measure_of_sk2, polygon_areas


def lattice(side: int, seed: int, share: float = 1.0) -> tuple[Triangulation, np.ndarray]:
    """Some points of a lattice, and an inside drawn by lot."""
    rng = np.random.default_rng(seed)
    points = np.array(list(product(range(side), repeat=3)), float)
    mesh = triangulate(points[rng.random(len(points)) < share] if share < 1 else points)
    inside = rng.random(len(mesh)) < 0.6
    inside[0] = True
    return mesh, inside


def solid(mesh: Triangulation) -> np.ndarray:
    """Simplices with volume: Qhull fills lattices with some that have none."""
    corners = mesh.points[mesh.simplices]
    return np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) > 1e-9


@pytest.mark.parametrize(
    ("side", "seed", "share"),
    [(3, 0, 1.0), (3, 6, 1.0), (4, 1, 0.6), (4, 5, 0.6), (4, 11, 0.6), (3, 2, 0.6), (3, 8, 0.6), (3, 10, 0.6)],
)
def test_sk2_of_parts_of_lattices_is_what_the_slow_way_finds(side: int, seed: int, share: float) -> None:
    mesh, inside = lattice(side, seed, share)
    found = polygon_areas(voronoi_skeleton(mesh, inside=inside, method="sk2")).sum()
    assert found == pytest.approx(measure_of_sk2(mesh, inside & solid(mesh)), rel=1e-9)


def test_places_are_found_through_flat_simplices() -> None:
    mesh, inside = lattice(4, 3)
    rng = np.random.default_rng(0)
    spots, start = 3 * rng.random((300, 3)), rng.integers(len(mesh), size=300)
    expected = np.zeros(300, bool)
    for cell in np.flatnonzero(inside & solid(mesh)):
        expected |= np.all([spots @ normal <= offset for normal, offset in half_spaces(mesh, cell)], axis=0)
    assert np.array_equal(locate(voronoi_diagram(mesh, inside), start, spots), expected)


def test_a_wall_as_short_as_rounding_divides_no_slab() -> None:
    tiny = 1e-16
    ends = np.array([[[0, 0], [1, 0]], [[0, 1], [1, 1]], [[0, 0.5], [tiny, 0.5]], [[1 - tiny, 0.5], [1, 0.5]]])
    walls = walls_from(np.zeros(4, np.int64), ends, np.array([BOTTOM, TOP, BOTTOM, TOP]))
    _, _, wall, _ = cut_into_slabs(walls, 1)
    assert wall.tolist() == [0, 1]


def test_needles_of_close_samples_are_on_their_side() -> None:
    """Two samples close together: the triangle between them and the far side is flat by its area, yet holds ground."""
    around = np.sort(np.append(np.linspace(0, 2 * np.pi, 40, endpoint=False), [1.0, 1.0 + 1e-7]))
    mesh = triangulate(np.stack([np.cos(around), np.sin(around)], axis=1))
    diagram = voronoi_diagram(mesh, np.ones(len(mesh), bool))
    assert (diagram.signs != 0).all()
    for method in ("sk1", "sk3"):
        assert np.allclose(voronoi_skeleton(mesh, method=method).points, 0, atol=1e-6)


def test_centres_farther_away_than_an_integer_counts_are_outside() -> None:
    """Points that nearly lie on a line, found by fuzzing: the centre of a flat triangle is 1e15 away."""
    mesh = triangulate(Nasty(family="sheet", dim=2, n=21, seed=42022, spoilers=(), layout="as it is").array())
    low, high = mesh.points.min(axis=0) - 1e-9, mesh.points.max(axis=0) + 1e-9
    for method in ("sk1", "sk2", "sk3"):
        points = voronoi_skeleton(mesh, method=method).points
        assert ((points >= low) & (points <= high)).all()
