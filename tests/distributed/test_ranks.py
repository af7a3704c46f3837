"""One triangulation and one tree on many ranks (threads here): the serial ones, array for array."""

from __future__ import annotations

import threading
import time
from itertools import pairwise

import numpy as np
import pytest

from dealt import clustered, cylinder, dealt, lattice, sphere, torus, turned_lattice, uniform
from tetraskel import assemble_skeleton, build_tree, remove_flat, triangulate
from tetraskel.distributed.communicator import Route, together
from tetraskel.distributed.flat import contract_part
from tetraskel.distributed.in_process import run_on_ranks
from tetraskel.distributed.numbering import owners_of, sums_before
from tetraskel.distributed.parts import part_of_mesh
from tetraskel.distributed.skeleton import lines_of, skeleton_part
from tetraskel.distributed.space import fills_space
from tetraskel.distributed.tree import build_tree_part
from tetraskel.distributed.triangulation import triangulate_part
from tetraskel.errors import Aborted, InputError, MeshError, RankError
from tetraskel.kernels.adjacency import triangulation_of
from tetraskel.kernels.centres import centres
from tetraskel.kernels.compilation import numba_is_used
from tetraskel.kernels.mesh import submesh
from tetraskel.kernels.plane import roundings_by_axis
from tetraskel.kernels.quality import qualities

needs_numba = pytest.mark.skipif(not numba_is_used(), reason="numba is not installed (the extra fast)")
FOREST = ("parent", "depth", "son_rank", "son_count", "subtree_size", "tree_id")


POINTS = {  # of the clouds; where all points are nearly cospherical every rank asks about most cells
    uniform: 500,
    clustered: 500,
    lattice: 343,
    turned_lattice: 216,
    sphere: 150,
    cylinder: 250,
    torus: 400,
}


def in_order(results, key, values):
    """Arrays of all ranks, one after another, sorted by a key."""
    order = np.argsort(np.concatenate([key(result) for result in results]))
    return np.concatenate([values(result) for result in results])[order]


def assert_forest(results, forest):
    """The parts are the serial forest, array for array."""
    number = in_order(results, lambda part: part.number, lambda part: part.number)
    assert np.array_equal(number, np.arange(len(forest)))
    for name in FOREST:
        found = in_order(results, lambda part: part.number, lambda part, name=name: getattr(part, name))
        assert np.array_equal(found, getattr(forest, name)), name


@needs_numba
@pytest.mark.parametrize("size", [1, 2, 3, 4, 8])
@pytest.mark.parametrize("cloud", POINTS, ids=lambda cloud: cloud.__name__)
def test_the_chain_on_ranks_is_the_serial_one(cloud, size):
    rng = np.random.default_rng(size)
    points = cloud(rng, POINTS[cloud])
    points = np.concatenate([points, points[:10]])  # some points twice
    mesh = triangulate(points, engine="exact")
    tree = build_tree(mesh)
    kept = remove_flat(tree, threshold=0.3)
    skeleton = assemble_skeleton(kept)
    owner = dealt(points, size, "random" if size % 2 else "space", rng)

    def work(comm):
        mine = np.flatnonzero(owner == comm.rank)
        found = triangulate_part(comm, points[mine], mine)
        walked = build_tree_part(comm, found.part)
        flat = (qualities(found.part.mesh) < 0.3)[walked.cell]
        forest, rows = contract_part(comm, walked.forest, flat)
        drawn = skeleton_part(comm, forest)
        places = centres(found.part.mesh)[walked.cell[rows]][drawn.node]
        return found, walked, forest, walked.cell[rows], drawn, lines_of(comm, drawn, places)

    results = run_on_ranks(size, work)
    found, walked, forests, cells, drawn, lines = zip(*results, strict=True)
    parts = [one.part for one in found]
    assert np.array_equal(np.concatenate([part.point_ids[part.mesh.simplices] for part in parts]), mesh.simplices)
    assert np.array_equal(np.concatenate([part.cell_ids for part in parts]), np.arange(len(mesh)))
    assert_points(found, mesh, owner)
    assert_forest([one.forest for one in walked], tree.forest)
    named = [part.cell_ids[one.cell] for part, one in zip(parts, walked, strict=True)]
    order = np.argsort(np.concatenate([one.forest.number for one in walked]))
    assert np.array_equal(np.concatenate(named)[order], tree.cell)
    assert_forest(forests, kept.forest)
    named = [part.cell_ids[own] for part, own in zip(parts, cells, strict=True)]
    order = np.argsort(np.concatenate([forest.number for forest in forests]))
    assert np.array_equal(np.concatenate(named)[order], kept.cell)
    assert_skeleton(drawn, lines, skeleton)


