from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from checks import measures
from shapes import LETTER_A, LETTER_B, letters
from tetraskel import InputError, inside_by_outline, interior, triangulate


def outline_of(rings):
    points = np.concatenate([np.array(ring, dtype=float) for ring in rings])
    first = np.cumsum([0] + [len(ring) for ring in rings])
    return points, np.concatenate([np.stack([np.arange(a, b), np.roll(np.arange(a, b), -1)], 1)
                                   for a, b in pairwise(first)])  # fmt: skip


def ring_area(ring):
    x, y = np.array(ring, dtype=float).T
    return 0.5 * abs((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())


RINGS = LETTER_A + LETTER_B
AREA = sum(ring_area(RINGS[k]) for k in (0, 2)) - sum(ring_area(RINGS[k]) for k in (1, 3, 4))
CLOUDS = {
    "anywhere": lambda rng: rng.uniform((-1, -1), (7, 5), (600, 2)),
    "on the outline": lambda rng: letters().sample(600, rng),
    "a lattice": lambda rng: np.stack(np.meshgrid(np.linspace(0, 6.5, 66), np.linspace(0, 4, 41)), -1).reshape(-1, 2),
}


@pytest.mark.parametrize("cloud", CLOUDS)
def test_every_segment_is_a_union_of_edges(cloud):
    given = triangulate(CLOUDS[cloud](np.random.default_rng(0)))
    points, segments = outline_of(RINGS)
    mesh, inside = inside_by_outline(given, points, segments)
    assert measures(mesh)[inside].sum() == pytest.approx(AREA, rel=1e-9)
    edges = np.concatenate([mesh.simplices[:, [0, 1]], mesh.simplices[:, [1, 2]], mesh.simplices[:, [2, 0]]])
    a, b = mesh.points[edges].transpose(1, 0, 2)
    for start, end in points[segments]:
        side = end - start
        reach = [(p - start) @ side / (side @ side) for p in (a, b)]
        off = [np.abs(side[0] * (p - start)[:, 1] - side[1] * (p - start)[:, 0]) for p in (a, b)]
        along = (np.maximum(*off) < 1e-9) & (np.minimum(*reach) > -1e-9) & (np.maximum(*reach) < 1 + 1e-9)
        pieces = np.sort(np.stack(reach, 1)[along], axis=1)
        pieces = pieces[np.argsort(pieces[:, 0])]
        covered = np.maximum.accumulate(pieces[:, 1])
        assert abs(pieces[0, 0]) < 1e-9
        assert abs(covered[-1] - 1) < 1e-9
        assert np.all(pieces[1:, 0] <= covered[:-1] + 1e-9)  # no gap


def test_points_keep_their_ids_and_added_ones_have_none():
    given = triangulate(CLOUDS["anywhere"](np.random.default_rng(1)))
    mesh, _ = inside_by_outline(given, *outline_of(RINGS))
    known = mesh.original_ids >= 0
    assert np.array_equal(mesh.points[known], given.points)
    assert np.array_equal(mesh.original_ids[known], given.original_ids)


def test_a_plane_in_space_gives_the_same_area():
    turn = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    flat = CLOUDS["anywhere"](np.random.default_rng(3))
    points, segments = outline_of(RINGS)
    lift = lambda p: np.c_[p, np.full(len(p), 0.7)] @ turn  # noqa: E731
    mesh, inside = inside_by_outline(triangulate(lift(flat)), lift(points), segments)
    assert mesh.points.shape[1] == 3
    assert np.ptp(mesh.points @ turn.T, axis=0)[2] < 1e-9
    assert measures(mesh)[inside].sum() == pytest.approx(AREA, rel=1e-6)


def test_sharp_angles_end():
    star = np.array([[0, 0], [10, 0.1], [10, -0.1], [10, 0.3], [10, 0.5]])
    segments = [[0, 1], [1, 2], [2, 0], [0, 3], [3, 4], [4, 0]]
    mesh, inside = inside_by_outline(triangulate(np.random.default_rng(4).uniform(-1, 11, (300, 2))), star, segments)
    assert measures(mesh)[inside].sum() == pytest.approx(2.0, rel=1e-9)


def test_without_conforming_barycentres_decide():
    mesh = triangulate(CLOUDS["anywhere"](np.random.default_rng(5)))
    inside = interior(mesh, method="outline", outline=outline_of(RINGS))
    assert np.array_equal(inside, letters().contains(mesh.points[mesh.simplices].mean(axis=1)))


SQUARE = [[0.0, 0], [5, 5], [5, 0], [0, 5]]


@pytest.mark.parametrize(
    ("points", "segments", "message"),
    [(SQUARE, [[0, 1], [1, 2]], "closed lines"), (SQUARE, [[0, 1], [1, 2], [2, 3], [3, 0]], "cross"),
     (SQUARE, [[0, 9]], "segment ids"), (SQUARE, [[0, 1, 2]], "segments"), (np.eye(3), [[0, 1]], "coordinates"),
     (np.full((4, 2), np.nan), [[0, 1]], "finite")],
)  # fmt: skip
def test_bad_outlines_are_refused(points, segments, message):
    mesh = triangulate(np.random.default_rng(6).uniform(-1, 6, (50, 2)))
    with pytest.raises(InputError, match=message):
        inside_by_outline(mesh, points, segments)


def test_points_too_near_to_the_outline_end_in_an_error_or_an_answer():
    near = np.stack([np.linspace(0, 5, 40), 1e-5 * np.cos(np.arange(40))], axis=1)
    mesh = triangulate(np.concatenate([near, [[2, 5.0], [3, -4]]]))
    mesh, inside = inside_by_outline(mesh, [[0, 0], [5, 0], [5, 3], [0, 3]], [[0, 1], [1, 2], [2, 3], [3, 0]])
    assert measures(mesh)[inside].sum() == pytest.approx(15, rel=1e-6)
