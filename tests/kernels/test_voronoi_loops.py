"""Compiled loops give the Voronoi skeletons of array operations, to the last bit."""

from __future__ import annotations

from dataclasses import fields
from itertools import product

import numpy as np
import pytest

from shapes import SOLIDS
from tetraskel import Triangulation, triangulate, voronoi_skeleton
from tetraskel.kernels.compilation import SWITCH, numba_is_used

pytestmark = pytest.mark.skipif(not numba_is_used(), reason="numba is not installed")


def objects():
    rng = np.random.default_rng(2)
    volume = triangulate(rng.random((1500, 3)))
    middles = volume.points[volume.simplices].mean(axis=1)
    yield "volume", volume, np.ones(len(volume), bool)
    yield "ball in a volume", volume, ((middles - 0.5) ** 2).sum(axis=1) < 0.1
    yield "labels by lot", volume, rng.random(len(volume)) < 0.5
    surface = triangulate(SOLIDS["torus"]().sample(1500, rng))
    middles = surface.points[surface.simplices].mean(axis=1)
    yield "torus", surface, SOLIDS["torus"]().contains(middles)
    angles = 2 * np.pi * rng.random(300)  # one face with hundreds of corners, and another half of which is inside
    wheel = np.stack([np.cos(angles), np.sin(angles), 0.01 * rng.normal(size=300)], axis=1)
    spindle = triangulate(np.concatenate([wheel, [[0, 0, 0.3], [0.01, 0, -0.3]]]))
    yield "spindle", spindle, np.ones(len(spindle), bool)
    yield "half a spindle", spindle, spindle.points[spindle.simplices].mean(axis=1)[:, 0] > 0
    around = 2 * np.pi * rng.integers(0, 12, 150) / 12  # places on borders, found from many triangles
    drum = triangulate(np.stack([np.cos(around), np.sin(around), rng.integers(0, 6, 150) * 0.5], axis=1))
    yield "drum by lot", drum, rng.random(len(drum)) < 0.5
    square = triangulate(rng.random((1500, 2)))
    yield "square", square, np.ones(len(square), bool)
    yield "square by lot", square, rng.random(len(square)) < 0.5
    lattice = triangulate(np.array(list(product(range(5), repeat=3)), float))
    yield "lattice", lattice, np.ones(len(lattice), bool)
    yield "lattice by lot", lattice, rng.random(len(lattice)) < 0.5
    grid = triangulate(np.array(list(product(range(9), repeat=2)), float))
    yield "grid by lot", grid, rng.random(len(grid)) < 0.5


OBJECTS = {name: (mesh, inside) for name, mesh, inside in objects()} if numba_is_used() else {}


@pytest.mark.parametrize("name", OBJECTS)
@pytest.mark.parametrize("method", ["sk1", "sk2", "sk3", "sk4"])
def test_compiled_and_not_agree(monkeypatch: pytest.MonkeyPatch, name: str, method: str) -> None:
    mesh, inside = OBJECTS[name]
    compiled = voronoi_skeleton(mesh, inside=inside, method=method)
    monkeypatch.setenv(SWITCH, "0")
    plain = voronoi_skeleton(mesh, inside=inside, method=method)
    assert len(compiled) > 0
    for field in fields(plain):
        assert np.array_equal(getattr(compiled, field.name), getattr(plain, field.name)), field.name


def test_simplices_that_have_nothing_but_an_edge_in_common() -> None:
    """At an edge with many fans of simplices each may have a way ahead and one behind."""
    n = 20
    around = 2 * np.pi * np.arange(2 * n) / (2 * n)
    rim = np.stack([2 * np.cos(around), 2 * np.sin(around), 0 * around], axis=1)
    simplices = np.array([[0, 1, 2 + 2 * i, 3 + 2 * i] for i in range(n)], np.int32)
    mesh = Triangulation(np.concatenate([[[0, 0, 1.0], [0, 0, -1]], rim]), simplices, np.full_like(simplices, -1))
    skeleton = voronoi_skeleton(mesh, method="sk2")
    assert np.isfinite(skeleton.points).all()
    assert skeleton.n_polygons >= 4 * n
