"""Memory of each rank, and bytes sent, for one cloud of uniform points: printed beside a model.

    mpirun -np 4 pvbatch --sym benchmarks/ranks.py 1000000

with `PYTHONPATH` naming `filters` and `TETRASKEL_NUMBA_PATH` a folder with numba. On one rank it measures the serial
chain. Each rank makes its own share of the cloud.
"""

import resource
import sys
import time

import numpy as np

from tetraskel.distributed.communicator import together
from tetraskel.distributed.mpi import MpiCommunicator
from tetraskel.distributed.tree import build_tree_part
from tetraskel.distributed.triangulation import triangulate_part
from tetraskel.kernels.tree import build_tree
from tetraskel.kernels.triangulate import ready_engine, triangulate


def megabytes():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def share(rank, size, n):
    """Points rank, rank + size, ... of n uniform ones."""
    return np.random.default_rng(0).random((n, 3))[rank::size] if n < 5_000_000 else None


def serial(n):
    started = time.perf_counter()
    base = megabytes()
    tree = build_tree(triangulate(share(0, 1, n), engine="exact"))
    spent = time.perf_counter() - started
    print(f"1 rank: {n} points, {len(tree)} cells, {tree.depth.max()} levels, {spent:.1f} s")
    print(f"  peak {megabytes():.0f} MB, of these {base:.0f} MB before any point")


def on_ranks(comm, n):
    base = megabytes()
    points = share(comm.rank, comm.size, n)
    started = time.perf_counter()
    found = triangulate_part(comm, points, np.arange(comm.rank, n, comm.size))
    seconds, triangulated = time.perf_counter() - started, (comm.sent_bytes, comm.exchanges)
    tree = build_tree_part(comm, found.part)
    told = np.array([[base, megabytes(), triangulated[0] / 1e6, (comm.sent_bytes - triangulated[0]) / 1e6,
                      len(found.part.halves), len(found.part), comm.exchanges, seconds]])  # fmt: skip
    rows = np.concatenate(comm.allgather(told))
    if comm.rank == 0:
        report(n, comm.size, rows, tree.forest.n_nodes)


def report(n, size, rows, n_cells):
    cut = rows[:, 4].sum()
    print(f"{size} ranks: {n} points, {n_cells} cells, {rows[:, 7].max():.1f} s to triangulate")
    print(f"  peak of the largest rank {rows[:, 1].max():.0f} MB, of these {rows[:, 0].max():.0f} MB before any point")
    sent = rows[:, 2:4].sum(axis=0)
    print(f"  sent to triangulate {sent[0]:.2f} MB, for the tree {sent[1]:.2f} MB, {rows[0, 6]:.0f} calls")
    print(f"  half facets on cuts {cut:.0f}, over n^(2/3): {cut / n ** (2 / 3):.2f}")
    model = 64 * n * (size - 1) / size / 1e6
    print(f"  model: points dealt once at 48 bytes and named at 16: {model:.2f} MB; the rest grows like the cuts")


def main():
    n = int(sys.argv[-1])
    from mpi4py import MPI

    comm = MpiCommunicator(MPI.COMM_WORLD)
    ready_engine("exact", 3)
    if comm.size == 1:
        serial(n)
    else:
        together(comm, lambda: on_ranks(comm, n))


main()
