"""All skeletons of one object: closed forms in the plane, equality with each method and with `measure`, failures."""

from __future__ import annotations

import numpy as np
import pytest

from shapes import on_sphere
from tetraskel import (
    Aborted,
    InputError,
    compare,
    curve_skeleton,
    interior,
    measure,
    triangulate,
    triangulation_of,
    voronoi_skeleton,
)
from tetraskel import comparison as comparing
from tetraskel.kernels.drawn import SHEETS, Drawn, drawn_lines
from tetraskel.kernels.drawn_measures import MEASURES, distances_to_union, judge
from tetraskel.kernels.object_boundary import Boundary, boundary_of, given_boundary, object_numbers
from tetraskel.options import COMPARED
from tubes import torus

RECTANGLE = np.array([[0, 0], [1, 0], [2.5, 0], [4, 0], [4, 2], [3, 2], [1.5, 2], [0, 2]])
SQUARE = Boundary(np.array([[0.0, 0], [2, 0], [2, 2], [0, 2]]), np.array([[0, 1], [1, 2], [2, 3], [3, 0]]))
CUBE_CORNERS = np.array([[x, y, z] for x in (0.0, 2.0) for y in (0.0, 2.0) for z in (0.0, 2.0)])
CUBE_SIDES = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
CUBE = Boundary(CUBE_CORNERS, np.concatenate([CUBE_SIDES[:, [0, 1, 2]], CUBE_SIDES[:, [0, 2, 3]]]))


def ring(n=160):
    angles = np.linspace(0, 2 * np.pi, n, endpoint=False)
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return np.concatenate([circle, 0.6 * circle])


class TestMeasures:
    def test_the_middle_line_of_a_square(self):
        line = drawn_lines(np.array([[0.5, 1.0], [1.5, 1.0]]), np.array([1.0, 1.0]), np.array([[0, 1]]))
        found = judge(line, line.points, SQUARE)
        assert (found["components"], found["loops"], found["euler"], found["ends"]) == (1, 0, 1, 2)
        assert (found["length"], found["inside"], found["area"]) == (1.0, 1.0, None)
        # below the left end the nearest side is the left one: a = x, b = 2 - x for x up to 1
        x = np.linspace(0.5, 1, 100001)
        assert found["centredness"] == pytest.approx(2 * (x / 2).mean(), rel=2e-3)
        # of the boundary only what is near the corners lies outside of the balls
        assert found["reconstruction_max"] == pytest.approx(100 * (np.hypot(0.5, 1) - 1) / np.hypot(2, 2), rel=1e-2)

    def test_half_of_a_line_outside(self):
        line = drawn_lines(np.array([[1.0, 1.0], [3.0, 1.0]]), np.ones(2), np.array([[0, 1]]))
        assert judge(line, line.points, SQUARE)["inside"] == pytest.approx(0.5, abs=1e-3)

    def test_a_cross_with_a_short_arm(self):
        tips = [[0, 0], [0.1, 0], [0, 0.8], [-0.8, 0], [0, -0.8]]
        cross = drawn_lines(np.array(tips) + 1.0, np.full(5, 0.2), np.array([[0, k] for k in range(1, 5)]))
        found = judge(cross, cross.points, SQUARE)
        assert (found["ends"], found["junctions"], found["branches"]) == (4, 1, 4)
        assert found["short_branches"] == pytest.approx(0.1 / 2.5)

    def test_a_sheet_midway_in_a_cube(self):
        points = np.array([[0.5, 0.5, 1], [1.5, 0.5, 1], [1.5, 1.5, 1], [0.5, 1.5, 1.0]])
        sheet = Drawn(SHEETS, points, np.ones(4), np.empty((0, 2), int), np.array([0, 4]), np.arange(4))
        found = judge(sheet, points, CUBE)
        assert (found["area"], found["inside"], found["euler"]) == (1.0, 1.0, 1)
        assert found["ends"] is found["loops"] is found["length"] is None

    def test_area_of_a_polygon_with_a_dent(self):
        points = np.array([[1.0, 1.9, 1], [0.1, 0.1, 1], [1, 1.0, 1], [1.9, 0.1, 1]])
        start_outside = np.roll(np.arange(4), -1)  # the fan from this corner turns one triangle over
        dented = Drawn(SHEETS, points, np.ones(4), np.empty((0, 2), int), np.array([0, 4]), start_outside)
        x, y = points[:, :2].T
        shoelace = abs((x * np.roll(y, -1) - y * np.roll(x, -1)).sum()) / 2
        assert judge(dented, points, CUBE)["area"] == pytest.approx(shoelace)

    def test_distances_to_balls_are_those_of_all_pairs(self):
        rng = np.random.default_rng(3)
        centres, radii, places = rng.random((500, 3)), rng.random(500) ** 4 * 0.2, 2 * rng.random((400, 3))
        slow = (np.linalg.norm(places[:, None] - centres, axis=2) - radii).min(axis=1)
        assert np.allclose(distances_to_union(centres, radii, places), np.maximum(slow, 0), atol=1e-12)

    def test_a_segment_in_the_plane_is_as_near_as_it_is(self):
        places = np.random.default_rng(5).random((200, 2)) * 2
        near = np.minimum(places, 2 - places).min(axis=1)
        assert np.allclose(SQUARE.centredness(places), near)  # 2a / (a + b), and a + b = 2
        assert np.allclose(np.abs(SQUARE.samples(400) - 1).max(axis=1), 1)