def assert_points(found, mesh, owner):
    """Each point is owned once, and who brought it is known."""
    ids = np.concatenate([one.part.point_ids[one.owned] for one in found])
    assert np.array_equal(np.sort(ids), np.arange(len(mesh.points)))
    for one in found:
        assert np.array_equal(one.part.mesh.points, mesh.points[one.part.point_ids])
        assert np.array_equal(one.origins[:, 0], mesh.original_ids[one.part.point_ids])
        assert np.array_equal(one.origins[:, 1], owner[one.origins[:, 0]])
        assert (one.n_input, one.n_distinct) == (len(mesh.point_map), len(mesh.points))


def assert_skeleton(drawn, lines, skeleton):
    for name in ("parent", "degree", "node_type", "branch_id"):
        values = in_order(drawn, lambda part: part.index, lambda part, name=name: getattr(part, name))
        assert np.array_equal(values, getattr(skeleton, name)), name
    edges, lengths = [], {}
    for part, line in zip(drawn, lines, strict=True):
        ids = np.concatenate([part.index, line.ghosts.ids])
        assert np.array_equal(line.points, skeleton.points[ids])
        for start, stop, branch, length in zip(
            line.offsets[:-1], line.offsets[1:], line.branch_id, line.lengths, strict=True
        ):
            path = ids[line.nodes[start:stop]]
            edges += [(above, below, branch) for above, below in pairwise(path)]
            lengths[branch] = length
    sons = np.flatnonzero(skeleton.parent >= 0)
    assert sorted(edges) == sorted(zip(skeleton.parent[sons], sons, skeleton.branch_id[sons], strict=True))
    assert np.allclose([lengths[branch] for branch in sorted(lengths)], skeleton.branch_lengths, rtol=1e-12)


def part_of(comm, mesh, owner):
    """The simplices of one rank as a mesh of their own."""
    cells = np.flatnonzero(owner == comm.rank)
    used = np.unique(mesh.simplices[cells])
    return part_of_mesh(
        comm, triangulation_of(mesh.points[used], np.searchsorted(used, mesh.simplices[cells])), used, cells
    )


@pytest.mark.parametrize("size", [1, 2, 5])
def test_a_mesh_in_pieces_gives_the_serial_trees(size):
    """Cells are dealt at random here, so almost every facet is a cut; pieces lie on several ranks."""
    rng = np.random.default_rng(size)
    mesh = triangulate(rng.random((300, 3)), engine="auto")
    checkers = np.floor(4 * centres(mesh)).astype(int).sum(axis=1) % 2 == 0
    mesh = submesh(mesh, checkers)
    tree = build_tree(mesh)
    kept = remove_flat(tree, threshold=0.6)
    owner = rng.integers(0, size, len(mesh))

    def work(comm):
        part = part_of(comm, mesh, owner)
        walked = build_tree_part(comm, part)
        flat = (qualities(part.mesh) < 0.6)[walked.cell]
        return walked.forest, contract_part(comm, walked.forest, flat)[0]

    results = run_on_ranks(size, work)
    assert tree.tree_id.max() > 2
    assert_forest([whole for whole, _ in results], tree.forest)
    assert_forest([rest for _, rest in results], kept.forest)


def test_facets_of_three_cells_are_refused_on_all_ranks():
    points = np.concatenate([np.zeros((1, 3)), np.eye(3), -np.eye(3)])
    cells = np.array([[0, 1, 2, 3], [0, 1, 2, 5], [0, 1, 2, 6]])
    messages = []

    def work(comm):
        try:
            used = np.unique(cells[comm.rank])
            mesh = triangulation_of(points[used], np.searchsorted(used, cells[[comm.rank]]))
            together(comm, lambda: part_of_mesh(comm, mesh, used))
        except (MeshError, RankError) as error:
            messages.append(str(error))
            raise

    with pytest.raises(MeshError, match="shared by at most two simplices"):
        run_on_ranks(3, work)
    assert len(messages) == 3
    assert all("at most two simplices" in message for message in messages)


