"""Fewer points: where they are kept, and what the curve skeleton makes of them."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from tetraskel import InputError, curve_skeleton, thinned, triangulate
from tetraskel.errors import Aborted
from tetraskel.kernels.curve_skeleton import Skeleton
from tetraskel.kernels.octree import DEEPEST, WITHIN, Octree
from tetraskel.kernels.poles import pole_distances

sys.path.append(str(Path(__file__).parents[1]))
from checks import hausdorff
from shapes import SOLIDS, on_sphere
from tubes import TUBES, around, distance_to, line

Floats = NDArray[np.float64]
NAMES = sorted(name for name in TUBES if TUBES[name]().sample(10).shape[1] == 3)


def ends(skeleton: Skeleton) -> int:
    return int((skeleton.node_degree == 1).sum())


class TestPoints:
    @pytest.mark.parametrize("cloud", ["y", "lattice", "volume", "plane", "outline"])
    def test_every_point_is_near_a_kept_one(self, cloud: str) -> None:
        rng = np.random.default_rng(0)
        grid = np.stack(np.meshgrid(*[np.arange(17.0)] * 3), -1).reshape(-1, 3)
        clouds = {
            "y": TUBES["y"]().sample(5000, rng),
            "lattice": grid,
            "volume": rng.random((5000, 3)),
            "plane": np.column_stack([rng.random((5000, 2)), np.zeros(5000)]),
            "outline": TUBES["annulus"]().sample(5000, rng),
        }
        points = clouds[cloud]
        found = thinned(points, most_points=1200)
        assert 200 < len(found) <= 1200
        assert (np.diff(found.ids) > 0).all()
        away = np.sqrt(((points[:, None] - points[None, found.ids]) ** 2).sum(axis=2))
        assert (away - np.sqrt(points.shape[1]) * found.spacing).min(axis=1).max() <= 0

    def test_the_order_of_the_points_does_not_matter(self) -> None:
        rng = np.random.default_rng(0)
        points = np.concatenate([TUBES["helix"]().sample(6000, rng), np.zeros((5, 3))])
        expected = thinned(points, most_points=1500)
        order = rng.permutation(len(points))
        found = thinned(points[order], most_points=1500)
        assert np.array_equal(np.sort(points[order][found.ids], axis=0), np.sort(points[expected.ids], axis=0))
        for unit in (2.0**-300, 1024.0, 2.0**300):
            assert np.array_equal(thinned(unit * points, most_points=1500).ids, expected.ids)

    @pytest.mark.parametrize("name", ["torus", "capsule"])
    def test_points_are_as_close_as_asked(self, name: str) -> None:
        tube = TUBES[name]()
        points = tube.sample(40_000, np.random.default_rng(0))
        for samples in (3.0, 6.0):
            found = thinned(points, most_points=20_000, samples_per_radius=samples)
            assert found.n_coarse < 0.02 * len(found)
            assert found.spacing.max() <= 1.1 * tube.radii[0] / samples

    def test_thin_parts_keep_more(self) -> None:
        rng = np.random.default_rng(0)
        ball = 2 * on_sphere(30_000, rng)
        twig = around(line((2, 0, 0), (4, 0, 0)), 0.1, 10_000, rng)
        points = np.concatenate([ball[distance_to(line((0, 0, 0), (4, 0, 0)), ball) > 0.1], twig])
        found = thinned(points, most_points=8000)
        on_twig = np.isin(points[found.ids], twig).all(axis=1)
        assert np.median(found.spacing[on_twig]) < 0.2 * np.median(found.spacing[~on_twig])
        assert curve_skeleton(points[found.ids]).points[:, 0].max() > 3.8

    def test_a_small_part_beside_a_large_one_is_seen(self) -> None:
        rng = np.random.default_rng(0)
        small = 0.03 * TUBES["torus"]().sample(30_000, rng) + [1.5, 0, 0]
        found = thinned(np.concatenate([on_sphere(30_000, rng), small]), most_points=20_000)
        kept = small[found.ids[found.ids >= 30_000] - 30_000]
        assert len(kept) > 2000
        assert curve_skeleton(kept).loops == 1

    @pytest.mark.parametrize("radius", [0.003, 0.5])
    def test_a_wire_thinner_than_the_first_cells_is_seen(self, radius: float) -> None:
        rng = np.random.default_rng(0)
        wire = around(line((1, 0, 0), (1 + 400 * radius, 0, 0)), radius, 40_000, rng)
        found = thinned(np.concatenate([on_sphere(20_000, rng), wire]), most_points=20_000)
        on_wire = found.ids >= 20_000
        assert on_wire.sum() > 8000
        assert np.median(found.spacing[on_wire]) < radius

    @pytest.mark.parametrize("shape", [(1000, 4, 4), (400, 7, 7), (2000, 4)])
    def test_bars_of_a_lattice(self, shape: tuple[int, ...]) -> None:
        """Of every cell the same edge is kept, all on one line, at first."""
        axes = [np.arange(float(side)) for side in shape]
        bar = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, len(shape))
        assert 50 < len(thinned(bar, most_points=100)) <= 100

    def test_a_point_far_away_is_told_or_does_no_harm(self) -> None:
        ball = on_sphere(20_000, np.random.default_rng(0))
        found = thinned(np.concatenate([ball, [[1e4, 0, 0]]]), most_points=2000)
        assert len(found) > 500
        with pytest.raises(InputError, match="20000 of 20001 points within some millionths of it; remove"):
            thinned(np.concatenate([ball, [[1e7, 0, 0]]]), most_points=2000)

    def test_few_points_are_kept_as_they_are(self) -> None:
        found = thinned(on_sphere(500, np.random.default_rng(0)), most_points=500)
        assert np.array_equal(found.ids, np.arange(500))
        assert not found.spacing.any()

    def test_what_was_asked_is_not_exceeded_and_what_is_missing_is_told(self) -> None:
        points = TUBES["tree"]().sample(30_000, np.random.default_rng(0))
        found = thinned(points, most_points=2000)
        assert 1500 < len(found) <= 2000
        assert found.n_coarse > 500

    def test_many_equal_points(self) -> None:
        points = np.repeat(on_sphere(300, np.random.default_rng(0)), 20, axis=0)
        found = thinned(points, most_points=1000)
        assert 240 < len(found) <= 300
        assert (found.ids % 20 == 0).all()  # the first of each

    def test_a_file_is_enough(self, tmp_path: Path) -> None:
        points = TUBES["torus"]().sample(3000, np.random.default_rng(0)).astype(np.float32)
        np.save(tmp_path / "points.npy", points)
        mapped = np.load(tmp_path / "points.npy", mmap_mode="r")
        assert np.array_equal(thinned(mapped, most_points=800).ids, thinned(points, most_points=800).ids)


class TestSkeleton:
    """From a quarter of the points; the bound is that of the tests of stability, 2 % of the diagonal."""

    @pytest.mark.parametrize("name", NAMES)
    def test_the_skeleton_is_about_the_same(self, name: str) -> None:
        points = TUBES[name]().sample(16_000, np.random.default_rng(0))
        expected = curve_skeleton(points)
        found = curve_skeleton(points[thinned(points, most_points=4000).ids])
        assert (found.components, found.loops, ends(found)) == (expected.components, expected.loops, ends(expected))
        assert hausdorff(found, expected, 3000) < 0.02 * np.linalg.norm(np.ptp(points, axis=0))

    def test_a_narrow_gap_stays_open(self) -> None:
        rng = np.random.default_rng(0)
        points = np.concatenate([on_sphere(20_000, rng), on_sphere(20_000, rng) + [2.1, 0, 0]])
        found = thinned(points, most_points=8000)
        assert len(found) < 8000
        assert curve_skeleton(points[found.ids]).components == 2

    def test_a_shell_keeps_its_cavity(self) -> None:
        points = SOLIDS["shell"]().sample(30_000, np.random.default_rng(0))
        found = curve_skeleton(points[thinned(points, most_points=8000).ids])
        assert found.cavities == 1


class TestPoles:
    @pytest.mark.parametrize("dim", [2, 3])
    def test_those_of_a_ball_are_its_centre(self, dim: int) -> None:
        ways = np.random.default_rng(0).normal(size=(2000, dim))
        points = 3 * ways / np.linalg.norm(ways, axis=1, keepdims=True) + 5
        assert np.allclose(pole_distances(triangulate(points)), 3, rtol=1e-6)

    def test_those_of_a_tube_are_on_its_axis(self) -> None:
        tube = TUBES["torus"]()
        points = tube.sample(8000, np.random.default_rng(0))
        found = pole_distances(triangulate(points))
        assert np.abs(np.median(found) / tube.radii[0] - 1) < 0.02


class TestOctree:
    @pytest.mark.parametrize("dim", [2, 3])
    def test_leaves_hold_their_points(self, dim: int) -> None:
        rng = np.random.default_rng(0)
        points = rng.random((3000, dim))
        octree = Octree(np.zeros(dim), 1.0, 1)
        for _ in range(5):
            leaf = octree.located(points).leaf
            octree = octree.with_divided(np.unique(leaf[:40]))
        leaf, octant, away, within = octree.located(points)
        assert len(np.unique(octree.levels(leaf))) > 3
        assert (np.sqrt(away) <= 0.5 * np.sqrt(dim) * octree.sides(leaf) + 1e-12).all()
        for one in np.unique(leaf):
            mine = points[leaf == one]
            assert (np.ptp(mine, axis=0) <= octree.sides(np.array([one]))[0]).all()
        assert set(octant) == set(range(2**dim))
        assert (within >= 0).all()
        assert (within < 2**WITHIN).all()
        halves = within >> (WITHIN - 1)
        assert np.array_equal(halves @ (1 << np.arange(dim)[::-1]), octant)

    def test_the_farthest_corner_is_in_it(self) -> None:
        octree = Octree(np.zeros(3), 1.0, 2)
        for _ in range(DEEPEST - 2):
            octree = octree.with_divided(octree.located(np.ones((1, 3))).leaf)
        leaf = octree.located(np.ones((1, 3))).leaf
        assert octree.levels(leaf)[0] == DEEPEST
        assert leaf[0] == 2 ** (3 * DEEPEST + 1) - 1


class TestBadInput:
    @pytest.mark.parametrize(("options", "message"), [({"most_points": 3}, "most_points"),
                                                      ({"samples_per_radius": 0.1}, "samples_per_radius")])  # fmt: skip
    def test_options_out_of_bounds(self, options: dict, message: str) -> None:
        with pytest.raises(InputError, match=message):
            thinned(on_sphere(500, np.random.default_rng(0)), **options)

    def test_points_that_are_not_finite_are_counted(self) -> None:
        points = on_sphere(5000, np.random.default_rng(0))
        points[::1000] = np.nan
        with pytest.raises(InputError, match="got 5 of 5000 points with NaN"):
            thinned(points, most_points=1000)

    def test_abort_passes_through(self) -> None:
        def stop(share: float) -> None:
            raise Aborted("stopped")

        with pytest.raises(Aborted):
            thinned(TUBES["torus"]().sample(20_000), most_points=5000, tick=stop)

    def test_progress_only_grows_to_its_end(self) -> None:
        shares: list[float] = []
        thinned(TUBES["torus"]().sample(20_000), most_points=5000, tick=shares.append)
        assert shares == sorted(shares)
        assert 0 <= shares[0] <= shares[-1] <= 1
