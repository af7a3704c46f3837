"""Where nodes are drawn."""

from __future__ import annotations

import numpy as np
import pytest

from tetraskel import InputError, triangulate, triangulation_of
from tetraskel.kernels.centres import centres, circumballs

RIGHT = np.array([[0, 0], [3, 0], [0, 4]], float)


def test_centres_of_the_three_four_five_triangle():
    mesh = triangulation_of(RIGHT, [[0, 1, 2]])
    assert centres(mesh)[0] == pytest.approx([1, 4 / 3])
    assert centres(mesh, "incentre")[0] == pytest.approx([1, 1])
    assert centres(mesh, "circumcentre")[0] == pytest.approx([1.5, 2])
    radius, inside = circumballs(mesh)
    assert radius[0] == pytest.approx(2.5)
    assert inside[0]  # on the hypotenuse


@pytest.mark.parametrize("dim", [2, 3])
def test_circumcentres_are_equally_far_from_all_vertices(dim):
    mesh = triangulate(np.random.default_rng(0).random((100, dim)))
    distances = np.linalg.norm(mesh.points[mesh.simplices] - centres(mesh, "circumcentre")[:, None], axis=2)
    radius, _ = circumballs(mesh)
    assert np.allclose(distances, radius[:, None], rtol=1e-6)


@pytest.mark.parametrize("dim", [2, 3])
def test_incentres_are_equally_far_from_all_facets(dim):
    mesh = triangulate(np.random.default_rng(1).random((40, dim)))
    centre = centres(mesh, "incentre")
    distances = []
    for k in range(dim + 1):
        facet = mesh.points[np.delete(mesh.simplices, k, axis=1)]
        edges = facet[:, 1:] - facet[:, :1]
        normal = np.stack([edges[:, 0, 1], -edges[:, 0, 0]], 1) if dim == 2 else np.cross(edges[:, 0], edges[:, 1])
        distances.append(np.abs(((centre - facet[:, 0]) * normal).sum(1)) / np.linalg.norm(normal, axis=1))
    assert np.allclose(distances, distances[0], rtol=1e-8)


def test_which_simplices_hold_their_circumcentre():
    acute = np.array([[0, 0], [2, 0], [1, 1.9]])
    obtuse = np.array([[0, 0], [4, 0], [2, 0.5]])
    for corners, expected in ((acute, True), (obtuse, False)):
        assert circumballs(triangulation_of(corners, [[0, 1, 2]]))[1][0] == expected


def test_flat_simplices_have_no_circumcentre():
    flat = triangulation_of([[0, 0], [1, 1], [3, 3]], [[0, 1, 2]])
    assert centres(flat, "circumcentre")[0] == pytest.approx([4 / 3, 4 / 3])
    radius, inside = circumballs(flat)
    assert np.isinf(radius[0])
    assert not inside[0]


def test_centres_lie_in_the_plane_of_the_points():
    tilted = np.random.default_rng(2).random((30, 3))
    tilted[:, 2] = tilted[:, 0] + 2 * tilted[:, 1]
    mesh = triangulate(tilted)
    for kind in ("barycentre", "incentre", "circumcentre"):
        x, y, z = centres(mesh, kind).T
        assert np.allclose(z, x + 2 * y, atol=1e-9)


def test_unknown_centre_is_refused():
    with pytest.raises(InputError, match="centre must be one of barycentre, incentre, circumcentre; got 'middle'"):
        centres(triangulation_of(RIGHT, [[0, 1, 2]]), "middle")
