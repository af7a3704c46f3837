"""The tree's skeleton block after block: the serial one, array for array, in less memory, and no file left behind."""

from __future__ import annotations

import errno
import mmap
import os
import subprocess
import sys
import tempfile
import threading
import time
import warnings

import numpy as np
import pytest

from dealt import box_shell, clustered, lattice, noisy, sphere, torus, uniform
from paths import ENVIRONMENT
from tetraskel import InsideWarning, assemble_skeleton, build_tree, interior, remove_flat, triangulate
from tetraskel.distributed import in_turn
from tetraskel.distributed.blockwise import POINTS_PER_BLOCK, BlockOptions, blocks_for, skeleton_in_blocks
from tetraskel.distributed.communicator import Route
from tetraskel.distributed.in_turn import run_in_turn
from tetraskel.distributed.shelf import SMALL, Shelf
from tetraskel.errors import Aborted, InputError, RankError
from tetraskel.kernels.compilation import numba_is_used
from tetraskel.kernels.mesh import submesh
from tetraskel.kernels.node_arrays import forest_arrays, simplex_arrays, skeleton_arrays

needs_numba = pytest.mark.skipif(not numba_is_used(), reason="numba is not installed (the extra fast)")


def float_scan(rng, n):
    return rng.random((n, 3)).astype(np.float32)


POINTS = {uniform: 400, clustered: 400, lattice: 216, sphere: 150, float_scan: 300}


@needs_numba
@pytest.mark.parametrize("n_blocks", [1, 2, 5, 8])
@pytest.mark.parametrize("cloud", POINTS, ids=lambda cloud: cloud.__name__)
def test_blocks_give_the_serial_skeleton(tmp_path, cloud, n_blocks):
    points = cloud(np.random.default_rng(n_blocks), POINTS[cloud])
    points = np.concatenate([points, points[:10]])
    options = BlockOptions(threshold=0.2, centre="incentre", keep_leaves=n_blocks == 2)
    found = skeleton_in_blocks(points, tmp_path, n_blocks, options)
    mesh = triangulate(points, engine="exact")
    assert_serial(found, mesh, options)
    assert found.facts["DuplicatesMerged"] == 10
    assert list(tmp_path.iterdir()) == []


def assert_serial(found, mesh, options, inside=None):
    """The skeleton is that of the mesh, or of its simplices inside, array for array."""
    tree = build_tree(mesh if inside is None else submesh(mesh, inside))
    kept = remove_flat(tree, threshold=options.threshold)
    skeleton = assemble_skeleton(kept, centre=options.centre, keep_leaves=options.keep_leaves)
    assert np.array_equal(found.points, skeleton.points)
    assert np.array_equal(found.offsets, skeleton.branch_offsets)
    assert np.array_equal(found.path, skeleton.branch_nodes)
    assert np.array_equal(found.lengths, skeleton.branch_lengths)
    assert np.array_equal(found.original_ids, mesh.original_ids)
    told = {} if inside is None else {"Inside": np.ones(len(kept), bool)}
    of_tree = {**forest_arrays(kept.forest), **told, **simplex_arrays(kept)}
    expected = {name: values[skeleton.node] for name, values in of_tree.items()} | skeleton_arrays(skeleton)
    assert list(found.nodes) == list(expected)
    for name, values in expected.items():
        assert np.array_equal(found.nodes[name], values), name
        assert found.nodes[name].dtype == values.dtype, name
    assert found.facts["FlatRemoved"] == len(tree) - len(kept)
    assert found.facts["Leaves"] == int(kept.is_leaf.sum())
    assert found.facts.get("InsideCells") == (None if inside is None else len(tree))


INSIDES = {torus: (1500, {}), box_shell: (400, {}), noisy: (500, {"noise": 2.0, "ratio": 1.5}), uniform: (300, {}),
           lattice: (216, {})}  # fmt: skip


@needs_numba
@pytest.mark.parametrize("n_blocks", [1, 3, 5])
@pytest.mark.parametrize("cloud", INSIDES, ids=lambda cloud: cloud.__name__)
def test_blocks_give_the_serial_skeleton_of_the_inside(tmp_path, cloud, n_blocks):
    n, gates = INSIDES[cloud]
    points = cloud(np.random.default_rng(n_blocks), n)
    options = BlockOptions(threshold=0.1, inside="gates", **gates)
    mesh = triangulate(points, engine="exact")
    expected, messages = warned(lambda: interior(mesh, **gates))
    assert expected.any() == (cloud not in (uniform, lattice))
    found, told = warned(lambda: skeleton_in_blocks(points, tmp_path, n_blocks, options))
    assert told == found.messages == messages
    assert_serial(found, mesh, options, expected)
    assert list(tmp_path.iterdir()) == []


