"""Smooth curves through a skeleton: known cubics come back, noise goes, tolerance and ends are kept."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tetraskel import Aborted, InputError, bezier_skeleton
from tetraskel.kernels.bezier_fit import CLOSED_PIECES, Line, fit_line, hugging
from tetraskel.kernels.cubic_spline import SplineSpace, bezier_at

CUBIC = np.array([[0, 0, 0, 0.5], [1, 2, 0.5, 0.7], [3, 1.5, 1, 0.4], [4, 0, 0.2, 0.6]])


def on_cubic(control, shares):
    """Places and radii on one piece."""
    return bezier_at(np.tile(control, (len(shares), 1, 1)), shares)[0]


def path(balls, closed=False):
    """Points, edges and radii of one line of balls; a closed one does not repeat its first point."""
    n = len(balls)
    edges = np.stack([np.arange(n - 1), np.arange(1, n)], axis=1)
    return balls[:, :-1], np.concatenate([edges, [[n - 1, 0]]]) if closed else edges, balls[:, -1]


def circle(n=80, radius=2.0, thickness=0.5):
    angle = np.linspace(0, 2 * np.pi, n, endpoint=False)
    flat = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle, thickness + 0 * angle], axis=1)
    return flat


def distance_to_path(places, corners):
    """Distance of places (k, 3) to an open line through corners, and radius interpolated there."""
    best = np.full(len(places), np.inf)
    for a, b in itertools.pairwise(corners):
        share = np.clip((places - a) @ (b - a) / max((b - a) @ (b - a), 1e-300), 0, 1)
        best = np.minimum(best, np.sqrt(((places - a - share[:, None] * (b - a)) ** 2).sum(axis=1)))
    return best


def fine(curve, n=40):
    """Dense places of all pieces with radius, (s, n, 4)."""
    pieces = np.concatenate([curve.control, curve.control_radius[..., None]], axis=2)
    shares = np.tile(np.linspace(0, 1, n), len(pieces))
    return bezier_at(np.repeat(pieces, n, axis=0), shares)[0].reshape(len(pieces), n, -1)


@pytest.mark.parametrize("seed", range(5))
def test_a_cubic_comes_back(seed):
    rng = np.random.default_rng(seed)
    control = CUBIC + 0.3 * rng.random((4, 4))
    shares = np.sort(np.concatenate([[0, 1], rng.random(58)]))
    curve = bezier_skeleton(path(on_cubic(control, shares)))
    length = curve.skeleton.branch_length.sum()
    assert len(curve) == 1
    found = np.column_stack([curve.control[0], curve.control_radius[0]])
    found = found if np.allclose(found[0], control[0]) else found[::-1]
    assert np.abs(found - control).max() < 1e-6 * length


def test_a_cubic_comes_back_in_the_plane():
    control = CUBIC[:, [0, 1, 3]]
    curve = bezier_skeleton(path(on_cubic(control, np.linspace(0, 1, 40))))
    assert curve.control.shape == (1, 4, 2)
    assert np.abs(curve.control[0] - control[:, :2]).max() < 1e-6
    assert (curve.torsion == 0).all()


@pytest.mark.slow
def test_curvature_of_a_circle_and_torsion_of_a_helix():
    ring = bezier_skeleton(path(circle(), closed=True), tolerance=2e-4)
    assert np.allclose(ring.curvature, 0.5, rtol=0.02)
    assert np.abs(ring.torsion).max() < 1e-3
    turn = np.linspace(0, 4 * np.pi, 200)
    helix = np.stack([2 * np.cos(turn), 2 * np.sin(turn), 0.5 * turn, 0.4 + 0 * turn], axis=1)
    curve = bezier_skeleton(path(helix), tolerance=0.002)
    inner = (curve.skeleton.node_degree == 2) & (curve.skeleton.abscissa > 3) & (curve.skeleton.abscissa < 20)
    assert np.median(curve.curvature[inner]) == pytest.approx(2 / 4.25, rel=0.02)
    assert np.median(curve.torsion[inner]) == pytest.approx(0.5 / 4.25, rel=0.1)
    mirrored = bezier_skeleton(path(helix * [1, 1, -1, 1]), tolerance=0.002)
    assert np.median(mirrored.torsion[inner]) == pytest.approx(-0.5 / 4.25, rel=0.1)


def test_a_closed_branch_is_smooth_where_it_closes():
    curve = bezier_skeleton(path(circle(), closed=True))
    assert (curve.skeleton.loops, len(curve)) == (0, CLOSED_PIECES)
    assert_smooth(curve.control, closed=True)
    assert curve.skeleton.node_degree.tolist() == [2] * len(curve.skeleton)


def assert_smooth(control, closed=False):
    """Where pieces meet they share place and direction."""
    after = np.roll(control, -1, axis=0) if closed else control[1:]
    before = control if closed else control[:-1]
    assert np.allclose(before[:, 3], after[:, 0], atol=1e-12)
    out, into = before[:, 3] - before[:, 2], after[:, 1] - after[:, 0]
    across = np.sqrt((np.cross(out, into) ** 2).sum(axis=1))
    assert np.allclose(across, 0, atol=1e-9 * np.abs(control).max())
    assert ((out * into).sum(axis=1) >= 0).all()


def test_noise_of_a_hundredth_of_the_radius_goes():
    rng = np.random.default_rng(2)
    clean = on_cubic(CUBIC, np.linspace(0, 1, 120))
    noisy = clean + 0.01 * clean[:, 3:] * rng.normal(size=clean.shape)
    noisy[[0, -1]] = clean[[0, -1]]
    curve = bezier_skeleton(path(noisy))
    assert len(curve) <= 3
    places = fine(curve).reshape(-1, 4)
    off = distance_to_path(places[:, :3], on_cubic(CUBIC, np.linspace(0, 1, 2000))[:, :3])
    noise = distance_to_path(noisy[:, :3], clean[:, :3])
    assert np.sqrt((off**2).mean()) < 0.5 * np.sqrt((noise**2).mean())
    assert (distance_to_path(places[:, :3], noisy[:, :3]) <= 0.1 * 0.7 + 1e-9).all()
    turning = np.abs(np.diff(np.unwrap(np.arctan2(*np.diff(noisy[:, :2], axis=0).T)))).sum()
    assert np.abs(np.diff(np.unwrap(np.arctan2(*np.diff(places[:, :2], axis=0).T)))).sum() < 0.3 * turning


@pytest.mark.slow
@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([0.02, 0.1, 0.5]))
def test_no_curve_leaves_its_tolerance_nor_its_ends(seed, tolerance):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 25))
    steps = rng.normal(size=(n, 3)) + rng.choice([0, 2]) * rng.normal(size=3)
    radius = rng.random(n) + 0.1 * (rng.random() < 0.5)
    balls = np.column_stack([np.cumsum(steps, axis=0), radius])
    curve = bezier_skeleton(path(balls), tolerance=tolerance)
    assert_smooth(curve.control)
    places = fine(curve, 25).reshape(-1, 4)
    assert within(places, balls, 0.92)
    apart = np.sqrt(((balls[:, None, :3] - places[None, :, :3]) ** 2).sum(axis=2)).min(axis=1)
    between = np.sqrt((np.diff(places[:, :3], axis=0) ** 2).sum(axis=1)).max()
    assert (apart <= tolerance * balls[:, 3] + 1e-5 * np.abs(balls).max() + 0.5 * between).all()
    ends = np.concatenate([curve.control[0, 0], curve.control[-1, 3]]).reshape(2, 3)
    assert {tuple(end) for end in ends} == {tuple(balls[0, :3]), tuple(balls[-1, :3])}


def within(places, balls, tolerance):
    """Every place is within the tolerance, relative to the radius there, of some place of the line."""
    shares = np.linspace(0, 1, 101)[:, None]
    line = np.concatenate([(1 - shares) * a + shares * b for a, b in itertools.pairwise(balls)])
    slack = 1e-5 * np.abs(balls).max() + np.sqrt((np.diff(balls, axis=0) ** 2).sum(axis=1)).max() / 100
    for start in range(0, len(places), 200):
        some = places[start : start + 200]
        apart = np.sqrt(((some[:, None, :3] - line[None, :, :3]) ** 2).sum(axis=2))
        if not (apart <= tolerance * line[:, 3] + slack).any(axis=1).all():
            return False
    return True


def test_junctions_stay_and_are_shared():
    arms = [np.linspace([0, 0, 0, 0.5], end, 12) for end in ([4, 0, 0, 0.3], [-2, 3, 0, 0.3], [-2, -3, 1, 0.3])]
    points = np.concatenate([arms[0], arms[1][1:], arms[2][1:]])
    rows = [np.arange(12), np.r_[0, 12:23], np.r_[0, 23:34]]
    edges = np.concatenate([np.stack([row[:-1], row[1:]], axis=1) for row in rows])
    curve = bezier_skeleton((points[:, :3], edges, points[:, 3]))
    skeleton = curve.skeleton
    assert (len(curve), skeleton.n_branches, skeleton.loops) == (3, 3, 0)
    middle = np.flatnonzero(skeleton.node_degree == 3)
    assert np.array_equal(skeleton.points[middle], [[0, 0, 0]])
    assert sorted(map(tuple, skeleton.points[skeleton.node_degree == 1])) == sorted(tuple(arm[-1, :3]) for arm in arms)
    for number in range(3):
        ids = skeleton.branch(number)
        assert np.array_equal(skeleton.points[ids[0]], curve.control[number, 0])
        assert np.array_equal(skeleton.points[ids[-1]], curve.control[number, 3])
        assert np.allclose(skeleton.radius[ids[-1]], curve.control_radius[number, 3])


def test_the_root_is_the_wanted_point():
    balls = on_cubic(CUBIC, np.linspace(0, 1, 30))
    for root in (0, 29):
        skeleton = bezier_skeleton(path(balls), roots=[root]).skeleton
        assert np.allclose(skeleton.points[np.flatnonzero(skeleton.parent < 0)], balls[root, :3])
        assert skeleton.abscissa.max() == pytest.approx(skeleton.branch_length.sum())


@pytest.mark.slow
def test_a_skeleton_keeps_its_roots_and_branches():
    from tetraskel import curve_skeleton
    from tubes import y_tube

    before = curve_skeleton(y_tube().sample(4000))
    curve = bezier_skeleton(before)
    after = curve.skeleton
    assert after.n_branches == before.n_branches
    assert np.allclose(after.points[after.parent < 0], before.points[before.parent < 0], atol=0.1)
    assert 3 * len(curve) <= len(before)


def test_numbering_makes_no_difference_to_the_curves():
    balls = on_cubic(CUBIC, np.linspace(0, 1, 50)) + 0.01 * np.random.default_rng(0).normal(size=(50, 4))
    points, edges, radius = path(balls)
    order = np.random.default_rng(1).permutation(50)
    mixed = (points[order], np.argsort(order)[edges], radius[order])
    first, second = fine(bezier_skeleton(path(balls))), fine(bezier_skeleton(mixed))
    if not np.allclose(first[0, 0], second[0, 0]):
        second = second[::-1, ::-1]
    assert np.allclose(first, second, atol=1e-6)


@pytest.mark.parametrize("scale", [1e-6, 1e5])
def test_the_unit_makes_no_difference(scale):
    balls = on_cubic(CUBIC, np.linspace(0, 1, 50)) + 0.01 * np.random.default_rng(0).normal(size=(50, 4))
    first, second = bezier_skeleton(path(balls)), bezier_skeleton(path(balls * scale))
    assert np.allclose(first.control * scale, second.control, atol=1e-6 * scale)
    assert np.allclose(first.curvature, second.curvature * scale, rtol=1e-3, atol=1e-6)


def test_two_points_are_a_straight_piece_and_none_are_none():
    curve = bezier_skeleton(([[0, 0, 0], [3, 0, 0]], [[0, 1]], [1, 2]))
    assert np.allclose(curve.control[0, :, 0], [0, 1, 2, 3])
    assert np.allclose(curve.control_radius, [[1, 4 / 3, 5 / 3, 2]])
    assert (curve.curvature == 0).all()
    for dim in (2, 3):
        empty = bezier_skeleton((np.empty((0, dim)), [], []))
        assert (len(empty), len(empty.skeleton), empty.control.shape) == (0, 0, (0, 4, dim))


def test_points_alone_and_points_in_one_place_are_kept():
    points = np.array([[0, 0, 0], [0, 0, 0], [1, 0, 0], [1, 0, 0], [5, 5, 5], [7, 7, 7], [7, 7, 7]], float)
    curve = bezier_skeleton((points, [[0, 1], [1, 2], [2, 3], [5, 6]], np.ones(7)))
    assert np.isfinite(curve.control).all()
    assert np.isfinite(curve.curvature).all()
    assert (curve.skeleton.node_degree == 0).sum() == 1
    assert len(np.unique(curve.skeleton.component)) == 3
    assert len(curve) == 2


def test_a_line_that_touches_itself_is_an_answer():
    figure = np.array([[0, 0, 0], [1, 1, 0], [2, 0, 0], [1, -1, 0], [0, 0, 0.0], [-1, 1, 0], [-2, 0, 0], [-1, -1, 0]])
    ids = np.array([0, 1, 2, 3, 0, 5, 6, 7, 0])
    edges = np.stack([ids[:-1], ids[1:]], axis=1)
    curve = bezier_skeleton((figure, edges, np.full(8, 0.3)))
    assert curve.skeleton.n_branches == 2
    assert (curve.skeleton.node_degree == 4).sum() == 1
    there_and_back = np.array([[0, 0, 0, 0.1], [1, 0, 0, 0.1], [2, 0, 0, 0.1], [1, 0, 0, 0.1], [0.5, 0, 0, 0.1]])
    assert np.isfinite(bezier_skeleton(path(there_and_back)).control).all()


def test_corners_become_pieces_that_hug_them():
    zigzag = np.array([[k, k % 2, 0, 0.2] for k in range(9)], float)
    curve = bezier_skeleton(path(zigzag), tolerance=0.01)
    assert len(curve) == 8
    assert_smooth(curve.control)
    assert within(fine(curve).reshape(-1, 4), zigzag, 0.01)


def test_a_closed_line_can_be_hugged():
    balls = np.array([[0, 0, 0, 0.2], [2, 0, 0, 0.2], [2, 2, 0, 0.2], [0, 0, 0, 0.2]])
    pieces = hugging(Line(balls, 0.01 * np.ones(4), True))
    assert_smooth(pieces[..., :3], closed=True)


@pytest.mark.parametrize("closed", [False, True])
def test_pieces_of_a_spline_are_the_spline(closed):
    rng = np.random.default_rng(5)
    space = SplineSpace(np.concatenate([[0], np.sort(rng.random(6)), [1]]), closed)
    control = rng.random((space.size, 2))
    at = np.linspace(0, 1, 50)
    piece = space.piece_of(at)
    weights = space.weights(at, piece)
    assert np.allclose(weights.sum(axis=1), 1)
    assert (weights >= -1e-12).all()
    direct = (weights[:, :, None] * control[space.columns(piece)]).sum(axis=1)
    local = (at - space.breaks[piece]) / np.diff(space.breaks)[piece]
    place, first, second, third = bezier_at(space.pieces(control)[piece], local)
    assert np.allclose(place, direct)
    step = 1e-5
    ahead = bezier_at(space.pieces(control)[piece], local + step)
    for k, derivative in enumerate((first, second, third)):
        assert np.allclose((ahead[k] - (place, first, second)[k]) / step, derivative, atol=1e-2)
    ends = bezier_at(space.pieces(control), np.ones(7))
    begins = bezier_at(space.pieces(control), np.zeros(7))
    width = np.diff(space.breaks)[:, None]
    for order in range(3):
        out, into = ends[order] / width**order, begins[order] / width**order
        assert np.allclose(out[:-1], into[1:])
        assert np.allclose(out[-1], into[0]) or not closed


def test_a_fit_ends_at_the_ends():
    balls = on_cubic(CUBIC, np.linspace(0, 1, 20))
    pieces = fit_line(Line(balls, 0.01 * balls[:, 3], False))
    assert np.array_equal(pieces[0, 0], balls[0])
    assert np.array_equal(pieces[-1, 3], balls[-1])


@pytest.mark.parametrize(
    ("skeleton", "options", "message"),
    [
        (([[0, 0, 0]], [], [-1]), {}, "finite and not negative"),
        (([[0, 0, 0], [1, 0, 0]], [[0, 1]], [1, 1]), {"tolerance": 0.0}, "tolerance must lie between"),
        (([[0, 0, 0], [1, 0, 0]], [[0, 1]], [1, 1]), {"samples": 1}, "samples must lie between"),
    ],
)
def test_what_cannot_be_fitted_is_said(skeleton, options, message):
    with pytest.raises(InputError, match=message):
        bezier_skeleton(skeleton, **options)


def test_work_can_be_stopped():
    def stop(share):
        raise Aborted("stopped")

    with pytest.raises(Aborted):
        bezier_skeleton(path(circle()), tick=stop)
