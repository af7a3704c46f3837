"""Compiled measures of tetrahedra equal those of array operations to the last bit."""

import numpy as np
import pytest

from tetraskel.kernels.chunks import silent
from tetraskel.kernels.compilation import SWITCH, numba_is_used
from tetraskel.kernels.medial_nodes import circumcentres, facing, medial_nodes
from tetraskel.kernels.passage_widths import widths_and_rooms, widths_of_facets
from tetraskel.kernels.smoothing import smaller_surface
from tetraskel.kernels.triangulate import triangulate

pytestmark = pytest.mark.skipif(not numba_is_used(), reason="numba is not installed")


def clouds():
    rng = np.random.default_rng(5)
    yield rng.uniform(-1, 1, (6000, 3))
    yield 1e3 + 1e-3 * rng.standard_normal((500, 3))
    yield np.stack(np.meshgrid(*[np.arange(6.0)] * 3), axis=-1).reshape(-1, 3) + 1e-9 * rng.uniform(size=(216, 3))


def measured(mesh):
    points, simplices = mesh.coordinates, mesh.simplices
    nodes = medial_nodes(points, simplices, mesh.neighbors)
    inside = np.random.default_rng(1).random(len(mesh)) < 0.5
    return (
        *widths_and_rooms(points, simplices),
        widths_of_facets(points, simplices[:, 1:]),
        *circumcentres(points, simplices),
        facing(points, simplices, nodes, silent),
        smaller_surface(mesh, inside),
    )


@pytest.mark.parametrize("cloud", range(3))
def test_compiled_and_not_agree(monkeypatch, cloud):
    mesh = triangulate(list(clouds())[cloud])
    compiled = measured(mesh)
    monkeypatch.setenv(SWITCH, "0")
    for one, other in zip(compiled, measured(mesh), strict=True):
        assert np.array_equal(one, other, equal_nan=one.dtype.kind == "f")


def test_widths_of_facets_are_those_of_their_simplices():
    mesh = triangulate(next(clouds()))
    widths, _ = widths_and_rooms(mesh.coordinates, mesh.simplices)
    assert np.array_equal(widths[:, 2], widths_of_facets(mesh.coordinates, mesh.simplices[:, [0, 1, 3]]))
