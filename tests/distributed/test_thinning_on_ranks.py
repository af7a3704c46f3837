"""Thinning of points on many ranks (threads here): the serial answer, id for id."""

from __future__ import annotations

import numpy as np
import pytest

import tubes
from dealt import dealt
from tetraskel import InputError, thinned
from tetraskel.distributed.in_process import run_on_ranks
from tetraskel.distributed.thinning import first_with_each, thinned_on_ranks
from tetraskel.errors import RankError
from tetraskel.options import ThinningOptions

OPTIONS = ThinningOptions(most_points=1500)


def lattice_shell(rng):
    """Many points as far from the middle of their leaf as others, and many equal ones."""
    grid = np.stack(np.meshgrid(*[np.arange(33.0)] * 3), -1).reshape(-1, 3)
    shell = grid[((grid == 0) | (grid == 32)).any(axis=1)]
    return rng.permutation(np.concatenate([shell, shell[:500]]))


CLOUDS = {
    "y": lambda rng: tubes.y_tube().sample(6000, rng),
    "torus": lambda rng: tubes.torus().sample(6000, rng).astype(np.float32),
    "lattice": lattice_shell,
    "plane": lambda rng: np.column_stack([rng.random((4000, 2)), np.zeros(4000)]),
}


@pytest.mark.parametrize("size", [1, 2, 3, 4, 8])
@pytest.mark.parametrize("name", CLOUDS)
def test_ranks_keep_the_points_that_one_keeps(name, size):
    rng = np.random.default_rng(size)
    points = CLOUDS[name](rng)
    expected = thinned(points, most_points=1500)
    assert 100 < len(expected) <= 1500
    for by in ("random", "space"):
        owner = dealt(points.astype(float), size, by, rng)

        def work(comm, owner=owner):
            copied = np.arange(len(points)) % 40 == 0  # on every rank
            mine = np.flatnonzero((owner == comm.rank) | copied)
            mine = mine[first_with_each(comm, mine)]
            return thinned_on_ranks(comm, points[mine], mine, OPTIONS)

        for found in run_on_ranks(size, work):
            assert np.array_equal(found.ids, expected.ids)
            assert np.array_equal(found.spacing, expected.spacing)
            assert found.n_coarse == expected.n_coarse


def test_what_ranks_receive_does_not_grow_with_the_cloud():
    received = []
    for n in (20_000, 80_000):
        points = tubes.torus().sample(n, np.random.default_rng(0))

        def work(comm, points=points):
            mine = np.arange(comm.rank, len(points), comm.size)
            kept = thinned_on_ranks(comm, points[mine], mine, OPTIONS)
            return comm.received_bytes, len(kept)

        found = run_on_ranks(4, work)
        received.append(max(size for size, _ in found))
        assert found[0][1] <= 1500
    assert received[1] < 1.1 * received[0]
    assert received[0] < 24 * 20_000


def test_few_points_are_all_kept():
    points = tubes.torus().sample(900, np.random.default_rng(0))
    shares = np.array_split(np.arange(900), 3)
    for found in run_on_ranks(
        3, lambda comm: thinned_on_ranks(comm, points[shares[comm.rank]], shares[comm.rank], OPTIONS)
    ):
        assert np.array_equal(found.ids, np.arange(900))
        assert not found.spacing.any()


def test_a_point_that_is_not_finite_on_one_rank_fails_all():
    points = tubes.torus().sample(4000, np.random.default_rng(0))
    points[3999] = np.nan

    def work(comm):
        mine = np.arange(4000)[comm.rank :: 2]
        return thinned_on_ranks(comm, points[mine], mine, OPTIONS)

    with pytest.raises((InputError, RankError), match="expected finite coordinates"):
        run_on_ranks(2, work)