class TestObject:
    def test_euler_characteristic_of_a_ring_and_a_ball(self):
        mesh = triangulate(ring())
        assert object_numbers(mesh, interior(mesh)) == {"components": 1, "euler": 0}
        ball = triangulate(on_sphere(200, np.random.default_rng(1)))
        assert object_numbers(ball, np.ones(len(ball), bool)) == {"components": 1, "euler": 1}

    def test_the_boundary_is_closed(self):
        mesh = triangulate(torus().sample(3000))
        facets = boundary_of(mesh, interior(mesh)).facets
        sides = np.sort(np.concatenate([facets[:, [0, 1]], facets[:, [1, 2]], facets[:, [2, 0]]]), axis=1)
        assert (np.unique(sides, axis=0, return_counts=True)[1] % 2 == 0).all()


class TestCompare:
    def test_a_ring_in_the_plane(self):
        rows = {row.method: row for row in compare(ring(), resolution=64)}
        assert tuple(rows) == COMPARED
        for name in ("curve", "bezier", "sk3"):
            assert (rows[name].measures["loops"], rows[name].measures["components"]) == (1, 1)
            assert rows[name].measures["inside"] == 1.0
        assert rows["tree"].measures["loops"] == 0  # a tree has none
        assert rows["curve"].measures["length"] == pytest.approx(2 * np.pi * 0.8, rel=0.01)
        assert rows["sk1"].kind == rows["morphological"].kind == "points"
        assert rows["sk1"].measures["loops"] is None
        assert {row.judged_by for row in rows.values()} == {"boundary"}

    def test_a_plane_in_space_gives_the_same(self):
        flat = ring()
        tilted = flat @ np.array([[0.6, 0.0, 0.8], [0.0, 1.0, 0.0]])
        for one, other in zip(compare(flat, methods="curve,sk3"), compare(tilted, methods="curve,sk3"), strict=True):
            assert other.drawn.points.shape[1] == 3
            for name in ("loops", "euler", "ends"):
                assert other.measures[name] == one.measures[name]
            assert other.measures["length"] == pytest.approx(one.measures["length"], rel=1e-6)

    def test_rows_are_the_methods_and_the_curve_is_measured_as_by_measure(self):
        mesh = triangulate(torus().sample(2500))
        inside = interior(mesh)
        boundary = boundary_of(mesh, inside)
        surface = (boundary.vertices, boundary.facets)
        curve, sk3, tree = compare(mesh, surface, inside=inside, methods=["curve", "sk3", "tree"])
        assert curve.judged_by == "surface"
        expected = curve_skeleton(mesh, inside=inside)
        assert np.array_equal(curve.drawn.points, expected.points)
        for name, value in measure(expected, surface).items():
            assert curve.measures[name] == pytest.approx(value, rel=1e-9), name
        assert np.array_equal(sk3.drawn.points, voronoi_skeleton(mesh, inside=inside, method="sk3").points)
        drawn = sk3.drawn
        assert sk3.measures["euler"] == len(drawn) - len(drawn.all_edges) + len(drawn.offsets) - 1
        assert object_numbers(mesh, inside)["euler"] == 0
        assert sk3.measures["inside"] > 0.99
        assert tree.measures["centredness"] < curve.measures["centredness"]

    def test_an_outline_is_judged_by(self):
        outline = (RECTANGLE, np.stack([np.arange(8), (np.arange(8) + 1) % 8], axis=1))
        mesh = triangulate(RECTANGLE)
        (given,) = compare(mesh, outline, inside=np.ones(len(mesh)), methods="sk4")
        (own,) = compare(mesh, inside=np.ones(len(mesh)), methods="sk4")
        assert (given.judged_by, own.judged_by) == ("surface", "boundary")
        assert given.measures["centredness"] == pytest.approx(own.measures["centredness"])

    def test_a_mesh_of_others_is_all_inside(self):
        mesh = triangulate(RECTANGLE)
        (row,) = compare(triangulation_of(mesh.points, mesh.simplices), methods="sk1")
        assert row.measures["points"] == 6


