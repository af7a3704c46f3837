"""Memory, disk and time of the tree's skeleton block after block, beside all at once.

    python benchmarks/blocks.py 300000 8
    python benchmarks/blocks.py 100000 4 torus

on uniform points, or of the inside of a torus by gates, each way in a process of its own. Peaks are what the process
came to hold beyond what it held after a small cloud, when all code was loaded.
"""

import resource
import subprocess
import sys
import tempfile
import time
import weakref
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from dealt import torus, uniform
from tetraskel import assemble_skeleton, build_tree, interior, remove_flat, triangulate
from tetraskel.distributed import shelf
from tetraskel.distributed.blockwise import BlockOptions, skeleton_in_blocks
from tetraskel.kernels.mesh import submesh

MEGA = 1e6
CLOUDS = {
    "uniform": (uniform, BlockOptions(threshold=0.1)),
    "torus": (torus, BlockOptions(threshold=0.01, inside="gates")),  # its simplices are long and thin
}


def megabytes():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / MEGA


def serial(points, options):
    mesh = triangulate(points, engine="exact")
    if options.inside != "all":
        mesh = submesh(mesh, interior(mesh, method=options.inside))
    assemble_skeleton(remove_flat(build_tree(mesh), threshold=options.threshold))


class Disk:
    """Counts the bytes of the files that arrays are kept in."""

    def __init__(self):
        self.maps, self.most = weakref.WeakSet(), 0
        self.mapped = shelf.Shelf._mapped
        shelf.Shelf._mapped = lambda *given: self.counted(*given)

    def counted(self, *given):
        arrays = self.mapped(*given)
        self.maps.update(given[0]._maps)
        self.most = max(self.most, sum(len(one) for one in list(self.maps)))
        return arrays


def measured(path, n_blocks, name):
    """One way, in this process: what it came to hold, what it had on disk, its time."""
    disk, folder = Disk(), Path(path).parent
    cloud, options = CLOUDS[name]
    few = cloud(np.random.default_rng(1), 3000)
    points = np.load(path, mmap_mode="r")
    skeleton_in_blocks(few, folder, 2, options)
    serial(few, options)
    before, started = megabytes(), time.perf_counter()
    if n_blocks:
        skeleton_in_blocks(points, folder, n_blocks, options)
    else:
        serial(points, options)
    print(before, megabytes() - before, disk.most / MEGA, time.perf_counter() - started)


def main():
    n, n_blocks, name = int(sys.argv[1]), int(sys.argv[2]), (*sys.argv[3:], "uniform")[0]
    with tempfile.TemporaryDirectory(dir=".") as folder:
        path = Path(folder) / "cloud.npy"
        np.save(path, CLOUDS[name][0](np.random.default_rng(0), n))
        for blocks in (0, n_blocks):
            call = [sys.executable, __file__, "one", str(path), str(blocks), name]
            done = subprocess.run(call, capture_output=True, text=True, check=True)
            before, peak, disk, seconds = map(float, done.stdout.split())
            what = f"{blocks} blocks" if blocks else "all at once"
            told = f"{peak:.0f} MB ({before:.0f} MB before), {disk:.0f} MB on disk, {seconds:.0f} s"
            print(f"{n} points, {name}, {what}: {told}", flush=True)


if sys.argv[1] == "one":
    measured(sys.argv[2], int(sys.argv[3]), sys.argv[4])
else:
    main()
