"""Memory, disk and time of the tree's skeleton block after block, beside all at once.

    python benchmarks/blocks.py 300000 8

on uniform points, each way in a process of its own. Peaks are what the process came to hold beyond what it held after
a small cloud, when all code was loaded.
"""

import resource
import subprocess
import sys
import tempfile
import time
import weakref
from pathlib import Path

import numpy as np

from tetraskel import assemble_skeleton, build_tree, remove_flat, triangulate
from tetraskel.distributed import shelf
from tetraskel.distributed.blockwise import BlockOptions, skeleton_in_blocks

THRESHOLD = 0.1
MEGA = 1e6


def megabytes():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / MEGA


def serial(points):
    assemble_skeleton(remove_flat(build_tree(triangulate(points, engine="exact")), threshold=THRESHOLD))


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


def measured(path, n_blocks):
    """One way, in this process: what it came to hold, what it had on disk, its time."""
    disk, folder = Disk(), Path(path).parent
    few = np.random.default_rng(1).random((3000, 3))
    points = np.load(path, mmap_mode="r")
    skeleton_in_blocks(few, folder, 2)
    serial(few)
    before, started = megabytes(), time.perf_counter()
    if n_blocks:
        skeleton_in_blocks(points, folder, n_blocks, BlockOptions(threshold=THRESHOLD))
    else:
        serial(points)
    print(before, megabytes() - before, disk.most / MEGA, time.perf_counter() - started)


def main():
    n, n_blocks = int(sys.argv[1]), int(sys.argv[2])
    with tempfile.TemporaryDirectory(dir=".") as folder:
        path = Path(folder) / "cloud.npy"
        np.save(path, np.random.default_rng(0).random((n, 3)))
        for blocks in (0, n_blocks):
            call = [sys.executable, __file__, "one", str(path), str(blocks)]
            done = subprocess.run(call, capture_output=True, text=True, check=True)
            before, peak, disk, seconds = map(float, done.stdout.split())
            what = f"{blocks} blocks" if blocks else "all at once"
            print(f"{n} points, {what}: {peak:.0f} MB ({before:.0f} MB before), {disk:.0f} MB on disk, {seconds:.0f} s")


if sys.argv[1] == "one":
    measured(sys.argv[2], int(sys.argv[3]))
else:
    main()
