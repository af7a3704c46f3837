"""The surface of a skeleton's balls: closed forms, a closed manifold whatever the skeleton, and what moves with it."""

from __future__ import annotations

from itertools import combinations, pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tetraskel import Aborted, InputError, RebuiltSurface, skeleton_surface, surface_error
from tetraskel.kernels import skeleton_surface as module
from tetraskel.kernels.ball_graph import ball_graph, branches_of
from tetraskel.kernels.marching import case_table
from tetraskel.kernels.round_cones import nearest_along, round_cones
from tetraskel.kernels.straightened import straightened
from tetraskel.kernels.surface_error import distances
from tetraskel.kernels.surface_rays import nearest_on_surface, surface_of
from tubes import TUBES, torus, y_tube


def arrays_of(tube):
    """Points, edges and radii of a tube's exact axes, shared points told by their places."""
    rows = np.concatenate(tube.axes)
    points, index = np.unique(rows.round(12), axis=0, return_inverse=True)
    index = index.ravel()
    first = np.concatenate(
        [np.arange(len(axis) - 1) + start for axis, start in zip(tube.axes, starts(tube), strict=True)]
    )
    radius = np.zeros(len(points))
    radius[index] = np.repeat(tube.radii, [len(axis) for axis in tube.axes])
    return points, index[np.stack([first, first + 1], axis=1)], radius


def starts(tube):
    return np.cumsum([0] + [len(axis) for axis in tube.axes[:-1]])


def edges_of(simplices):
    """Directed edges of triangles."""
    return np.concatenate([simplices[:, [0, 1]], simplices[:, [1, 2]], simplices[:, [2, 0]]])


def euler(surface):
    return len(surface) - len(edges_of(surface.simplices)) // 2 + len(surface.simplices)


def volume(surface):
    a, b, c = surface.points[surface.simplices].transpose(1, 0, 2)
    return float((a * np.cross(b, c)).sum() / 6)


def assert_closed_manifold(surface):
    """Every edge twice, in opposite directions; the triangles at a point go once around it; outward normals."""
    edges = edges_of(surface.simplices)
    found, count = np.unique(edges, axis=0, return_counts=True)
    assert (count == 1).all()
    assert np.array_equal(np.unique(edges[:, ::-1], axis=0), found)
    after = {}
    for triangle in surface.simplices.tolist():
        for k in range(3):
            after.setdefault(triangle[k], {})[triangle[k - 2]] = triangle[k - 1]
    assert len(after) == len(surface)
    for ring in after.values():
        first = place = next(iter(ring))
        for _ in range(len(ring)):
            place = ring[place]
        assert place == first
        assert len(set(ring.values())) == len(ring)
    walked = {tuple(sorted(edge)) for edge in edges.tolist()}
    assert 2 * len(walked) == len(edges)


def areas(surface):
    """Signed area inside each closed line."""
    offsets, ids = surface.loops
    found = []
    for start, stop in pairwise(offsets):
        x, y = surface.points[ids[start:stop]].T
        found.append(float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2))
    return found


def sphere_error(surface):
    return np.abs(np.sqrt((surface.points**2).sum(axis=1)) - 1)


def test_a_point_is_its_ball():
    ball = skeleton_surface(([[0, 0, 0]], [], [1.0]))
    assert_closed_manifold(ball)
    assert euler(ball) == 2
    diagonal = 2 * np.sqrt(3)
    assert sphere_error(ball).mean() < 0.001 * diagonal
    middles = ball.points[ball.simplices].mean(axis=1)
    assert np.abs(np.sqrt((middles**2).sum(axis=1)) - 1).mean() < 0.005 * diagonal
    assert np.allclose((ball.normals * ball.points).sum(axis=1), 1, atol=0.01)
    assert set(ball.branch) == {-1}
    assert np.allclose(ball.radius, 1)


def test_finer_cells_come_nearer():
    errors = [sphere_error(skeleton_surface(([[0, 0, 0]], [], [1.0]), spacing=h)).mean() for h in (0.2, 0.1, 0.05)]
    assert errors[1] < errors[0] / 3
    assert errors[2] < errors[1] / 3


@pytest.mark.parametrize("name", [name for name in TUBES if name not in ("annulus",)])
def test_tubes_come_back_from_their_axes(name):
    tube = TUBES[name]()
    surface = skeleton_surface(arrays_of(tube))
    assert_closed_manifold(surface)
    assert euler(surface) == 2 - 2 * tube.loops
    found = surface_error(surface, tube.sample(3000))
    assert found["ErrorMean"] < 0.5
    assert surface.thickened == 0


def test_the_torus_has_its_volume_inside():
    surface = skeleton_surface(arrays_of(torus()))
    assert volume(surface) == pytest.approx(2 * np.pi**2 * 2 * 0.36, rel=0.02)
    assert_normals_point_outwards(surface)


