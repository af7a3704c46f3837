"""Voronoi skeletons: closed forms, the slow way, inclusion, Euler characteristic, relations, simplification."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from checks import euler_characteristic
from shapes import FLATS, SOLIDS
from tetraskel import InputError, Triangulation, VoronoiSkeleton, interior, triangulate, voronoi_skeleton
from tetraskel.kernels.barycentric import barycentric_coordinates
from tetraskel.kernels.medial_nodes import circumcentres
from tetraskel.kernels.voronoi_crossings import find_crossings
from tetraskel.kernels.voronoi_diagram import voronoi_diagram
from tetraskel.kernels.voronoi_sides import locate, plain_edges, vertices_inside
from voronoi_reference import half_spaces, line_lengths, measure_of_sk2, polygon_areas

METHODS = ("sk1", "sk2", "sk3", "sk4")
RECTANGLE = [[0, 0], [1, 0], [2.5, 0], [4, 0], [4, 2], [3, 2], [1.5, 2], [0, 2]]
CUBE = np.array(list(product((0.0, 1.0), repeat=3)))
TETRAHEDRON = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])


def rows(points):
    """Points in lexicographic order, rounded: equal for equal sets."""
    points = np.round(np.asarray(points, float), 9) + 0.0
    return points[np.lexsort(points.T[::-1])]


def euler(skeleton: VoronoiSkeleton) -> int:
    """Vertices - edges + faces of all that is drawn."""
    after = np.arange(1, len(skeleton.connectivity) + 1)
    after[skeleton.offsets[1:] - 1] = skeleton.offsets[:-1]
    sides = np.stack([skeleton.connectivity, skeleton.connectivity[after]], axis=1).reshape(-1, 2)
    edges = np.unique(np.sort(np.concatenate([skeleton.lines, sides]), axis=1), axis=0)
    return len(skeleton) - len(edges) + skeleton.n_polygons


class TestClosedForms:
    def test_the_rectangle_of_the_paper(self) -> None:
        mesh = triangulate(RECTANGLE)
        # of a triangle with a gap from u to v on one side and its apex w on the other: above the middle x of the gap,
        # in the height 1 + ((x - w)^2 - (x - u)^2) / 4
        centres = np.array([[0.5, 1], [0.75, 1.125], [1.75, 0.875], [2.25, 1.125], [3.25, 0.875], [3.5, 1]])
        axis = np.linalg.norm(np.diff(centres, axis=0), axis=1).sum()
        for method in ("sk1", "sk3", "sk4"):
            assert np.allclose(rows(voronoi_skeleton(mesh, method=method).points), centres)
        for method in ("sk3", "sk4"):
            assert line_lengths(voronoi_skeleton(mesh, method=method)).sum() == pytest.approx(axis)
        whole = voronoi_skeleton(mesh, method="sk2")
        # and from each centre a spike to the middle of its gap; from the outer two one to the short sides
        assert line_lengths(whole).sum() == pytest.approx(axis + 2 * 1 + 4 * 0.875 + 2 * 0.5)
        assert whole.radius.min() == pytest.approx(0.5)
        assert np.allclose(whole.radius[(whole.points == [0, 1]).all(axis=1)], 1)

    @pytest.mark.parametrize("n", [3, 5, 6, 12])
    def test_regular_polygons(self, n: int) -> None:
        angles = 2 * np.pi * np.arange(n) / n
        mesh = triangulate(np.stack([np.cos(angles), np.sin(angles)], axis=1))
        for method in ("sk1", "sk3"):
            skeleton = voronoi_skeleton(mesh, method=method)
            assert np.allclose(skeleton.points, [[0, 0]], atol=1e-9)
            assert np.allclose(skeleton.radius, 1)
        star = voronoi_skeleton(mesh, method="sk2")
        assert len(star.lines) == n
        assert np.allclose(line_lengths(star), np.cos(np.pi / n))
        assert len(voronoi_skeleton(mesh, method="sk4")) == len(mesh) == n - 2

    def test_the_regular_tetrahedron(self) -> None:
        mesh = triangulate(TETRAHEDRON)
        for method in ("sk1", "sk3", "sk4"):
            skeleton = voronoi_skeleton(mesh, method=method)
            assert np.allclose(skeleton.points, [[0, 0, 0]])
            assert np.allclose(skeleton.radius, np.sqrt(3))
        sheets = voronoi_skeleton(mesh, method="sk2")
        # six kites between the centre, the middle of an edge and the centres of the triangles beside it
        assert np.allclose(np.diff(sheets.offsets), 4)
        assert np.allclose(polygon_areas(sheets), np.sqrt(2) / 3)
        assert len(sheets) == 1 + 6 + 4

    def test_a_tetrahedron_whose_centre_lies_outside(self) -> None:
        mesh = triangulate([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
        assert [len(voronoi_skeleton(mesh, method=m)) for m in ("sk1", "sk3")] == [0, 0]
        assert np.allclose(voronoi_skeleton(mesh, method="sk4").points, [[0.5, 0.5, 0.5]])
        assert np.allclose(polygon_areas(voronoi_skeleton(mesh, method="sk2")), [1 / 8] * 3)

    def test_the_cube(self) -> None:
        mesh = triangulate(CUBE)
        for method in ("sk1", "sk3"):
            assert np.allclose(voronoi_skeleton(mesh, method=method).points, [[0.5, 0.5, 0.5]])
        sheets = voronoi_skeleton(mesh, method="sk2")
        # the three planes in the middle, each in four squares: centre, centres of faces, middles of edges
        assert np.allclose(polygon_areas(sheets), [0.25] * 12)
        expected = [p for p in product((0, 0.5, 1), repeat=3) if 0.5 in p]
        assert np.allclose(rows(sheets.points), rows(expected))
        assert euler(voronoi_skeleton(mesh, method="sk4")) == 1

    def test_a_face_that_has_no_corner_in_the_object(self) -> None:
        """Near its tip a needle is divided by one plane between the tip and one other corner."""
        mesh = triangulate([[0, 0, 0], [-1, 0.1, 0], [-1, 0, 0.1], [10, 0.2, 0.1]])
        sheets = voronoi_skeleton(mesh, method="sk2")
        middle = np.flatnonzero(np.abs(sheets.points[:, 0] - 5) < 0.2)
        assert len(middle) >= 3
        assert polygon_areas(sheets).sum() == pytest.approx(measure_of_sk2(mesh, [True]), rel=1e-9)


@pytest.mark.parametrize("seed", range(8))
def test_sk2_is_what_the_slow_way_finds(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mesh = triangulate(rng.random((11, 2 + seed % 2)))
    inside = rng.random(len(mesh)) < 0.6
    inside[0] = True
    skeleton = voronoi_skeleton(mesh, inside=inside, method="sk2")
    found = polygon_areas(skeleton).sum() if mesh.dim == 3 else line_lengths(skeleton).sum()
    assert found == pytest.approx(measure_of_sk2(mesh, inside), rel=1e-9)


def test_sk1_of_a_lattice_is_the_middles_of_its_cells() -> None:
    mesh = triangulate(np.array(list(product(range(4), repeat=3)), float))
    centres = voronoi_skeleton(mesh, method="sk1")
    assert np.allclose(rows(centres.points), rows(np.array(list(product((0.5, 1.5, 2.5), repeat=3)))))


def test_sk2_of_a_lattice_is_the_planes_between_its_points() -> None:
    mesh = triangulate(np.array(list(product(range(4), repeat=3)), float))
    sheets = voronoi_skeleton(mesh, method="sk2")
    assert polygon_areas(sheets).sum() == pytest.approx(3 * 3 * 9)  # three planes each way of 3 by 3


def test_in_general_position_all_crossings_are_known() -> None:
    """Then each crossing is there once, entering and leaving by turns; walks are left to edges of flat simplices."""
    mesh, inside = labelled(SOLIDS["torus"](), 2000)
    diagram = voronoi_diagram(mesh, inside)
    crossings = find_crossings(diagram)
    assert crossings.sure.all()
    assert plain_edges(diagram, crossings, vertices_inside(diagram, crossings)).mean() > 0.999


def labelled(shape, n: int) -> tuple[Triangulation, np.ndarray]:
    """The mesh of random points of a shape, and its inside by the shape."""
    mesh = triangulate(shape.sample(n, np.random.default_rng(3)))
    return mesh, shape.contains(mesh.points[mesh.simplices].mean(axis=1))


def contained(mesh: Triangulation, inside, places, tolerance: float = 1e-9):
    """Whether places lie in the object, each simplex of it asked."""
    found = np.zeros(len(places), bool)
    for cell in np.flatnonzero(inside):
        planes = list(half_spaces(mesh, cell))
        found |= np.all([places @ normal <= offset + tolerance for normal, offset in planes], axis=0)
    return found


@pytest.mark.parametrize("shape", [FLATS["comb"](), FLATS["letters"](), SOLIDS["torus"](), SOLIDS["bottle"]()])
def test_sk1_lies_in_sk3_and_sk3_in_sk2_and_sk2_in_the_object(shape) -> None:
    mesh, inside = labelled(shape, 300)
    first, second, third = (voronoi_skeleton(mesh, inside=inside, method=m) for m in ("sk1", "sk2", "sk3"))
    assert set(map(tuple, first.points)) <= set(map(tuple, third.points))
    assert set(map(tuple, third.points)) <= set(map(tuple, second.points))
    assert contained(mesh, inside, first.points).all()

    def cells(skeleton):
        bounds = zip(skeleton.offsets[:-1], skeleton.offsets[1:], strict=True)
        rings = [skeleton.connectivity[a:b] for a, b in bounds]
        return {frozenset(map(tuple, skeleton.points[ring])) for ring in [*rings, *skeleton.lines]}

    if mesh.dim == 2:
        assert cells(third) <= cells(second)
        middles = second.points[second.lines].mean(axis=1)
    else:
        of_polygons = cells(third) - {frozenset(map(tuple, third.points[line])) for line in third.lines}
        assert of_polygons <= cells(second)
        on_sides = {frozenset(side) for ring in _rings(second) for side in zip(ring, [*ring[1:], ring[0]], strict=True)}
        for line in third.lines:  # edges of no whole face bound faces that are cut
            assert frozenset(map(tuple, third.points[line])) in on_sides
        firsts = second.connectivity[second.offsets[:-1]]
        afters = second.connectivity[second.offsets[:-1] + 1]
        middles = (second.points[firsts] + second.points[afters]) / 2
    assert contained(mesh, inside, middles, 1e-7).all()
    assert len(second.lines) + second.n_polygons > len(third.lines) + third.n_polygons > 0


def _rings(skeleton):
    for k in range(skeleton.n_polygons):
        yield list(map(tuple, skeleton.points[skeleton.connectivity[skeleton.offsets[k] : skeleton.offsets[k + 1]]]))


def test_sk4_has_the_euler_characteristic_of_the_object() -> None:
    angles = 2 * np.pi * np.arange(60) / 60
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    objects = [(circle, 1), (np.concatenate([circle, 0.6 * circle]), 0), (CUBE, 1), (TETRAHEDRON, 1)]
    for points, expected in objects:
        mesh = triangulate(points)
        middles = mesh.points[mesh.simplices].mean(axis=1)
        inside = np.ones(len(mesh), bool)
        if len(points) == 120:
            inside = np.linalg.norm(middles, axis=1) > 0.6 * np.cos(np.pi / 60) - 1e-9
        assert euler(voronoi_skeleton(mesh, inside=inside, method="sk4")) == expected
        assert euler_characteristic(mesh.simplices[inside]) == expected


@pytest.mark.parametrize("name", ["comb", "letters", "torus", "ball", "two_balls", "shell"])
def test_points_within_the_object_are_cells_that_sk4_leaves_out(name: str) -> None:
    shape = (FLATS | SOLIDS)[name]()
    mesh = triangulate(shape.sample(4000, np.random.default_rng(1)))
    inside = interior(mesh)
    outer = np.zeros(len(mesh.points), bool)
    cells, opposite = np.nonzero(inside[:, None] & ~np.append(inside, False)[mesh.neighbors])
    for k in range(mesh.dim + 1):
        outer[mesh.simplices[cells[opposite != k], k]] = True
    used = np.zeros(len(mesh.points), bool)
    used[mesh.simplices[inside]] = True
    sign = 1 if mesh.dim == 2 else -1  # areas around them in the plane, volumes in space
    skeleton = voronoi_skeleton(mesh, inside=inside, method="sk4")
    assert euler(skeleton) + sign * np.count_nonzero(used & ~outer) == shape.euler


@pytest.mark.parametrize("dim", [2, 3])
def test_vertices_are_on_the_side_a_walk_finds(dim: int) -> None:
    shape = FLATS["comb"]() if dim == 2 else SOLIDS["torus"]()
    mesh, inside = labelled(shape, 1500)
    diagram = voronoi_diagram(mesh, inside)
    found = vertices_inside(diagram, find_crossings(diagram))[: len(mesh)]
    assert np.array_equal(found, locate(diagram, np.arange(len(mesh)), diagram.positions[: len(mesh)]))


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("dim", [2, 3])
def test_radii_are_distances_to_the_nearest_point(method: str, dim: int) -> None:
    from scipy.spatial import KDTree

    mesh = triangulate(np.random.default_rng(0).random((200, dim)))
    skeleton = voronoi_skeleton(mesh, method=method)
    assert np.allclose(KDTree(mesh.points).query(skeleton.points)[0], skeleton.radius, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("dim", [2, 3])
def test_moved_scaled_and_permuted_points_give_the_same(method: str, dim: int) -> None:
    rng = np.random.default_rng(2)
    points = rng.random((150, dim))
    turn = np.linalg.qr(rng.normal(size=(dim, dim)))[0]
    plain = voronoi_skeleton(triangulate(points), method=method)
    moved = voronoi_skeleton(triangulate(1000 * points @ turn.T + 7), method=method)
    shuffled = voronoi_skeleton(triangulate(points[rng.permutation(150)]), method=method)
    back = (moved.points - 7) @ turn / 1000
    near = np.abs(plain.points).max(axis=1) < 10  # centres of flat simplices are far away and move with rounding
    assert (moved.n_polygons, len(moved.lines)) == (plain.n_polygons, len(plain.lines))
    assert (shuffled.n_polygons, len(shuffled.lines)) == (plain.n_polygons, len(plain.lines))
    if (method, dim) == ("sk2", 3):  # rounding decides which corners of cut faces are one point
        for other, scale in ((moved, 1000), (shuffled, 1)):
            assert np.allclose(np.sort(polygon_areas(other)), np.sort(polygon_areas(plain)) * scale**2, atol=1e-9)
        return
    assert np.allclose(np.sort(moved.radius[np.abs(back).max(axis=1) < 10]), np.sort(1000 * plain.radius[near]))
    assert np.allclose(rows(shuffled.points), rows(plain.points))


def test_triangles_in_space_are_lifted() -> None:
    flat = voronoi_skeleton(triangulate(RECTANGLE), method="sk2")
    lifted = voronoi_skeleton(triangulate(np.column_stack([RECTANGLE, np.full(8, 3.0)])), method="sk2")
    assert np.allclose(lifted.points[:, :2], flat.points)
    assert (lifted.points[:, 2] == 3).all()


class TestSimplification:
    @pytest.mark.parametrize("method", METHODS)
    @pytest.mark.parametrize("option", [{"least_separation": 0.1}, {"least_angle": 100.0}])
    def test_what_is_left_was_there_and_is_wide_enough(self, method: str, option: dict) -> None:
        mesh, inside = labelled(SOLIDS["torus"](), 3000)
        whole = voronoi_skeleton(mesh, inside=inside, method=method)
        less = voronoi_skeleton(mesh, inside=inside, method=method, **option)
        assert 0 < len(less) < len(whole)
        assert set(map(tuple, less.points)) <= set(map(tuple, whole.points))
        diagonal = np.linalg.norm(np.ptp(mesh.points, axis=0))
        assert less.separation.min() >= option.get("least_separation", 0) * diagonal
        assert less.angle.min() >= option.get("least_angle", 0)

    def test_spikes_of_the_rectangle_go_and_its_axis_stays(self) -> None:
        mesh = triangulate(RECTANGLE)
        axis = voronoi_skeleton(mesh, method="sk2", least_separation=0.4)  # of sqrt(20): gaps are 1.5 at most
        assert np.allclose(axis.points[:, 1], 1, atol=0.13)
        assert np.ptp(axis.points[:, 0]) == pytest.approx(4)
        across = voronoi_skeleton(mesh, method="sk2", least_angle=100)
        assert np.allclose(across.points[:, 1], 1, atol=0.13)

    def test_the_middle_of_a_tube_is_left(self) -> None:
        mesh, inside = labelled(SOLIDS["torus"](), 3000)
        tube = voronoi_skeleton(mesh, inside=inside, method="sk2", least_angle=120)
        away = np.hypot(np.hypot(tube.points[:, 0], tube.points[:, 1]) - 1, tube.points[:, 2])
        assert np.median(away) < 0.05
        assert np.median(tube.radius) == pytest.approx(0.4, rel=0.05)


class TestBadInput:
    def test_options_out_of_bounds(self) -> None:
        mesh = triangulate(RECTANGLE)
        with pytest.raises(InputError, match="method must be one of sk1, sk2, sk3, sk4; got 'sk5'"):
            voronoi_skeleton(mesh, method="sk5")
        with pytest.raises(InputError, match="least_angle must lie between 0 and 180; got 200"):
            voronoi_skeleton(mesh, least_angle=200)

    def test_nothing_inside(self) -> None:
        mesh = triangulate(RECTANGLE)
        with pytest.raises(InputError, match="expected an object with an inside, got none of 6 cells inside"):
            voronoi_skeleton(mesh, inside=np.zeros(6))
        with pytest.raises(InputError, match="expected one label for each of 6 simplices"):
            voronoi_skeleton(mesh, inside=[1, 0])

    def test_points_are_no_mesh(self) -> None:
        with pytest.raises(InputError, match="expected a Triangulation, got list"):
            voronoi_skeleton(RECTANGLE)  # type: ignore[arg-type]

    @pytest.mark.parametrize("method", METHODS)
    @pytest.mark.parametrize("dim", [2, 3])
    def test_no_cells_give_an_empty_skeleton(self, method: str, dim: int) -> None:
        mesh = triangulate(np.empty((0, dim)))
        skeleton = voronoi_skeleton(mesh, method=method)
        assert (len(skeleton), len(skeleton.lines), skeleton.n_polygons) == (0, 0, 0)

    def test_the_input_is_not_written_to(self) -> None:
        mesh = triangulate(np.random.default_rng(0).random((50, 3)))
        before = [mesh.points.copy(), mesh.simplices.copy(), mesh.neighbors.copy()]
        for method in METHODS:
            voronoi_skeleton(mesh, method=method)
        for given, kept in zip((mesh.points, mesh.simplices, mesh.neighbors), before, strict=True):
            assert np.array_equal(given, kept)


def test_four_points_of_the_plane() -> None:
    """Hardly a Voronoi edge is not crossed by the hull: circumcentres are in Sk1 when the hull holds them."""
    for seed in range(60):
        mesh = triangulate(np.random.default_rng(seed).random((4, 2)))
        held = 0
        for centre in circumcentres(mesh.points, mesh.simplices)[0]:
            places = np.repeat(centre[None], len(mesh), axis=0)
            held += (barycentric_coordinates(mesh.points, mesh.simplices, places) >= 0).all(axis=1).any()
        assert len(voronoi_skeleton(mesh, inside=np.ones(len(mesh)), method="sk1").points) == held, seed
