"""Engines side by side, and the stages of the chain: python benchmarks/run.py [--sizes N ...] [--out FOLDER].

Every measurement is a process of its own, so peak memory is its own too. Runs of the engines alternate, seconds are
medians, ratios are to Qhull in the same run. What takes longer than `--limit` seconds is stopped and shown as such;
what takes longer than `--once` is not repeated.
With --out: FOLDER/benchmarks.md and, with matplotlib, FOLDER/pictures/benchmarks.png.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import time
from datetime import date
from pathlib import Path

import numpy as np
from engines import ENGINES, installed

CLOUDS = ("uniform", "surface", "lattice")
STAGES = ("triangulate", "build_tree", "curve_skeleton")
INTRODUCTION = """# Engines and stages

Seconds by the clock (share of Qhull's in the same run) and peak memory of the process, medians of up to {repeats} runs
on {cores} cores, {date}, by `benchmarks/run.py`. Below the engines are stages of the chain, each with what it needs
made before: the tree, and the curve skeleton from a triangulation on. Uniform points and lattices are no surfaces: all
is inside there, and the curve skeleton of a full cube has most of its work for nothing.

![Seconds over points](pictures/benchmarks.png)"""
COMPILED_WITH = 300  # points of a first, untimed call


def cloud(kind: str, n: int, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    if kind == "uniform":
        return rng.random((n, 3))
    if kind == "lattice":
        side = round(n ** (1 / 3))
        return np.stack(np.meshgrid(*[np.arange(side) * 0.1] * 3), -1).reshape(-1, 3)
    u, v = rng.uniform(0, 2 * np.pi, (2, n))
    small = 0.6 + 0.1 * np.sin(3 * u) + 0.05 * np.cos(2 * v)
    ring = 2 + small * np.cos(v)
    return np.stack([ring * np.cos(u), ring * np.sin(u), small * np.sin(v)], axis=1)


def stage(name: str, points: np.ndarray, is_surface: bool) -> tuple[float, int]:
    """Seconds of one stage alone, with what it needs made before; a cloud that is no surface is all inside."""
    from tetraskel import build_tree, triangulate
    from tetraskel.kernels.curve import curve_model, draw_curve

    start = time.perf_counter()
    mesh = triangulate(points)
    if name != "triangulate":
        start = time.perf_counter()
        if name == "build_tree":
            build_tree(mesh)
        else:
            draw_curve(curve_model(mesh, inside=None if is_surface else np.ones(len(mesh), bool)))
    return time.perf_counter() - start, len(mesh)


def measure(what: str, kind: str, n: int) -> None:
    """In a process of its own: print seconds, simplices and peak megabytes."""
    points = cloud(kind, n)
    if what in ENGINES:
        ENGINES[what][1](cloud("uniform", COMPILED_WITH))
        start = time.perf_counter()
        cells = ENGINES[what][1](points)
        seconds = time.perf_counter() - start
    else:
        stage(what, cloud("surface", 10 * COMPILED_WITH), True)
        seconds, cells = stage(what, points, kind == "surface")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(json.dumps({"seconds": seconds, "cells": cells, "peak": peak}))


def measured(what: str, kind: str, n: int, limit: float) -> dict | None:
    command = [sys.executable, __file__, "--one", what, kind, str(n)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=limit)
    except subprocess.TimeoutExpired:
        return None
    if done.returncode:
        print(f"{what} on {n} {kind} points: {(done.stderr.strip() or 'failed').splitlines()[-1]}", file=sys.stderr)
        return None
    return json.loads(done.stdout.splitlines()[-1])


def rows(names: list[str], kind: str, sizes: list[int], arguments: argparse.Namespace) -> dict:
    """(name, n) -> median seconds, simplices, peak; names alternate within each repeat."""
    found: dict = {}
    stopped = set()
    for n in sizes:
        for _ in range(arguments.repeats):
            for name in names:
                long = any(one["seconds"] > arguments.once for one in found.get((name, n), []))
                if name not in stopped and not long:
                    one = measured(name, kind, n, arguments.limit)
                    if one is None:
                        stopped.add(name)  # larger ones take longer
                        found.pop((name, n), None)
                    else:
                        found.setdefault((name, n), []).append(one)
    return {key: {k: float(np.median([r[k] for r in runs])) for k in runs[0]} for key, runs in found.items()}


def table(names: list[str], kind: str, sizes: list[int], found: dict, limit: float) -> str:
    lines = [f"\n### {kind}\n", "| | " + " | ".join(f"{n:,} points" for n in sizes) + " | exponent |"]
    lines.append("|---" * (len(sizes) + 2) + "|")
    for name in names:
        cells = []
        for n in sizes:
            one, base = found.get((name, n)), found.get(("Qhull", n))
            ratio = f" ({one['seconds'] / base['seconds']:.2f})" if one and base and name != "Qhull" else ""
            cells.append(
                f"{one['seconds']:.2f} s{ratio}, {one['peak']:,.0f} MB" if one else f"over {limit:g} s or failed"
            )
        done = [n for n in sizes if (name, n) in found]
        times = [found[name, n]["seconds"] for n in done]
        slope = f"{np.polyfit(np.log(done), np.log(times), 1)[0]:.2f}" if len(done) > 1 else ""
        lines.append(f"| {name} | " + " | ".join(cells) + f" | {slope} |")
    return "\n".join(lines)


def plot(results: dict, names: list[str], path: Path) -> None:
    try:
        import matplotlib
    except ImportError:
        return
    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(1, len(CLOUDS), figsize=(12, 4), sharey=True)
    for axis, kind in zip(axes, CLOUDS, strict=True):
        for name in names:
            points = sorted((n, one["seconds"]) for (other, n), one in results[kind].items() if other == name)
            if points:
                axis.loglog(*zip(*points, strict=True), "o-", label=name)
        axis.set(title=kind, xlabel="points")
        axis.grid(alpha=0.3)
    axes[0].set_ylabel("seconds")
    axes[-1].legend(loc="lower right")
    figure.tight_layout()
    path.parent.mkdir(exist_ok=True, parents=True)
    figure.savefig(path, dpi=110)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", type=int, nargs="+", default=[10**4, 10**5, 10**6])
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--limit", type=float, default=300.0, help="seconds after which one measurement is stopped")
    parser.add_argument("--once", type=float, default=20.0, help="seconds from which on one measurement is enough")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--one", nargs=3, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.one:
        measure(arguments.one[0], arguments.one[1], int(arguments.one[2]))
        return
    if arguments.out:
        arguments.out.mkdir(parents=True, exist_ok=True)  # before hours of work, not after
    names = [*installed(), *STAGES]
    results, text = {}, [INTRODUCTION.format(repeats=arguments.repeats, cores=os.cpu_count(), date=date.today())]
    for kind in CLOUDS:
        results[kind] = rows(names, kind, arguments.sizes, arguments)
        text.append(table(names, kind, arguments.sizes, results[kind], arguments.limit))
        print(text[-1], flush=True)
    if arguments.out:
        (arguments.out / "benchmarks.md").write_text("\n".join(text) + "\n")
        plot(results, names, arguments.out / "pictures" / "benchmarks.png")


if __name__ == "__main__":
    main()
