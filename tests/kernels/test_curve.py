"""The curve skeleton on tubes with exact axes: topology, axis, radius, invariance, bad input."""

from __future__ import annotations

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from tetraskel.errors import Aborted, InputError
from tetraskel.kernels.adjacency import triangulation_of
from tetraskel.kernels.compilation import SWITCH, numba_is_used
from tetraskel.kernels.curve import CurveModel, curve_model, curve_skeleton, draw_curve
from tetraskel.kernels.curve_skeleton import END, Skeleton
from tetraskel.kernels.inside_check import facets_between, stays_inside
from tetraskel.kernels.measures import graph_numbers, measure, samples_along
from tetraskel.kernels.triangulate import triangulate

sys.path.append(str(Path(__file__).parents[1]))
from tubes import TUBES, Tube, circle, cylinder, line, radius_error

DENSITIES = dict.fromkeys(TUBES, (1000, 3000, 9000)) | {"helix": (8000, 10000, 12000), "tree": (1000, 4000, 12000)}
NOISY = dict.fromkeys(TUBES, (6000, 11000)) | {"helix": (9000, 14000), "tree": (9000, 14000)}


def topology(skeleton: Skeleton) -> tuple[float, float, float, float]:
    numbers = graph_numbers(skeleton)
    return numbers["components"], numbers["loops"], numbers["ends"], numbers["junctions"]


def expected(tube: Tube) -> tuple[int, int, int, int]:
    return 1, tube.loops, tube.ends, tube.junctions


def bones_apart(a: Skeleton, b: Skeleton) -> float:
    """Hausdorff distance between two skeletons, in diagonals."""
    first, second = samples_along(a, 400)[0], samples_along(b, 400)[0]
    away = np.linalg.norm(first[:, None] - second[None], axis=2)
    return float(max(away.min(axis=0).max(), away.min(axis=1).max()) / np.linalg.norm(np.ptp(first, axis=0)))


@pytest.mark.parametrize("density", [0, 1, 2] if numba_is_used() else [0])  # slow where loops are not compiled
@pytest.mark.parametrize("name", sorted(TUBES))
def test_tubes_have_their_axes(name: str, density: int) -> None:
    tube = TUBES[name]()
    skeleton = curve_skeleton(tube.sample(DENSITIES[name][density], seed=density))
    check_against_axis(skeleton, tube)
    assert radius_error(skeleton, tube) < 0.05


@pytest.mark.parametrize("density", [0, 1] if numba_is_used() else [0])
@pytest.mark.parametrize("name", sorted(TUBES))
def test_noisy_tubes_too(name: str, density: int) -> None:
    tube = TUBES[name]()
    skeleton = curve_skeleton(tube.sample(NOISY[name][density], seed=density, noise=0.005))
    check_against_axis(skeleton, tube)
    assert radius_error(skeleton, tube) < 0.05


def check_against_axis(skeleton: Skeleton, tube: Tube) -> None:
    """Exact topology; the axis within 5 % of the local radius on average."""
    assert topology(skeleton) == expected(tube)
    places, weights = samples_along(skeleton, 400)
    assert (weights * tube.axis_distance(places)).sum() / weights.sum() < 0.05


@pytest.fixture(scope="module")
def double() -> CurveModel:
    return curve_model(triangulate(TUBES["double torus"]().sample(6000)))


@pytest.mark.parametrize("detail", [0.0, 0.3, 0.7, 1.0])
def test_loops_stay_at_every_detail(double: CurveModel, detail: float) -> None:
    skeleton = draw_curve(double, detail=detail)
    assert (skeleton.components, skeleton.loops, skeleton.loops_refused) == (1, 2, 0)
    assert topology(skeleton)[:2] == (1, 2)


def test_a_coarse_skeleton_is_part_of_a_fine_one(double: CurveModel) -> None:
    counts = [draw_curve(double, detail=detail).n_branches for detail in (0.0, 0.5, 1.0)]
    assert counts == sorted(counts)