def test_a_failure_on_one_rank_is_told_to_all_and_nobody_waits():
    heard = {}

    def work(comm):
        try:
            for turn in range(5):
                if turn == 3 and comm.rank == 1:
                    raise InputError("expected sense, got none.")
                comm.total(turn)
        except Exception as error:
            heard[comm.rank] = error
            raise

    started = time.monotonic()
    with pytest.raises(InputError, match="expected sense"):
        run_on_ranks(4, work)
    assert time.monotonic() - started < 5
    assert {rank for rank, error in heard.items() if isinstance(error, RankError)} == {0, 2, 3}
    assert str(heard[0]) == "rank 1: expected sense, got none."


def test_who_asks_to_stop_stops_all():
    def work(comm):
        if comm.rank == 0:
            raise Aborted("stopped on request.")
        with pytest.raises(Aborted, match="rank 0: stopped"):
            comm.agree()
        comm.agree()  # to go on is to hear it again, not to wait

    with pytest.raises(Aborted, match=r"^stopped on request"):
        run_on_ranks(2, work)


def test_a_rank_that_ends_without_a_word_is_missed():
    """What a killed process is between threads: nobody may wait for it."""

    def work(comm):
        if comm.rank == 1:
            comm.board.barrier.abort()
            return
        comm.agree()

    started = time.monotonic()
    with pytest.raises(RankError, match="ended without a word"):
        run_on_ranks(3, work)
    assert time.monotonic() - started < 5
    assert threading.active_count() < 10


@needs_numba
def test_points_that_are_not_finite_are_named_by_their_rank():
    points = np.random.default_rng(0).random((100, 3))
    points[70] = np.nan

    def work(comm):
        mine = np.arange(comm.rank * 25, comm.rank * 25 + 25)
        triangulate_part(comm, points[mine], mine)

    with pytest.raises(InputError, match="1 of 25 points with NaN"):
        run_on_ranks(4, work)


@needs_numba
@pytest.mark.parametrize("flat", ["level", "tilted"])
def test_points_of_a_plane_are_recognised_and_refused(flat):
    points = np.random.default_rng(0).random((60, 3))
    points[:, 2] = 0 if flat == "level" else points[:, 0] + 2 * points[:, 1]

    def fills(comm):
        mine = points[comm.rank :: 3]
        return fills_space(comm, mine, roundings_by_axis(mine))

    assert not any(run_on_ranks(3, fills))
    points[7, 2] += 0.1
    assert all(run_on_ranks(3, fills))
    points = np.round(points)
    points[:, 2] = points[:, 0] + points[:, 1]
    with pytest.raises(InputError, match="got points of one plane"):
        run_on_ranks(3, lambda comm: triangulate_part(comm, points[comm.rank :: 3], np.arange(60)[comm.rank :: 3]))


def test_sums_along_a_sequence_that_is_dealt_out():
    rng = np.random.default_rng(0)
    owner, weights = rng.integers(0, 3, 50), rng.integers(0, 5, 50)

    def work(comm):
        mine = np.flatnonzero(owner == comm.rank)
        return sums_before(comm, 7 + mine, weights[mine], 7, 57)

    expected = np.cumsum(weights) - weights
    for rank, (sums, total) in enumerate(run_on_ranks(3, work)):
        assert total == weights.sum()
        assert np.array_equal(sums, expected[owner == rank])


def test_who_has_a_number():
    rng = np.random.default_rng(0)
    owner, wanted = np.sort(rng.integers(0, 4, 90)), rng.integers(0, 90, 40)
    owner[30:40] = rng.integers(0, 4, 10)
    found = run_on_ranks(4, lambda comm: owners_of(comm, np.flatnonzero(owner == comm.rank), wanted, 90))
    assert all(np.array_equal(ranks, owner[wanted]) for ranks in found)


def test_rows_come_back_to_who_sent_them():
    def work(comm):
        destination = np.random.default_rng(comm.rank).integers(0, comm.size, 20)
        rows = 100 * comm.rank + np.arange(20)
        route = Route(comm, destination)
        received = route.forward(rows)
        assert np.array_equal(received // 100, route.source)
        return np.array_equal(route.back(2 * received), 2 * rows)

    assert all(run_on_ranks(3, work))