def assert_normals_point_outwards(surface):
    a, b, c = surface.points[surface.simplices].transpose(1, 0, 2)
    assert ((np.cross(b - a, c - a) * surface.normals[surface.simplices[:, 0]]).sum(axis=1) > 0).mean() > 0.99


def test_an_annulus_is_two_closed_lines():
    tube = TUBES["annulus"]()
    region = skeleton_surface(arrays_of(tube))
    assert region.simplices.shape[1] == 2
    assert sorted(areas(region)) == pytest.approx([-np.pi * 1.5**2, np.pi * 2.5**2], rel=0.01)
    assert surface_error(region, tube.sample(2000))["ErrorMean"] < 0.5


def test_a_region_of_any_plane_lies_in_it():
    points, edges, radius = arrays_of(TUBES["annulus"]())
    turned = points @ np.array([[1, 2, 2], [2, 1, -2]]) / 3 + [5, 6, 7]
    region = skeleton_surface((turned, edges, radius), dimension="plane")
    assert np.ptp((region.points - [5, 6, 7]) @ [2, -2, 1]) < 1e-9
    away = np.sqrt(((region.points - [5, 6, 7]) ** 2).sum(axis=1))
    assert np.abs(np.minimum(np.abs(away - 1.5), np.abs(away - 2.5))).max() < 0.01


def test_round_cone_is_the_union_of_its_balls():
    rng = np.random.default_rng(0)
    ends, radius = rng.random((40, 2, 3)), rng.random((40, 2)) * 0.8  # some balls hold the other
    share = np.linspace(0, 1, 2001)
    places = 2 * rng.random((3, 40)) - 0.5
    cones = round_cones(ends.reshape(-1, 3), radius.ravel(), np.arange(80).reshape(-1, 2))
    found, _ = nearest_along(cones, places, np.arange(40))
    for k in range(40):
        centres = (1 - share)[:, None] * ends[k, 0] + share[:, None] * ends[k, 1]
        radii = (1 - share) * radius[k, 0] + share * radius[k, 1]
        best = (np.sqrt(((places[:, k] - centres) ** 2).sum(axis=1)) - radii).min()
        assert found[k] <= best + 1e-12
        assert found[k] == pytest.approx(best, abs=1e-5)


@pytest.mark.parametrize("dim", [2, 3])
def test_every_case_is_closed_by_its_complement(dim):
    """Where inside and outside meet: as many pieces as sides allow, and no diagonal of a face twice."""
    table = case_table(dim)
    n_cases = 1 << (1 << dim)
    for case in range(n_cases):
        pieces = table.pieces[table.offsets[case] : table.offsets[case + 1]]
        crossed = {
            side
            for side, (corner, axis) in enumerate(zip(table.side_corner, table.side_axis, strict=True))
            if (case >> corner & 1) != (case >> (corner | 1 << axis) & 1)
        }
        assert set(pieces.ravel()) == crossed


def test_values_at_random_give_a_closed_manifold():
    """Every case of signs beside every other: nothing about distances is needed."""
    from tetraskel.kernels.marching import contour_blocks

    values = np.random.default_rng(3).normal(size=(14, 14, 14, 1))
    values[[0, -1]] = values[:, [0, -1]] = values[:, :, [0, -1]] = 1
    found = contour_blocks(values, np.zeros((1, 3), np.int64), np.array([14, 14, 14]))
    order = np.argsort(found.keys)
    simplices = np.searchsorted(found.keys[order], found.pieces)
    none = np.zeros((len(order), 3))
    assert_closed_manifold(RebuiltSurface(none, simplices, none, none[:, 0], order))


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6))
def test_any_skeleton_gives_a_closed_manifold(seed):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 12))
    edges = rng.integers(0, n, (int(rng.integers(0, 14)), 2))
    radius = rng.random(n) * 0.3 * (rng.random(n) < 0.8)
    surface = skeleton_surface((rng.random((n, 3)), edges, radius), spacing=0.06)
    assert_closed_manifold(surface)
    assert volume(surface) > 0


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6))
def test_lines_too_thin_for_the_cells_stay_whole(seed):
    rng = np.random.default_rng(seed)
    surface = skeleton_surface((rng.random((2, 3)), [[0, 1]], [0, 0]), spacing=0.05)
    assert_closed_manifold(surface)
    assert euler(surface) == 2
    assert surface.thickened == 2
    flat = skeleton_surface((rng.random((2, 2)), [[0, 1]], [0, 0]), spacing=0.05)
    assert len(flat.loops[0]) == 2


