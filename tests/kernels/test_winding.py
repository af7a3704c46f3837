from __future__ import annotations

import numpy as np
import pytest

from shapes import Shape, ball
from tetraskel import InputError, interior, triangulate
from tetraskel.kernels.winding import solid_angles, winding_numbers


def sphere(n: int = 24, radius: float = 1.0):
    """A latitude-longitude sphere, facing outwards."""
    lat, lon = np.linspace(0, np.pi, n + 1)[1:-1], np.arange(2 * n) * np.pi / n
    ring = np.stack([np.outer(np.sin(lat), np.cos(lon)), np.outer(np.sin(lat), np.sin(lon)),
                     np.outer(np.cos(lat), np.ones(2 * n))], -1).reshape(-1, 3)  # fmt: skip
    points = radius * np.concatenate([ring, [[0, 0, 1], [0, 0, -1]]])
    i, j = np.meshgrid(np.arange(n - 2), np.arange(2 * n), indexing="ij")
    a, b = (i * 2 * n + j).ravel(), (i * 2 * n + (j + 1) % (2 * n)).ravel()
    north, south, k = len(ring), len(ring) + 1, np.arange(2 * n)
    last = (n - 2) * 2 * n
    faces = [np.stack([a, a + 2 * n, b], 1), np.stack([b, a + 2 * n, b + 2 * n], 1),
             np.stack([np.full(2 * n, north), k, (k + 1) % (2 * n)], 1),
             np.stack([np.full(2 * n, south), last + (k + 1) % (2 * n), last + k], 1)]  # fmt: skip
    return points, np.concatenate(faces)


@pytest.fixture(scope="module")
def mesh():
    return triangulate(np.random.default_rng(0).uniform(-1.3, 1.3, (800, 3)))


def test_an_octant_has_an_eighth_of_all_directions():
    corner = np.eye(3)[:, :, None]
    assert solid_angles(corner)[0] == pytest.approx(4 * np.pi / 8, rel=1e-14)
    assert solid_angles(corner[[1, 0, 2]])[0] == pytest.approx(-4 * np.pi / 8, rel=1e-14)


def test_far_groups_summed_equal_every_triangle_alone():
    points, faces = sphere()
    queries = np.random.default_rng(1).uniform(-2, 2, (300, 3))
    near = [solid_angles((points[faces] - query).transpose(1, 2, 0)).sum() / (4 * np.pi) for query in queries]
    assert winding_numbers(queries, points, faces) == pytest.approx(near, abs=0.06)


def test_inside_of_a_sphere(mesh):
    shape: Shape = ball()
    inside = interior(mesh, method="surface", surface=sphere())
    barycentres = mesh.points[mesh.simplices].mean(axis=1)
    clear = np.abs(np.linalg.norm(barycentres, axis=1) - 1) > 0.02
    assert np.array_equal(inside[clear], shape.contains(barycentres)[clear])
    assert 0 < inside.sum() < len(mesh)


def test_small_holes_change_little_and_a_cavity_is_outside(mesh):
    points, faces = sphere()
    whole = interior(mesh, method="surface", surface=(points, faces))
    assert np.mean(whole == interior(mesh, method="surface", surface=(points, faces[:-6]))) > 0.995
    core, core_faces = sphere(radius=0.6)
    shell = np.concatenate([points, core]), np.concatenate([faces, core_faces[:, ::-1] + len(points)])
    radii = np.linalg.norm(mesh.points[mesh.simplices].mean(axis=1), axis=1)
    assert not interior(mesh, method="surface", surface=shell)[radii < 0.55].any()


@pytest.mark.parametrize(
    ("spoil", "message"),
    [(lambda p, f: (p, f[len(f) // 2 :]), "open edges"), (lambda p, f: (p, f[:, ::-1]), "inside out"),
     (lambda p, f: (p, np.concatenate([f[:50, ::-1], f[50:]])), "orient"), (lambda p, f: (p, f[:, :2]), "triangles"),
     (lambda p, f: (p, f + 1), "point ids"), (lambda p, f: (p * np.nan, f), "finite")],
)  # fmt: skip
def test_bad_surfaces_are_refused(mesh, spoil, message):
    with pytest.raises(InputError, match=message):
        interior(mesh, method="surface", surface=spoil(*sphere()))


def test_triangles_have_no_side_of_a_surface():
    with pytest.raises(InputError, match="outline"):
        interior(triangulate(np.eye(3)[:, :2]), method="surface", surface=sphere())
