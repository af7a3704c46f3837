"""The skeleton of the same object turned, permuted, moved, resampled, decimated and with noise.

Distances are Hausdorff distances between skeletons, in percent of the diagonal of the object's box.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from checks import hausdorff
from tetraskel import curve_skeleton
from tubes import TUBES

N = 5000
TURNED = 1.0  # other roundings choose between nodes that are as good as each other
SAMPLED = 2.0  # a radius of these tubes is 5 to 10 %
FARTHEST = 6.0  # of those that are known to be farther apart
OBJECTS = ("capsule", "bent tube", "y", "torus", "double torus", "helix", "tree")
WAYS = {
    "sampled again": lambda tube: tube.sample(N, 5),
    "half of the points": lambda tube: tube.sample(N, 0)[::2],
    "noise 0.2 %": lambda tube: tube.sample(N, 0, 0.002),
    "noise 0.5 %": lambda tube: tube.sample(N, 0, 0.005),
}
# what falls short, as docs/curve.md has it
FALSE_ENDS = {
    ("double torus", "half of the points"): "1 end of 0: a dent between samples grows an end of its own",
    ("double torus", "noise 0.2 %"): "1 end of 0: a dent between samples grows an end of its own",
}
TOO_FAR = {
    ("double torus", "half of the points"): "5.5 %, the false end",
    ("double torus", "noise 0.2 %"): "5.4 %, the false end",
    ("helix", "sampled again"): "2.1 %: a line stops earlier at its end",
    ("helix", "noise 0.5 %"): "5.4 %: a line runs farther at its end",
    ("tree", "noise 0.2 %"): "3.7 %: a line runs farther at its end",
    ("tree", "noise 0.5 %"): "3.0 %: a line runs farther at its end",
}


def cases(short):
    """Each object in each way; those that fall short are marked, and the mark has to go when they no longer do."""
    return [
        pytest.param(name, way, marks=[pytest.mark.xfail(reason=short[name, way], strict=True)])
        if (name, way) in short
        else (name, way)
        for name in OBJECTS
        for way in WAYS
    ]


@cache
def cloud(name, seed=0):
    return TUBES[name]().sample(N, seed)


@cache
def skeleton(name):
    return curve_skeleton(cloud(name))


@cache
def in_another_way(name, way):
    return curve_skeleton(WAYS[way](TUBES[name]()))


def apart(first, second, name):
    """Hausdorff distance, in percent."""
    return 100 * hausdorff(first, second, 3000) / np.linalg.norm(np.ptp(cloud(name), axis=0))


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


@pytest.mark.parametrize(("name", "way"), cases(FALSE_ENDS))
def test_in_another_way_it_has_its_pieces_loops_and_ends(name, way):
    assert_same_graph(in_another_way(name, way), name)


@pytest.mark.parametrize(("name", "way"), cases(TOO_FAR))
def test_in_another_way_it_is_near(name, way):
    assert apart(in_another_way(name, way), skeleton(name), name) < SAMPLED


@pytest.mark.parametrize(("name", "way"), list(FALSE_ENDS | TOO_FAR))
def test_what_falls_short_keeps_pieces_and_loops_and_is_not_far(name, way):
    found = in_another_way(name, way)
    assert (found.components, found.loops) == (1, TUBES[name]().loops)
    assert apart(found, skeleton(name), name) < FARTHEST
