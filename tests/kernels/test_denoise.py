"""Noise taken out of clouds: found where it is, nothing touched where it is not."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from tetraskel.errors import Aborted, InputError
from tetraskel.kernels.denoise import denoised
from tetraskel.kernels.triangulate import triangulate

sys.path.append(str(Path(__file__).parents[1]))
from shapes import ball, plate
from tubes import TUBES, Floats, distance_to

NOISE = 0.005  # of the diagonal


def off_surface(name: str, points: Floats) -> Floats:
    """Signed distance from points to the surface of a tube."""
    tube = TUBES[name]()
    return np.min([distance_to(axis, points) - r for axis, r in zip(tube.axes, tube.radii, strict=True)], axis=0)


def diagonal(points: Floats) -> float:
    return float(np.linalg.norm(np.ptp(points, axis=0)))


@pytest.mark.parametrize("n", [300, 3000, 12000])
@pytest.mark.parametrize("name", sorted(TUBES))
def test_smooth_surfaces_are_left_as_they_are(name: str, n: int) -> None:
    points = TUBES[name]().sample(n)
    found = denoised(points)
    assert found.noise == 0
    assert np.array_equal(found.points, points)
    assert np.array_equal(found.stands_for, np.arange(n))


@pytest.mark.parametrize(
    "points",
    [
        plate().sample(5000, np.random.default_rng(0)),
        ball().sample(5000, np.random.default_rng(0)),
        np.random.default_rng(0).random((5000, 3)),  # fills a volume
        np.random.default_rng(0).random((5000, 2)),
        np.stack(np.meshgrid(*[np.arange(12.0)] * 3), axis=-1).reshape(-1, 3),
        np.random.default_rng(0).random((50, 3)),
        np.empty((0, 3)),
    ],
    ids=["plate", "ball", "volume", "area", "lattice", "few", "none"],
)
def test_other_clouds_without_noise_too(points: Floats) -> None:
    found = denoised(points)
    assert found.noise == 0
    assert np.array_equal(found.points, points)


@pytest.mark.parametrize("n", [4000, 12000])
@pytest.mark.parametrize("name", ["capsule", "torus", "y", "annulus"])
def test_noise_is_measured_and_taken_out(name: str, n: int) -> None:
    points = TUBES[name]().sample(n, noise=NOISE)
    found = denoised(points)
    assert abs(found.noise / (NOISE * diagonal(points)) - 1) < 0.15
    before, after = off_surface(name, points), off_surface(name, found.points)
    assert after.std() < 0.36 * before.std()
    assert abs(after.mean()) < 0.12 * before.std()  # fits to 100 of 4,000 points do not quite follow the bend


def test_kept_points_are_as_far_apart_as_the_noise() -> None:
    points = TUBES["torus"]().sample(15000, noise=NOISE)
    found = denoised(points)
    assert len(found.points) < len(points)
    away = np.linalg.norm(found.points[::50, None] - found.points[None], axis=2)
    away[away == 0] = np.inf
    assert np.median(away.min(axis=1)) > 0.5 * found.noise


def test_every_point_is_stood_for_by_the_nearest() -> None:
    points = TUBES["y"]().sample(3000, noise=NOISE)
    found = denoised(points)
    away = np.linalg.norm(points[:, None] - found.points[None], axis=2)
    assert np.array_equal(found.stands_for, away.argmin(axis=1))
    assert (np.diff(found.ids) > 0).all()
    assert (np.linalg.norm(points[found.ids] - found.points, axis=1) < 8 * found.noise).all()


def test_the_order_of_the_points_does_not_matter() -> None:
    points = TUBES["y"]().sample(3000, noise=NOISE)
    order = np.random.default_rng(1).permutation(len(points))
    one, other = denoised(points), denoised(points[order])
    assert one.noise == other.noise
    assert np.array_equal(np.sort(order[other.ids]), one.ids)
    assert np.array_equal(other.points[np.argsort(order[other.ids])], one.points)


@pytest.mark.parametrize("factor", [2.0**-40, 2.0**40])
def test_the_unit_does_not_matter(factor: float) -> None:
    points = TUBES["capsule"]().sample(3000, noise=NOISE)
    one, other = denoised(points), denoised(points * factor)
    assert np.array_equal(other.points, one.points * factor)
    assert other.noise == one.noise * factor


def test_the_triangulation_is_that_of_the_points_left() -> None:
    points = TUBES["capsule"]().sample(8000, noise=NOISE)
    doubled = np.concatenate([points, points[:100]])
    mesh, found = triangulate(doubled, denoise=True), denoised(points)
    assert np.array_equal(mesh.points, found.points)
    assert np.array_equal(mesh.original_ids, found.ids)
    assert np.array_equal(mesh.point_map, np.concatenate([found.stands_for, found.stands_for[:100]]))
    assert mesh.noise == found.noise > 0
    assert triangulate(doubled).noise == 0


def test_a_noisy_outline_in_a_tilted_plane_stays_in_it() -> None:
    flat = TUBES["annulus"]().sample(3000, noise=NOISE)
    tilt = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    cloud = np.c_[flat, np.zeros(len(flat))] @ tilt + [1.0, 2.0, 3.0]
    mesh = triangulate(cloud, denoise=True)
    assert mesh.dim == 2
    assert mesh.noise == pytest.approx(NOISE * diagonal(flat), rel=0.15)
    back = (mesh.points - [1.0, 2.0, 3.0]) @ tilt.T
    assert np.abs(back[:, 2]).max() < 1e-9
    assert off_surface("annulus", back[:, :2]).std() < 0.4 * NOISE * diagonal(flat)


def test_abort_passes_through() -> None:
    def stop(share: float) -> None:
        raise Aborted("stopped")

    with pytest.raises(Aborted):
        denoised(TUBES["torus"]().sample(20000, noise=NOISE), stop)


def test_bad_points_are_told() -> None:
    with pytest.raises(InputError, match="finite coordinates"):
        denoised([[0.0, np.nan, 1.0]])