def test_loops_narrower_than_asked_are_cut() -> None:
    mesh = triangulate(TUBES["double torus"]().sample(6000))
    skeleton = draw_curve(curve_model(mesh, loop_spacings=100))
    assert (skeleton.loops, skeleton.loops_refused) == (0, 2)
    assert topology(skeleton)[:2] == (1, 0)


def test_flat_ended_cylinder_is_one_line() -> None:
    skeleton = curve_skeleton(cylinder(4000))
    assert topology(skeleton) == (1, 0, 2, 0)
    ends = np.sort(skeleton.points[skeleton.node_type == END][:, 0])
    assert ends == pytest.approx([0.5, 3.5], abs=0.1)


def test_rigid_motion_and_unit_move_the_skeleton_along() -> None:
    points = TUBES["y"]().sample(3000)
    rotation = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    still, moved = curve_skeleton(points), curve_skeleton(1000 * points @ rotation.T + 5)
    back = (moved.points - 5) @ rotation / 1000
    assert topology(still) == topology(moved)
    away = np.linalg.norm(back[:, None] - still.points[None], axis=2).min(axis=1).max()
    assert away < 0.02 * np.linalg.norm(np.ptp(points, axis=0))


def test_permuted_points_give_the_same_skeleton_exactly() -> None:
    points = TUBES["tree"]().sample(6000) + np.random.default_rng(1).normal(0, 1e-3, (6000, 3))
    order = np.random.default_rng(2).permutation(len(points))
    first, second = curve_skeleton(points), curve_skeleton(points[order])
    for name in ("points", "radius", "offsets", "connectivity", "parent", "depth", "branch_length"):
        assert np.array_equal(getattr(first, name), getattr(second, name)), name
    assert np.array_equal(first.point_nodes[order], second.point_nodes)


def test_another_sample_of_the_same_shape_agrees() -> None:
    tube = TUBES["bent tube"]()
    assert bones_apart(curve_skeleton(tube.sample(4000, 1)), curve_skeleton(tube.sample(4000, 2))) < 0.02


def test_edges_stay_inside(double: CurveModel) -> None:
    skeleton = draw_curve(double, detail=1.0)
    inner = double.inner
    near = np.array([np.argmin(((double.nodes.positions - p) ** 2).sum(axis=1)) for p in skeleton.points])
    assert stays_inside(inner, skeleton.points, double.nodes.homes[near], skeleton.edges).all()


def test_an_edge_across_the_hole_is_found_outside_and_bent_back() -> None:
    model = curve_model(triangulate(TUBES["torus"]().sample(3000)))
    inner, homes = model.inner, model.nodes.homes
    ends = np.array([[2.0, 0, 0], [-2.0, 0, 0]])
    near = np.array([homes[np.argmin(((model.nodes.positions - p) ** 2).sum(axis=1))] for p in ends])
    assert not stays_inside(inner, ends, near, np.array([[0, 1]]))[0]
    route = np.concatenate([ends[:1], facets_between(inner, near[0], near[1]), ends[1:]])
    assert np.linalg.norm(route[:, :2], axis=1).min() > 1.3


def test_arrays_are_consistent(double: CurveModel) -> None:
    skeleton = draw_curve(double)
    sons = np.flatnonzero(skeleton.parent >= 0)
    assert (skeleton.depth[sons] == skeleton.depth[skeleton.parent[sons]] + 1).all()
    assert (skeleton.abscissa[sons] > skeleton.abscissa[skeleton.parent[sons]]).all()
    assert (skeleton.parent < 0).sum() == skeleton.components
    for number in range(skeleton.n_branches):
        row = skeleton.branch(number)
        steps = np.linalg.norm(np.diff(skeleton.points[row], axis=0), axis=1)
        assert skeleton.branch_length[number] == pytest.approx(steps.sum())
        assert (skeleton.node_degree[row[1:-1]] == 2).all()
    degree = np.bincount(skeleton.edges.ravel(), minlength=len(skeleton))
    assert np.array_equal(degree, skeleton.node_degree)
    assert skeleton.point_nodes.min() >= 0
    assert skeleton.point_nodes.max() < len(skeleton)


