"""The medial sheets of boxes, whose medial axes are known."""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from tetraskel.errors import Aborted, InputError
from tetraskel.kernels.adjacency import triangulation_of
from tetraskel.kernels.curve import CurveModel, curve_model
from tetraskel.kernels.medial_mesh import MedialMesh, medial_mesh
from tetraskel.kernels.triangulate import triangulate

sys.path.append(str(Path(__file__).parents[1]))
from shapes import Shape, ball, plate, rough, torus
from tubes import TUBES

SIDES = np.array([4.0, 2.0, 0.8])


def model_of(shape: Shape, n: int) -> CurveModel:
    return curve_model(triangulate(shape.sample(n, np.random.default_rng(0))))


def box(n: int, sides: np.ndarray = SIDES) -> np.ndarray:
    """Random points of a box with one corner at the origin."""
    rng = np.random.default_rng(0)
    areas = sides.prod() / sides
    axis = rng.choice(3, n, p=areas / areas.sum())
    points = rng.random((n, 3)) * sides
    points[np.arange(n), axis] = rng.integers(0, 2, n) * sides[axis]
    return rough(points, rng)


@cache
def lens_model(c: float) -> CurveModel:
    """Of a flat ellipsoid with the semi-axes 1, 1 and c."""
    ways = np.random.default_rng(0).normal(size=(4000, 3))
    return curve_model(triangulate(ways / np.linalg.norm(ways, axis=1, keepdims=True) * [1, 1, c]))


def heights(sheet: MedialMesh) -> np.ndarray:
    """Mean distance of the triangles from the mid-plane of the box, weighted by area."""
    middle = sheet.points[sheet.triangles].mean(axis=1)[:, 2]
    return (sheet.areas * np.abs(middle - SIDES[2] / 2)).sum() / sheet.areas.sum()


@pytest.fixture(scope="module")
def flat_box() -> CurveModel:
    return curve_model(triangulate(box(5000)))


def test_the_sheet_of_a_flat_box_is_its_mid_plane(flat_box: CurveModel) -> None:
    sheet = medial_mesh(flat_box)
    a, b, h = SIDES
    assert sheet.areas.sum() == pytest.approx((a - h) * (b - h), rel=0.02)
    assert heights(sheet) < 0.02 * h
    middle = sheet.points[sheet.triangles].mean(axis=1)[:, :2]
    assert (middle > 0.35 * h).all()
    assert (middle < SIDES[:2] - 0.35 * h).all()
    assert np.median(sheet.radius) == pytest.approx(h / 2, rel=0.02)
    assert (sheet.angle >= 120).all()


@pytest.mark.parametrize(("angle", "tolerance"), [(60, 0.02), (90, 0.02), (120, 0.03), (150, 0.15)])
def test_the_sheet_of_a_flat_ellipsoid_is_a_disc(angle: float, tolerance: float) -> None:
    """Semi-axes 1, 1, c: where the normals at height c sin(t) meet the mid-plane, tan(angle / 2) = tan(t) / c."""
    c = 0.3
    tangent = c * np.tan(np.radians(angle / 2))
    radius = (1 - c**2) / np.sqrt(1 + tangent**2)
    sheet = medial_mesh(lens_model(c), sheet_angle=angle)
    assert sheet.areas.sum() == pytest.approx(np.pi * radius**2, rel=tolerance)
    corners = sheet.points[sheet.triangles].mean(axis=1)
    assert (sheet.areas * np.abs(corners[:, 2])).sum() < 0.02 * c * sheet.areas.sum()
    away = np.linalg.norm(sheet.points[:, :2], axis=1)
    touching = c * np.sqrt(np.maximum(1 - away**2 / (1 - c**2), 0))  # radius of the ball that touches the ellipsoid
    assert np.abs(sheet.radius - touching).mean() < 0.02 * c