class TestFailures:
    def test_a_method_that_fails_is_a_row(self, monkeypatch):
        def broken(*_):
            raise ZeroDivisionError("by\nzero")

        def missing(*_):
            raise InputError("expected more.")

        monkeypatch.setitem(comparing.DRAWERS, "tree", broken)
        monkeypatch.setitem(comparing.DRAWERS, "sk1", missing)
        tree, sk1, sk4 = compare(ring(), methods="tree,sk1,sk4")
        assert (tree.failure, tree.kind, tree.drawn) == ("ZeroDivisionError: by zero", "", None)
        assert sk1.failure == "expected more."
        assert tree.measures == dict.fromkeys(MEASURES)
        assert sk4.failure == ""

    def test_it_can_be_stopped(self):
        def stop(share):
            if share > 0.3:
                raise Aborted("stopped.")

        with pytest.raises(Aborted):
            compare(ring(), methods="sk1,sk3,sk4", tick=stop)

    def test_stopping_inside_a_method_is_no_row(self, monkeypatch):
        def stopped(*_):
            raise Aborted("stopped.")

        monkeypatch.setitem(comparing.DRAWERS, "sk1", stopped)
        with pytest.raises(Aborted):
            compare(ring(), methods="sk1")

    @pytest.mark.parametrize("methods", ["curve,nosuch", "", "curve,,tree", ["Curve"]])
    def test_unknown_methods(self, methods):
        with pytest.raises(InputError, match=r"methods must be all or some of curve, tree, sk1"):
            compare(ring(), methods=methods)

    def test_nothing_inside(self):
        mesh = triangulate(RECTANGLE)
        with pytest.raises(InputError, match="expected an object with an inside, got none of 6 cells"):
            compare(mesh)

    @pytest.mark.parametrize(
        ("surface", "told"),
        [
            ((RECTANGLE, np.empty((0, 2), int)), r"segments of a closed outline \(s, 2\), got \(0, 2\)"),
            ((RECTANGLE, np.array([[0, 1, 2]])), r"segments of a closed outline \(s, 2\), got \(1, 3\)"),
            ((np.zeros((4, 3)), np.array([[0, 1]])), r"expected finite points with 2 coordinates .* got \(4, 3\)"),
            ((RECTANGLE * np.nan, np.array([[0, 1]])), "expected finite points"),
            ((RECTANGLE, np.array([[0, 8]])), r"expected point ids from 0 to 7 .* got 0 to 8"),
        ],
    )
    def test_a_surface_that_does_not_fit(self, surface, told):
        with pytest.raises(InputError, match=told):
            given_boundary(triangulate(RECTANGLE), surface)