def test_input_points_belong_to_the_branch_beside_them() -> None:
    points = TUBES["y"]().sample(3000)
    skeleton = curve_skeleton(points, root=(0.0, 0.0, 0.0))
    far = np.linalg.norm(points, axis=1) > 1.5
    own = skeleton.points[skeleton.point_nodes[far]]
    assert np.linalg.norm(points[far] - own, axis=1).max() < 1.0
    assert len(set(skeleton.point_branches[far].tolist())) == 3


def test_strahler_orders_of_a_tree() -> None:
    skeleton = curve_skeleton(TUBES["tree"]().sample(8000), root=(0.0, 0.0, 0.0))
    assert sorted(skeleton.branch_strahler.tolist()) == [1] * 4 + [2] * 3


def test_roots_are_where_they_are_asked_to_be() -> None:
    model = curve_model(triangulate(TUBES["capsule"]().sample(2000)))
    for root, x in (("paper", 0.0), ((4.0, 0, 0), 4.0)):
        skeleton = draw_curve(model, root=root)
        start = skeleton.points[skeleton.parent < 0][0]
        assert start[0] == pytest.approx(x, abs=0.4)


def test_every_piece_has_its_own_skeleton() -> None:
    apart = np.concatenate([TUBES["capsule"]().sample(2000), TUBES["torus"]().sample(3000) + [0, 6, 0]])
    skeleton = curve_skeleton(apart)
    assert topology(skeleton) == (2, 1, 2, 0)
    assert set(skeleton.component.tolist()) == {0, 1}


def test_a_planar_cloud_in_space_is_done_in_its_plane() -> None:
    flat = TUBES["annulus"]().sample(1500)
    tilt = np.array([[1.0, 0, 0.5], [0, 1, 0.25]])
    tilt = np.linalg.qr(tilt.T)[0].T
    skeleton = curve_skeleton(flat @ tilt + [1, 2, 3])
    assert topology(skeleton) == (1, 1, 0, 0)
    normal = np.cross(*tilt)
    assert np.abs((skeleton.points - [1, 2, 3]) @ normal).max() < 1e-6


def test_without_numba_the_numbers_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    points = TUBES["torus"]().sample(3000) + np.random.default_rng(0).normal(0, 1e-3, (3000, 3))
    first = curve_skeleton(points)
    monkeypatch.setenv(SWITCH, "0")
    second = curve_skeleton(points)
    assert np.array_equal(first.points, second.points)
    assert np.array_equal(first.connectivity, second.connectivity)


