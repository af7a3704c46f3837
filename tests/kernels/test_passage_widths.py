from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tetraskel import triangulate
from tetraskel.kernels.adjacency import facet_points
from tetraskel.kernels.passage_widths import passage_widths, room_radii, triangle_widths, widths_and_rooms


def squares(*sides):
    return np.array([[float(side) ** 2] for side in sides])


def test_width_of_an_equilateral_triangle_is_its_circumradius():
    assert triangle_widths(squares(3, 3, 3))[0] == pytest.approx(np.sqrt(3), rel=1e-14)


def test_width_of_a_right_triangle_is_half_its_hypotenuse():
    for sides in [(3, 4, 5), (4, 5, 3), (5, 3, 4)]:
        assert triangle_widths(squares(*sides))[0] == pytest.approx(2.5, rel=1e-14)


def test_width_of_a_triangle_without_area_is_half_its_middle_edge():
    assert triangle_widths(squares(1, 2, 3))[0] == pytest.approx(1.0, rel=1e-14)


@settings(max_examples=50, deadline=None)
@given(st.lists(st.floats(0.05, 1), min_size=3, max_size=3), st.integers(0, 2**32 - 1))
def test_width_is_the_farthest_a_point_of_the_triangle_can_be_from_its_corners(scales, seed):
    corners = np.random.default_rng(seed).normal(size=(3, 3)) * np.array(scales)
    edges = corners - np.roll(corners, 1, axis=0)
    width = triangle_widths((edges**2).sum(axis=1)[:, None])[0]
    steps = np.linspace(0, 1, 201)
    u, v = (
        grid[grid_sum <= 1]
        for grid_sum, grid in [
            (steps[:, None] + steps, steps[:, None] + 0 * steps),
            (steps[:, None] + steps, 0 * steps[:, None] + steps),
        ]
    )
    points = corners[0] + u[:, None] * (corners[1] - corners[0]) + v[:, None] * (corners[2] - corners[0])
    farthest = np.linalg.norm(points[:, None] - corners, axis=2).min(axis=1).max()
    spacing = np.linalg.norm(edges, axis=1).max() / 200
    assert farthest <= width * (1 + 1e-9)
    assert width <= farthest + spacing


@pytest.mark.parametrize("dim", [2, 3])
def test_both_sides_of_a_facet_have_equal_widths(dim):
    mesh = triangulate(np.random.default_rng(0).normal(size=(500, dim)))
    widths = passage_widths(mesh.coordinates, mesh.simplices)
    by_facet = {}
    for number, width in enumerate(widths.ravel()):
        facet = tuple(facet_points(mesh.simplices, np.array([number]))[0])
        assert by_facet.setdefault(facet, width) == width


def test_rooms_of_regular_simplices_and_none_in_flat_ones():
    triangle = np.array([[0, 0], [1, 0], [0.5, np.sqrt(3) / 2]])
    assert room_radii(triangle, np.array([[0, 1, 2]]))[0] == pytest.approx(1 / np.sqrt(3), rel=1e-14)
    tetrahedron = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    assert room_radii(tetrahedron, np.array([[0, 1, 2, 3]]))[0] == pytest.approx(np.sqrt(3), rel=1e-14)
    obtuse = np.array([[0, 0], [1, 0], [0.5, 0.1]])
    assert room_radii(obtuse, np.array([[0, 1, 2]]))[0] == 0
    square = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    assert room_radii(square, np.array([[0, 1, 2, 3]]))[0] == 0


@pytest.mark.parametrize("dim", [2, 3])
def test_room_balls_hold_no_point(dim):
    points = np.random.default_rng(1).normal(size=(400, dim))
    mesh = triangulate(points)
    radii = room_radii(mesh.coordinates, mesh.simplices)
    for cell in np.flatnonzero(radii)[:200]:
        corners = mesh.points[mesh.simplices[cell]]
        centre = np.linalg.solve(2 * (corners[1:] - corners[0]), (corners[1:] ** 2 - corners[0] ** 2).sum(axis=1))
        weights = np.linalg.solve(np.vstack([corners.T, np.ones(dim + 1)]), np.append(centre, 1))
        assert weights.min() > -1e-6
        assert np.linalg.norm(points - centre, axis=1).min() == pytest.approx(radii[cell], rel=1e-6)


def test_one_pass_equals_two():
    mesh = triangulate(np.random.default_rng(2).normal(size=(300, 3)))
    widths, rooms = widths_and_rooms(mesh.coordinates, mesh.simplices)
    assert np.array_equal(widths, passage_widths(mesh.coordinates, mesh.simplices))
    assert np.array_equal(rooms, room_radii(mesh.coordinates, mesh.simplices))