def test_a_smaller_angle_gives_the_sheets_into_the_edges(flat_box: CurveModel) -> None:
    """The whole medial axis of a box a x b x h: sheets at 45 degrees run from the mid-plane into its twelve edges."""
    a, b, h = SIDES
    into_long_edges = 4 * ((2 * a - h) + (2 * b - h)) / 2 * h / np.sqrt(2)
    into_short_edges = 4 * h * h / np.sqrt(2) / 2
    whole = (a - h) * (b - h) + into_long_edges + into_short_edges
    areas = [medial_mesh(flat_box, sheet_angle=angle).areas.sum() for angle in (60, 75, 120)]
    assert areas == sorted(areas, reverse=True)
    assert areas[0] == pytest.approx(whole, rel=0.2)  # less near the edges, where samples are as far apart as sides


def test_the_smallest_angle_gives_every_face(flat_box: CurveModel) -> None:
    every, some = medial_mesh(flat_box, sheet_angle=0), medial_mesh(flat_box)
    assert set(map(tuple, some.points[some.triangles].reshape(-1, 9))) <= set(
        map(tuple, every.points[every.triangles].reshape(-1, 9))
    )
    assert len(medial_mesh(flat_box, sheet_angle=180)) == 0


@pytest.mark.parametrize("shape", [ball(), torus()])
def test_round_objects_have_no_sheet(shape: Shape) -> None:
    model = model_of(shape, 1500)
    assert len(medial_mesh(model)) == 0
    assert len(medial_mesh(model, sheet_angle=0)) > 1000


@pytest.mark.parametrize(("shape", "angle"), [(plate(thickness=0.25), 60), (torus(), 0)])
def test_sheets_lie_inside(shape: Shape, angle: float) -> None:
    sheet = medial_mesh(model_of(shape, 3000), sheet_angle=angle)
    shares = np.random.default_rng(1).dirichlet(np.ones(3), (4, len(sheet)))
    assert len(sheet) > 100
    assert shape.contains(np.einsum("kti,tia->kta", shares, sheet.points[sheet.triangles]).reshape(-1, 3)).all()


def test_corners_are_as_far_from_the_points_as_their_radius(flat_box: CurveModel) -> None:
    sheet = medial_mesh(flat_box)
    away, _ = flat_box.inner.cloud.query(sheet.points)
    corners = np.unique(sheet.triangles[:, :2])
    assert away[corners] == pytest.approx(sheet.radius[corners], rel=1e-6)


def test_normals_of_a_sheet_agree_and_no_triangle_is_nothing(flat_box: CurveModel) -> None:
    sheet = medial_mesh(flat_box)
    a, b, c = sheet.points[sheet.triangles].transpose(1, 0, 2)
    assert np.cross(b - a, c - a)[:, 2].clip(max=0).sum() > -0.01 * sheet.areas.sum()
    assert (sheet.triangles[:, 0] != sheet.triangles[:, 1]).all()
    assert len(np.unique(sheet.points, axis=0)) == len(sheet.points)
    assert set(sheet.triangles.ravel().tolist()) == set(range(len(sheet.points)))


def test_permuted_points_give_the_same_sheet() -> None:
    points = box(2000, np.array([2.0, 2.0, 0.7]))
    order = np.random.default_rng(2).permutation(len(points))
    first, second = (medial_mesh(curve_model(triangulate(p))) for p in (points, points[order]))
    assert len(first) > 500
    for name in ("points", "triangles", "radius", "angle"):
        assert np.array_equal(getattr(first, name), getattr(second, name)), name


def test_objects_of_the_plane_and_single_simplices_have_no_sheets() -> None:
    ring = medial_mesh(curve_model(triangulate(TUBES["annulus"]().sample(800))))
    assert (len(ring), ring.points.shape) == (0, (0, 2))
    lone = medial_mesh(curve_model(triangulation_of(np.eye(4)[:, :3], [[0, 1, 2, 3]])), sheet_angle=0)
    assert (len(lone), lone.points.shape, lone.areas.shape) == (0, (0, 3), (0,))


def test_bad_angles_are_told_and_abort_passes_through(flat_box: CurveModel) -> None:
    with pytest.raises(InputError, match="sheet_angle must lie between 0 and 180; got 181"):
        medial_mesh(flat_box, sheet_angle=181)

    def stop(_: float) -> None:
        raise Aborted("enough")

    with pytest.raises(Aborted):
        medial_mesh(flat_box, tick=stop)
