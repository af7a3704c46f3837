"""What thinning does to curve skeletons, as a Markdown table: python benchmarks/thinning.py FOLDER

FOLDER has homer.obj, spot.obj and rocker-arm.obj. Skeletons of what is left of very many points are compared with that
of all; each is drawn in a process of its own, whose time and memory are beyond those of a small cloud drawn before.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from curve_table import read_obj
from scipy.spatial import cKDTree

from tetraskel import curve_skeleton, thinned
from tetraskel.kernels.measures import samples_along
from tetraskel.kernels.surface_rays import surface_of, surface_samples

NAMES = ("homer", "spot", "rocker-arm")
N_POINTS = 500_000
MOST = (50_000, 20_000, 8000)


def megabytes() -> float:
    """The most that this process has held."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def draw(file: str, most: int, out: str) -> None:
    """Thin a file of points, draw the skeleton of what is left, write it and print how it went."""
    points = np.load(file, mmap_mode="r")
    ways = np.random.default_rng(0).normal(size=(2000, 3))
    ball = ways / np.linalg.norm(ways, axis=1, keepdims=True)
    curve_skeleton(ball[thinned(ball, most_points=1000).ids])  # compiles
    before = megabytes()
    start = time.perf_counter()
    kept = points[thinned(points, most_points=most).ids]
    between = time.perf_counter()
    skeleton = curve_skeleton(kept)
    np.save(out, samples_along(skeleton, 3000)[0])
    ends = int((skeleton.node_degree == 1).sum())
    spent = between - start, time.perf_counter() - between, megabytes() - before
    print(len(kept), skeleton.components, skeleton.loops, ends, *spent)


def apart(place: Path, name: str, diagonal: float) -> str:
    """Mean and largest distance of a skeleton from that of all points, the larger of both ways, in percent."""
    one, other = np.load(place / f"{name}.skeleton.npy"), np.load(place / "all.skeleton.npy")
    ways = [cKDTree(a).query(b)[0] for a, b in ((one, other), (other, one))]
    mean, largest = (100 * max(map(what, ways)) / diagonal for what in (np.mean, np.max))
    return f"{mean:.2f} / {largest:.1f}"


def drawn(place: str, cloud: str, most: int, name: str = "") -> tuple[str, str, str]:
    """Draw in a process of its own; cells of the table: points, what is drawn, seconds and megabytes."""
    call = [sys.executable, __file__, f"{place}/{cloud}.npy", str(most), f"{place}/{name or cloud}.skeleton.npy"]
    said = subprocess.run(call, check=True, capture_output=True, text=True).stdout.split()
    thinning, drawing, peak = map(float, said[4:])
    return f"{int(said[0]):,}", " / ".join(said[1:4]), f"{thinning:.1f} | {drawing:.1f} | {peak:.0f}"


def main(folder: str) -> None:
    """A row for each mesh and number of points."""
    words = (
        "mesh",
        "points",
        "pieces / loops / ends",
        "mean / largest, %",
        "of even points",
        "thinning, s",
        "skeleton, s",
    )
    print("| " + " | ".join((*words, "MB")) + " |")
    print("|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as place:
        for name in NAMES:
            surface = surface_of(*read_obj(Path(folder) / f"{name}.obj"))
            np.save(f"{place}/all.npy", np.asarray(surface_samples(surface, N_POINTS)))
            diagonal = np.linalg.norm(np.ptp(np.load(f"{place}/all.npy"), axis=0))
            told = drawn(place, "all", N_POINTS)
            print(f"| {name} | {told[0]} | {told[1]} | | | {told[2]} |", flush=True)
            for most in MOST:
                np.save(f"{place}/even.npy", np.asarray(surface_samples(surface, most)))
                drawn(place, "even", N_POINTS)
                even = apart(Path(place), "even", diagonal)
                told = drawn(place, "all", most, "thinned")
                away = apart(Path(place), "thinned", diagonal)
                print(f"| {name} | {told[0]} | {told[1]} | {away} | {even} | {told[2]} |", flush=True)


if __name__ == "__main__":
    if len(sys.argv) == 4:
        draw(sys.argv[1], int(sys.argv[2]), sys.argv[3])
    else:
        main(sys.argv[1])
