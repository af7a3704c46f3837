"""The skeleton of the same object turned, permuted, moved, resampled, decimated and with noise.

Distances are Hausdorff distances between skeletons, in percent of the diagonal of the object's box.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.spatial import cKDTree

from tetraskel import curve_skeleton
from tetraskel.kernels.measures import samples_along
from tubes import TUBES

N = 5000
TURNED = 1.0  # other roundings choose between nodes that are as good as each other
SAMPLED = 4.0  # a radius of these tubes is 5 to 10 %
NOISY = 6.0
OBJECTS = ("bent tube", "y", "torus", "double torus", "tree")


@cache
def cloud(name, seed=0):
    return TUBES[name]().sample(N, seed)


@cache
def skeleton(name):
    return curve_skeleton(cloud(name))


def apart(first, second, name):
    """Hausdorff distance, in percent."""
    a, b = (samples_along(one, 3000)[0] for one in (first, second))
    farthest = max(cKDTree(a).query(b)[0].max(), cKDTree(b).query(a)[0].max())
    return 100 * farthest / np.linalg.norm(np.ptp(cloud(name), axis=0))


def assert_same_graph(found, name):
    tube = TUBES[name]()
    assert (found.components, found.loops) == (1, tube.loops)
    assert int((found.node_degree == 1).sum()) == tube.ends


@pytest.mark.xfail(reason="rounding decides between equal nodes: 0.2 to 0.5 % apart after a turn", strict=True)
def test_a_turn_changes_nothing():
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    for name in OBJECTS:
        found = curve_skeleton(cloud(name) @ turn)
        assert apart(type(found)(**{**vars(found), "points": found.points @ turn.T}), skeleton(name), name) < 0.01


@pytest.mark.parametrize("name", OBJECTS)
class TestTheSameObject:
    def test_permuted_is_the_same_to_the_last_bit(self, name):
        order = np.random.default_rng(2).permutation(N)
        found = curve_skeleton(cloud(name)[order])
        assert np.array_equal(found.points, skeleton(name).points)
        assert np.array_equal(found.connectivity, skeleton(name).connectivity)

    def test_turned(self, name):
        turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
        found = curve_skeleton(cloud(name) @ turn)
        assert_same_graph(found, name)
        placed = type(found)(**{**vars(found), "points": found.points @ turn.T})
        assert apart(placed, skeleton(name), name) < TURNED

    def test_scaled_and_moved(self, name):
        found = curve_skeleton(1e-3 * cloud(name) + 4.0)
        assert_same_graph(found, name)
        placed = type(found)(**{**vars(found), "points": (found.points - 4.0) * 1e3})
        assert apart(placed, skeleton(name), name) < TURNED

    def test_sampled_again(self, name):
        found = curve_skeleton(cloud(name, seed=5))
        assert_same_graph(found, name)
        assert apart(found, skeleton(name), name) < SAMPLED

    def test_decimated(self, name, request):
        if name == "double torus":
            reason = "at 2,500 points a dent between samples grows an end of its own"
            request.node.add_marker(pytest.mark.xfail(reason=reason, strict=True))
        found = curve_skeleton(cloud(name)[::2])
        assert_same_graph(found, name)
        assert apart(found, skeleton(name), name) < SAMPLED

    @pytest.mark.parametrize("noise", [0.002, 0.005])
    def test_with_noise(self, name, noise):
        found = curve_skeleton(TUBES[name]().sample(N, 0, noise))
        assert found.components == 1
        assert found.loops == TUBES[name]().loops
        assert apart(found, skeleton(name), name) < NOISY
