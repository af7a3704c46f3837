"""Groups of triangles leave out none that counts: the answers are those of every triangle looked at."""

from __future__ import annotations

import numpy as np
import pytest

from tetraskel.kernels.surface_rays import GROUP, first_hits, nearest_in_triangles, nearest_on_surface, surface_of


def triangles(seed, n):
    """Random triangles, small and large, some without area."""
    generator = np.random.default_rng(seed)
    corners = generator.normal(size=(n, 1, 3)) + generator.lognormal(-2, 1, (n, 1, 1)) * generator.normal(
        size=(n, 3, 3)
    )
    corners[::7, 2] = corners[::7, 1]
    return surface_of(corners.reshape(-1, 3), np.arange(3 * n).reshape(-1, 3)), generator


@pytest.mark.parametrize("n", [1, GROUP, GROUP + 1, 500])
@pytest.mark.parametrize("seed", range(3))
def test_the_nearest_point_is_that_of_all_triangles(seed, n):
    surface, generator = triangles(seed, n)
    places = 2 * generator.normal(size=(60, 3))
    every = [nearest_in_triangles(np.tile(place, (n, 1)), surface.corners) for place in places]
    least = [np.sqrt(((found - place) ** 2).sum(axis=1)).min() for found, place in zip(every, places, strict=True)]
    found = nearest_on_surface(surface, places)
    assert np.allclose(np.sqrt(((found - places) ** 2).sum(axis=1)), least, rtol=1e-12, atol=0)


@pytest.mark.parametrize("n", [1, GROUP + 1, 500])
@pytest.mark.parametrize("seed", range(3))
def test_rays_hit_what_they_hit_of_each_triangle_alone(seed, n):
    surface, generator = triangles(seed, n)
    starts, ways = generator.normal(size=(40, 3)), generator.normal(size=(40, 3))
    ways /= np.sqrt((ways**2).sum(axis=1, keepdims=True))
    alone = [first_hits(surface_of(corners, [[0, 1, 2]]), starts, ways, np.zeros(40)) for corners in surface.corners]
    first, count = first_hits(surface, starts, ways, np.zeros(40))
    assert np.array_equal(first, np.min([hit for hit, _ in alone], axis=0))
    assert np.array_equal(count, np.sum([number for _, number in alone], axis=0))