def test_a_shell_is_drawn_and_its_cavity_told() -> None:
    rng = np.random.default_rng(4)
    ways = rng.normal(size=(6000, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    mesh = triangulate(ways * np.where(np.arange(6000) < 4000, 1.0, 0.6)[:, None])
    middle = np.linalg.norm(mesh.points[mesh.simplices].mean(axis=1), axis=1)
    corners = np.linalg.norm(mesh.points[mesh.simplices], axis=2)
    skeleton = curve_skeleton(mesh, inside=(corners.max(axis=1) > 0.8) & (middle > 0.5))
    assert (skeleton.components, skeleton.loops, skeleton.cavities) == (1, 0, 1)


def test_one_tetrahedron_is_one_point() -> None:
    skeleton = curve_skeleton(triangulation_of(np.eye(4)[:, :3], [[0, 1, 2, 3]]))
    assert (len(skeleton), skeleton.n_branches, skeleton.components) == (1, 0, 1)
    assert skeleton.point_nodes.tolist() == [0] * 4


def test_a_ball_is_nearly_a_point() -> None:
    ways = np.random.default_rng(5).normal(size=(2000, 3))
    skeleton = curve_skeleton(ways / np.linalg.norm(ways, axis=1, keepdims=True))
    assert topology(skeleton)[0] == 1
    assert np.linalg.norm(skeleton.points, axis=1).max() < 0.1


def test_no_points_give_no_skeleton() -> None:
    skeleton = curve_skeleton(np.empty((0, 3)))
    assert (len(skeleton), skeleton.n_branches, skeleton.components) == (0, 0, 0)


@pytest.mark.parametrize(
    ("points", "said"),
    [
        (np.eye(3)[:, :2][:2], "at least 3"),
        (np.random.default_rng(0).random((300, 3)), "inside"),
        (line((0, 0, 0), (1, 1, 1), (2, 2, 2), (3, 3, 3)), "line"),
        (np.array([[0, 0, np.nan]] * 5), "finite"),
    ],
)
def test_bad_clouds_are_told(points: np.ndarray, said: str) -> None:
    with pytest.raises(InputError, match=said):
        curve_skeleton(points)


@pytest.mark.parametrize("options", [{"detail": 2}, {"loop_spacings": -1}, {"root": "top"}, {"root": (1.0,)}])
def test_bad_options_are_told(options: dict) -> None:
    with pytest.raises(InputError):
        curve_skeleton(circle(1.0, (0, 0))[:-1], inside=None, **options)


def test_abort_passes_through() -> None:
    def stop(share: float) -> None:
        if share > 0.6:
            raise Aborted("enough")

    with pytest.raises(Aborted):
        curve_skeleton(TUBES["capsule"]().sample(2000), tick=stop)


def test_progress_never_leaves_its_range() -> None:
    told: list[float] = []
    curve_skeleton(TUBES["capsule"]().sample(1000), tick=told.append)
    assert all(0 <= share <= 1 for share in told)
    assert told[-1] == 1
    assert sum(b < a - 0.5 for a, b in pairwise(told)) == 0


def test_the_input_is_not_written_to() -> None:
    points = TUBES["capsule"]().sample(800)
    before = points.copy()
    mesh = triangulate(points)
    simplices = mesh.simplices.copy()
    curve_skeleton(mesh)
    assert np.array_equal(points, before)
    assert np.array_equal(mesh.simplices, simplices)


def test_measure_knows_a_good_skeleton_from_a_bad_one() -> None:
    tube = TUBES["capsule"]()
    skeleton = curve_skeleton(tube.sample(2000))
    surface = capsule_surface()
    good = measure(skeleton, surface)
    assert good["inside"] == 1
    assert good["reconstruction_mean"] < 1
    assert good["centredness"] > 0.8
    moved = Skeleton(**{**vars(skeleton), "points": skeleton.points + [0, 0.3, 0]})
    bad = measure(moved, surface)
    assert bad["centredness"] < 0.5 < good["centredness"]
    outside = Skeleton(**{**vars(skeleton), "points": skeleton.points + [0, 2.0, 0]})
    assert measure(outside, surface)["inside"] == 0


def test_measure_wants_triangles() -> None:
    skeleton = curve_skeleton(TUBES["capsule"]().sample(1500))
    with pytest.raises(InputError, match="triangles"):
        measure(skeleton, (np.zeros((3, 3)), np.empty((0, 3), int)))
    with pytest.raises(InputError, match="space"):
        measure(curve_skeleton(TUBES["annulus"]().sample(2000)), (np.eye(3), [[0, 1, 2]]))


def capsule_surface(rings: int = 40, around: int = 48) -> tuple[np.ndarray, np.ndarray]:
    """A closed triangulated capsule: stretched sphere of radius 1/2 from x = 0 to x = 4."""
    polar = np.linspace(0, np.pi, rings + 1)[1:-1]
    angle = np.linspace(0, 2 * np.pi, around, endpoint=False)
    x = -0.5 * np.cos(polar)
    ring = np.stack(
        [
            np.repeat(x + 4 * (x > 0), around),
            *(np.outer(0.5 * np.sin(polar), f(angle)).ravel() for f in (np.cos, np.sin)),
        ],
        axis=1,
    )
    vertices = np.concatenate([ring, [[-0.5, 0, 0], [4.5, 0, 0]]])
    n = len(polar)
    faces = []
    for k in range(around):
        j = (k + 1) % around
        for i in range(n - 1):
            a, b, c, d = i * around + k, i * around + j, (i + 1) * around + k, (i + 1) * around + j
            faces += [[a, c, b], [b, c, d]]
        faces += [[n * around, k, j], [n * around + 1, (n - 1) * around + j, (n - 1) * around + k]]
    return vertices, np.array(faces)