def warned(work):
    """What a call returns, and what it warns of."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", InsideWarning)
        result = work()
    return result, [str(warning.message) for warning in caught]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"inside": "surface"}, "expected the inside all or gates for work in blocks, got 'surface'"),
        ({"inside": "gates", "ratio": 0.5}, "ratio must lie between"),
        ({"inside": "gates", "noise": -1.0}, "noise must lie between"),
    ],
    ids=lambda given: " ".join(given) if isinstance(given, dict) else "",
)
def test_an_inside_that_blocks_cannot_find_is_said(tmp_path, given, message):
    with pytest.raises(InputError, match=message):
        skeleton_in_blocks(np.zeros((9, 3)), tmp_path, 2, BlockOptions(**given))


@needs_numba
def test_one_tetrahedron_is_one_node_that_stands_alone(tmp_path):
    found = skeleton_in_blocks(np.concatenate([np.zeros((1, 3)), np.eye(3)]), tmp_path, 3)
    assert np.allclose(found.points, [[0.25, 0.25, 0.25]])
    assert np.array_equal(found.alone, [0])
    assert (len(found.lengths), len(found.path)) == (0, 0)


@needs_numba
@pytest.mark.parametrize(
    ("points", "message"),
    [
        (np.random.default_rng(0).random((50, 2)), "leave out the blocks"),
        (np.random.default_rng(0).random((50, 3)) * [1, 1, 0], "points of one plane"),
        (np.arange(12.0)[:, None] * np.ones(3), "one line"),
        (np.ones((5, 3)), "at least 3 distinct points"),
        (np.full((60, 3), np.nan), "with NaN"),
    ],
    ids=["flat table", "plane", "line", "one point", "nan"],
)
def test_what_cannot_be_cut_into_blocks_is_said(tmp_path, points, message):
    with pytest.raises(InputError, match=message):
        skeleton_in_blocks(points, tmp_path, 3)
    assert list(tmp_path.iterdir()) == []


@needs_numba
def test_nothing_but_flat_simplices_is_said(tmp_path):
    with pytest.raises(InputError, match="got none among"):
        skeleton_in_blocks(np.random.default_rng(0).random((40, 3)), tmp_path, 2, BlockOptions(threshold=1.0))


@needs_numba
@pytest.mark.parametrize(("inside", "when"), [("all", 0.1), ("gates", 0.1), ("gates", 0.62), ("gates", 0.69)])
def test_who_asks_to_stop_stops_and_nothing_stays(tmp_path, inside, when):
    """With an inside, also while the widths are measured and while the gates are followed."""
    before, shares = threading.active_count(), []

    def tick(share):
        shares.append(share)
        if share > when:
            raise Aborted("stopped on request.")

    with pytest.raises(Aborted, match=r"^stopped on request"):
        skeleton_in_blocks(torus(np.random.default_rng(0), 500), tmp_path, 4, BlockOptions(inside=inside), tick)
    assert shares == sorted(shares)
    assert next(share for share in shares if share > when) < 0.75  # before the tree
    assert list(tmp_path.iterdir()) == []
    assert threading.active_count() == before


def test_an_interrupt_ends_all_blocks(tmp_path, monkeypatch):
    """Ctrl-C comes to the thread that waits for the blocks."""
    waits = iter([KeyboardInterrupt()])
    wait_for = in_turn.joined.__globals__["_wait_for"]

    def interrupted(threads):
        for error in waits:
            time.sleep(0.05)
            raise error
        wait_for(threads)

    monkeypatch.setitem(in_turn.joined.__globals__, "_wait_for", interrupted)

    def endless(comm):
        while True:
            comm.total(1)

    before = threading.active_count()
    with pytest.raises(KeyboardInterrupt):
        run_in_turn(3, endless, tmp_path)
    assert threading.active_count() == before


def test_a_failure_in_one_block_is_the_failure_of_all(tmp_path):
    heard = []

    def work(comm):
        try:
            for turn in range(4):
                if (turn, comm.rank) == (2, 1):
                    raise InputError("expected sense, got none.")
                comm.total(turn)
        except Exception as error:
            heard.append(str(error))
            raise

    with pytest.raises(InputError, match="expected sense"):
        run_in_turn(3, work, tmp_path)
    assert sorted(heard) == ["expected sense, got none."] + ["rank 1: expected sense, got none."] * 2


def test_a_block_that_ends_without_a_word_is_missed(tmp_path, monkeypatch):
    def work(comm):
        if comm.rank == 1:
            monkeypatch.setattr(comm, "fail", lambda error: None)
            raise InputError("expected sense, got none.")
        comm.total(1)

    with pytest.raises(InputError, match="expected sense"):
        run_in_turn(3, work, tmp_path)

    def others(comm):
        if comm.rank == 1:
            comm.fail = lambda error: None
            raise InputError("rank 9: last of all")
        comm.total(1)

    with pytest.raises(RankError, match="ended without a word"):
        run_in_turn(2, others, tmp_path)


def test_only_one_block_works_at_a_time(tmp_path):
    busy = []

    def work(comm):
        for _ in range(5):
            busy.append(comm.rank)
            time.sleep(0.001)
            assert busy[-1] == comm.rank
            comm.total(1)

    run_in_turn(4, work, tmp_path)
    assert busy == [0, 1, 2, 3] * 5


def test_large_messages_arrive_and_cannot_be_changed_by_who_sent_them(tmp_path):
    n = SMALL  # numbers of eight bytes

    def work(comm):
        rows = np.full(n, comm.rank)
        route = Route(comm, np.arange(n) % comm.size)
        received = route.forward(rows)
        small = np.full(1, comm.rank)
        everybody = comm.allgather(small)
        rows[:] = small[:] = -1
        return route.back(received * 10), np.concatenate(everybody)

    for rank, (rows, everybody) in enumerate(run_in_turn(3, work, tmp_path)):
        assert (rows == rank * 10).all()
        assert np.array_equal(everybody, [0, 1, 2])


def test_arrays_on_a_shelf_are_the_same_and_can_be_written_to(tmp_path):
    shelf = Shelf(tmp_path)
    rng = np.random.default_rng(0)
    given = [rng.random((SMALL, 3)), rng.integers(0, 9, 5).astype(np.int8), np.empty((0, 4)), rng.random(7) > 0.5]
    kept = shelf.put(*given)
    shelf.leave()
    for array, original in zip(kept, given, strict=True):
        assert array.dtype == original.dtype
        assert np.array_equal(array, original)
    kept[0][5] = 7.0
    shelf.leave()
    assert (kept[0][5] == 7.0).all()
    zeros, none = shelf.room(((SMALL, 2), np.int32), ((0,), np.float64))
    assert (zeros == 0).all()
    assert (zeros.shape, none.shape) == ((SMALL, 2), (0,))
    assert list(tmp_path.iterdir()) == []  # the files have no names


def test_a_full_disk_is_said(tmp_path):
    resource = pytest.importorskip("resource")
    script = (
        "import resource, signal, numpy as np; from pathlib import Path\n"
        "from tetraskel.distributed.shelf import Shelf\n"
        "from tetraskel.errors import InputError\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN); resource.setrlimit(resource.RLIMIT_FSIZE, (100000, 100000))\n"
        f"shelf = Shelf(Path({str(tmp_path)!r}))\n"
        "for fill in (lambda: shelf.put(np.ones(100000)), lambda: shelf.room(((100000,), float))):\n"
        "    try: fill()\n"
        "    except InputError as error: print(error)\n"
    )
    assert resource
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, env=ENVIRONMENT)
    assert done.stdout.count("expected room for the blocks") == 2
    assert done.stdout.count("make room for it there") == 2


def test_a_file_or_a_mapping_that_the_system_refuses_is_said(tmp_path, monkeypatch):
    def refuse(*arguments, **more):
        raise OSError(errno.ENOMEM, os.strerror(errno.ENOMEM))

    shelf = Shelf(tmp_path)
    for module, name in ((mmap, "mmap"), (tempfile, "TemporaryFile")):
        with monkeypatch.context() as patched:
            patched.setattr(module, name, refuse)
            with pytest.raises(InputError, match=f"expected room for the blocks .*{os.strerror(errno.ENOMEM)}"):
                shelf.put(np.ones(SMALL))


def test_the_number_of_blocks_grows_with_the_points():
    assert [blocks_for(n) for n in (0, 1, POINTS_PER_BLOCK, POINTS_PER_BLOCK + 1)] == [1, 1, 1, 2]


MEMORY = """
import sys
import numpy as np
from pathlib import Path
from tetraskel import assemble_skeleton, build_tree, remove_flat, triangulate
from tetraskel.distributed.blockwise import skeleton_in_blocks
cloud = np.load(sys.argv[1], mmap_mode="r")
few, folder = np.random.default_rng(1).random((500, 3)), Path(sys.argv[2])
told = lambda name: int(Path("/proc/self/status").read_text().partition(name)[2].split()[0])
skeleton_in_blocks(few, folder, 2)  # loads what is compiled
assemble_skeleton(remove_flat(build_tree(triangulate(few, engine="exact"))))
Path("/proc/self/clear_refs").write_text("5")  # the peak begins anew
before = told("VmRSS:")
if sys.argv[3] == "serial":
    assemble_skeleton(remove_flat(build_tree(triangulate(cloud, engine="exact"))))
else:
    skeleton_in_blocks(cloud, folder, int(sys.argv[3]))
print(told("VmHWM:") - before)
"""


@needs_numba
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="memory is measured as Linux counts it")
def test_blocks_take_much_less_memory(tmp_path):
    """What a process comes to hold beyond what it holds after a small cloud."""
    np.save(tmp_path / "cloud.npy", np.random.default_rng(0).random((30_000, 3)))

    def peak(how):
        call = [sys.executable, "-c", MEMORY, str(tmp_path / "cloud.npy"), str(tmp_path), how]
        return int(subprocess.run(call, capture_output=True, text=True, check=True, env=ENVIRONMENT).stdout)

    assert peak("5") < 0.5 * peak("serial")