@pytest.mark.parametrize("pairs", [1, 300])
def test_blocks_make_no_difference(monkeypatch, pairs):
    whole = skeleton_surface(arrays_of(y_tube()), spacing=0.2)
    monkeypatch.setattr(module, "PAIRS", pairs)
    parts = skeleton_surface(arrays_of(y_tube()), spacing=0.2)
    for name in ("points", "simplices", "normals", "radius", "branch"):
        assert np.array_equal(getattr(whole, name), getattr(parts, name)), name


def test_numbering_makes_no_difference():
    points, edges, radius = arrays_of(y_tube())
    order = np.random.default_rng(1).permutation(len(points))
    where = np.argsort(order)
    mixed = (points[order], where[edges][::-1, ::-1], radius[order])
    first, second = skeleton_surface((points, edges, radius)), skeleton_surface(mixed)
    assert np.allclose(first.points, second.points, atol=1e-12)
    assert np.array_equal(first.simplices, second.simplices)


@pytest.mark.parametrize("scale", [1e-6, 1e3])
def test_the_unit_makes_no_difference(scale):
    points, edges, radius = arrays_of(y_tube())
    first, second = skeleton_surface((points, edges, radius)), skeleton_surface((points * scale, edges, radius * scale))
    assert euler(first) == euler(second)
    assert second.spacing == pytest.approx(first.spacing * scale)
    assert volume(second) == pytest.approx(volume(first) * scale**3, rel=1e-3)


def test_surface_points_know_their_branch():
    points, edges, radius = arrays_of(y_tube())
    surface = skeleton_surface((points, edges, radius))
    branches = branches_of(ball_graph((points, edges, radius)))
    assert set(surface.branch) == {0, 1, 2}
    for number in range(3):
        row = branches.connectivity[branches.offsets[number] : branches.offsets[number + 1]]
        tip = points[row[np.argmax((points[row] ** 2).sum(axis=1))]]
        nearest = np.argmin(((surface.points - 1.1 * tip) ** 2).sum(axis=1))
        assert surface.branch[nearest] == number


def test_straight_runs_become_one_edge():
    share = np.linspace(0, 1, 65)
    graph = ball_graph((np.outer(share, [1, 2, 3]), np.stack([np.arange(64), np.arange(1, 65)], axis=1), 1 + share))
    edges, branch = straightened(branches_of(graph), 1e-9)
    assert edges.tolist() == [[0, 64]]
    assert branch.tolist() == [0]
    bent = ball_graph((np.outer(share**2, [1, 2, 3]), graph.edges, 1 + np.sin(3 * share)))
    edges, _ = straightened(branches_of(bent), 0.01)
    assert 4 < len(edges) < 40
    for a, b in edges.tolist():
        chord = np.linspace(0, 1, b - a + 1)[:, None]
        balls = np.column_stack([bent.points, bent.radius])[a : b + 1]
        fine = balls[0] + np.linspace(0, 1, 2000)[:, None] * (balls[-1] - balls[0])
        off = np.abs(balls[:, None] - fine[None]).sum(axis=2).min(axis=1)
        assert off.max() < 0.04, chord


def test_distances_to_a_surface_are_those_to_all_its_triangles():
    rng = np.random.default_rng(4)
    corners = rng.random((300, 1, 3)) + rng.normal(size=(300, 3, 3)) * 10.0 ** rng.uniform(-3, 0, (300, 1, 1))
    surface = surface_of(corners.reshape(-1, 3), np.arange(900).reshape(-1, 3))
    places = 3 * rng.random((200, 3)) - 1
    expected = np.sqrt(((nearest_on_surface(surface, places) - places) ** 2).sum(axis=1))
    assert np.allclose(distances(surface, places), expected, rtol=1e-9, atol=1e-12)


@pytest.mark.slow
def test_error_of_a_ball_too_large_is_what_it_is_too_large_by():
    ball = skeleton_surface(([[0, 0, 0]], [], [1.0]), spacing=0.05)
    larger = skeleton_surface(([[0, 0, 0]], [], [1.1]), spacing=0.05)
    diagonal = np.linalg.norm(np.ptp(ball.points, axis=0))
    found = surface_error(larger, ball.points, ball.simplices)
    assert found["ErrorMean"] == pytest.approx(100 * 0.1 / diagonal, rel=0.02)
    assert found["BackErrorMean"] == pytest.approx(100 * 0.1 / diagonal, rel=0.02)
    assert found["ErrorMax"] < 1.1 * found["ErrorMean"]
    assert surface_error(larger, ball.points)["ErrorMean"] == pytest.approx(found["ErrorMean"], rel=0.02)


def test_what_is_asked_for_is_capped_and_said():
    points, edges, radius = arrays_of(y_tube())
    free = skeleton_surface((points, edges, radius), cells_per_radius=20)
    capped = skeleton_surface((points, edges, radius), cells_per_radius=20, max_cells=5000)
    assert not free.capped
    assert capped.capped
    assert len(capped) < 7000 < len(free)


