"""Memory of each rank, and bytes sent, for one cloud of uniform points: printed beside a model.

    mpirun -np 4 pvbatch --sym benchmarks/ranks.py 1000000
    mpirun -np 4 pvbatch --sym benchmarks/ranks.py 100000 torus
    mpirun -np 4 pvbatch --sym benchmarks/ranks.py 100000 uniform
    mpirun -np 4 pvbatch --sym benchmarks/ranks.py 1000000 curve

With the name of a cloud it tells what comes to the first rank when inside is told from outside; with `curve` points of
a surface are thinned and the first rank draws the curve skeleton of what is left, on one rank of all points. Run it
with `PYTHONPATH` naming `filters` and `TETRASKEL_NUMBA_PATH` a folder with numba. On one rank it measures the serial
chain. Each rank makes its own share of the cloud. What all hold before any point is measured after a small cloud,
which loads what is compiled.
"""

import resource
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from run import cloud

from dealt import torus, uniform
from tetraskel.distributed.communicator import together
from tetraskel.distributed.interior import interior_of_part
from tetraskel.distributed.mpi import MpiCommunicator
from tetraskel.distributed.thinning import thinned_on_ranks
from tetraskel.distributed.tree import build_tree_part
from tetraskel.distributed.triangulation import triangulate_part
from tetraskel.kernels.curve import curve_skeleton
from tetraskel.kernels.thinning import thinned
from tetraskel.kernels.tree import build_tree
from tetraskel.kernels.triangulate import ready_engine, triangulate
from tetraskel.options import InteriorOptions, ThinningOptions

FEW = 1000
CLOUDS = {"torus": torus, "uniform": uniform}


def megabytes():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def share(rank, size, n):
    """Points rank, rank + size, ... of n uniform ones."""
    return np.random.default_rng(0).random((n, 3))[rank::size].copy()  # or all of them would stay


def serial(n):
    build_tree(triangulate(share(0, 1, FEW), engine="exact"))
    started = time.perf_counter()
    base = megabytes()
    tree = build_tree(triangulate(share(0, 1, n), engine="exact"))
    spent = time.perf_counter() - started
    print(f"1 rank: {n} points, {len(tree)} cells, {tree.depth.max()} levels, {spent:.1f} s")
    print(f"  peak {megabytes():.0f} MB, of these {base:.0f} MB before any point")


def on_ranks(comm, n):
    few = share(comm.rank, comm.size, FEW)
    build_tree_part(comm, triangulate_part(comm, few, np.arange(comm.rank, FEW, comm.size)).part)
    comm.sent_bytes = comm.exchanges = 0
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


def inside_on_ranks(comm, n, name):
    points = CLOUDS[name](np.random.default_rng(0), n)[comm.rank :: comm.size].copy()
    part = triangulate_part(comm, points, np.arange(comm.rank, n, comm.size)).part
    before, peak, calls, started = comm.received_bytes, megabytes(), comm.exchanges, time.perf_counter()
    found = interior_of_part(comm, part, InteriorOptions())
    seconds, received = time.perf_counter() - started, (comm.received_bytes - before) / 1e6
    told = [received, len(part), len(part.halves), len(part.mesh.points), peak, megabytes(), found.inside.sum()]
    calls = comm.exchanges - calls
    rows = np.concatenate(comm.allgather(np.array([told], float)))
    if comm.rank == 0:
        cells, cuts, known = rows[:, 1:4].sum(axis=0)
        print(f"{comm.size} ranks: {n} points ({name}), {cells:.0f} cells, {rows[:, 6].sum() / cells:.0%} inside")
        print(f"  {found.messages}, {seconds:.1f} s, {calls} calls, {cuts:.0f} half facets on cuts")
        print(f"  the first rank received {rows[0, 0]:.2f} MB, the others at most {rows[1:, 0].max():.2f} MB")
        others = 32 * (known - rows[0, 3]) + 16 * (cells - rows[0, 1])
        print(f"  the mesh of the others, at 32 bytes a point and 16 a cell: {others / 1e6:.2f} MB")
        print(f"  peaks before and after, of the largest rank: {rows[:, 4].max():.0f} MB, {rows[:, 5].max():.0f} MB")


def curve(comm, n):
    """The curve skeleton of all points on one rank, of a twentieth of them on many."""
    few, options = cloud("surface", FEW), ThinningOptions(most_points=max(n // 20, FEW))
    curve_skeleton(few[thinned(few, most_points=FEW // 2).ids])
    base = megabytes()
    points = cloud("surface", n // comm.size, comm.rank)
    comm.sent_bytes, started = 0, time.perf_counter()
    if comm.size > 1:
        ids = np.arange(len(points)) * comm.size + comm.rank
        kept = np.isin(ids, thinned_on_ranks(comm, points, ids, options).ids)
        drawn_from = comm.gather(points[kept])
    else:
        drawn_from = points
    skeleton = curve_skeleton(drawn_from) if comm.rank == 0 else None
    told = np.array([[base, megabytes(), comm.sent_bytes / 1e6, time.perf_counter() - started]])
    rows = np.concatenate(comm.allgather(told))
    if comm.rank == 0:
        print(f"{comm.size} ranks: {n} points, {len(drawn_from)} drawn from, {rows[:, 3].max():.1f} s")
        print(f"  {skeleton.components} pieces, {skeleton.loops} loops, {len(skeleton.points)} points")
        print(f"  beyond what each held before: {', '.join(f'{row[1] - row[0]:.0f}' for row in rows)} MB")
        print(f"  sent: {rows[:, 2].sum():.1f} MB, {rows[:, 2].sum() * 1e6 / n:.1f} bytes a point")


def main():
    named = sys.argv[-1] if sys.argv[-1] in {*CLOUDS, "curve"} else ""
    n = int(sys.argv[-2 if named else -1])
    from mpi4py import MPI

    comm = MpiCommunicator(MPI.COMM_WORLD)
    ready_engine("exact", 3)
    if named == "curve":
        together(comm, lambda: curve(comm, n))
    elif named:
        together(comm, lambda: inside_on_ranks(comm, n, named))
    elif comm.size == 1:
        serial(n)
    else:
        together(comm, lambda: on_ranks(comm, n))


main()