def test_a_closed_line_and_balls_alone_and_a_ball_in_a_ball():
    points, edges, radius = arrays_of(torus())
    more = np.concatenate([points, [[0, 0, 0], [10, 0, 0], [10.1, 0, 0]]])
    n = len(points)
    found = skeleton_surface((more, [*edges.tolist(), [n + 1, n + 2]], [*radius, 0.3, 1.0, 0.2]))
    assert_closed_manifold(found)
    assert euler(found) == 0 + 2 + 2
    assert set(found.branch) == {-1, 0, 1}


def test_no_points_give_no_surface():
    for dim, dimension in ((3, "auto"), (2, "auto"), (3, "plane")):
        found = skeleton_surface((np.empty((0, dim)), [], []), dimension=dimension)
        assert len(found) == len(found.simplices) == 0
        assert found.simplices.shape[1] == (3 if (dim, dimension) == (3, "auto") else 2)
        if found.simplices.shape[1] == 2:
            assert found.loops[0].tolist() == [0]


def test_points_without_size_are_drawn_and_said():
    found = skeleton_surface((np.zeros((1, 3)), [], [0.0]))
    assert_closed_manifold(found)
    assert found.thickened == 1


BAD = [
    (([[0, 0, np.nan]], [], [1]), {}, "got 1 of 1 skeleton points with NaN"),
    (([[0, 0, 0], [1, 0, 0]], [], [1, -1]), {}, "finite and not negative, got 1 of 2"),
    (([[0, 0, 0], [1, 0, 0]], [], [1, np.inf]), {}, "finite and not negative, got 1 of 2"),
    (([[0, 0, 0], [1, 0, 0]], [], [1]), {}, "a radius for each of 2 skeleton points"),
    (([[0, 0, 0, 0]], [], [1]), {}, "shape (p, 2) or (p, 3), got (1, 4)"),
    (([[0, 0, 0]], [[0, 1]], [1]), {}, "edges between points 0 to 0, got 0 to 1"),
    (([[0, 0]], [], [1]), {"dimension": "space"}, "three coordinates for a surface in space"),
    ((np.random.default_rng(0).random((9, 3)), [], np.ones(9)), {"dimension": "plane"}, "choose dimension = space"),
    (([[0, 0, 0]], [], [1]), {"spacing": -1.0}, "spacing must lie between"),
    (([[0, 0, 0]], [], [1]), {"dimension": "time"}, "dimension must be one of"),
]


@pytest.mark.parametrize(("skeleton", "options", "message"), BAD)
def test_what_is_no_skeleton_is_said(skeleton, options, message):
    with pytest.raises(InputError) as told:
        skeleton_surface(skeleton, **options)
    assert message in str(told.value)


BALL = skeleton_surface(([[0, 0, 0]], [], [1.0]))


@pytest.mark.parametrize(
    ("points", "message"),
    [
        (np.zeros((4, 2)), "points with 3 coordinates"),
        (np.zeros((0, 3)), "got 0 and"),
        (np.full((4, 3), np.nan), "NaN"),
        (np.zeros((4, 3)), "that are apart, got 4 in one place"),
    ],
)
def test_what_cannot_be_compared_is_said(points, message):
    with pytest.raises(InputError, match=message):
        surface_error(BALL, points)


def test_work_can_be_stopped():
    def stop(share):
        raise Aborted("stopped")

    with pytest.raises(Aborted):
        skeleton_surface(arrays_of(y_tube()), tick=stop)


def test_progress_goes_from_nothing_to_all():
    told = []
    skeleton_surface(arrays_of(y_tube()), tick=told.append)
    assert told == sorted(told)
    assert 0 < told[0] < 0.3
    assert told[-1] == 1


def test_input_is_not_written_to():
    skeleton = arrays_of(torus())
    before = [part.copy() for part in skeleton]
    skeleton_surface(skeleton)
    assert all(np.array_equal(a, b) for a, b in zip(skeleton, before, strict=True))


def test_lines_are_cut_at_junctions_and_repeated_ones_counted_once():
    points = np.array([[0, 0], [1, 0], [2, 0], [1, 1], [5, 5]], float)
    graph = ball_graph((points, [[0, 1], [1, 2], [1, 3], [3, 1], [1, 1]], np.ones(5)))
    branches = branches_of(graph)
    assert np.diff(branches.offsets).tolist() == [2, 2, 2]
    assert graph.degree.tolist() == [1, 3, 1, 1, 0]
    assert branches_of(branches) is branches
    assert all(len(set(pair)) == 2 for pair in combinations(branches.connectivity[:2].tolist(), 2))
