"""tetraskel beside its peers: python benchmarks/peers/run.py --python PEERS/bin/python [--meshes FOLDER] --out docs

Every program gets the same closed meshes (tetraskel their points only) and draws skeletons in a process of its own; all
are judged alike, as by `tetraskel.measure`, against one mesh. A radius that a program does not give is the distance to
the mesh. Writes peers_table.md and a picture of each measure.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pyvista
from scipy.spatial import cKDTree

sys.path[:0] = [str(Path(__file__).resolve().parent)]
from draw import PROGRAMS
from inside import inside_rows
from objects import Thing, things
from pictures import draw_all

from tetraskel.kernels.drawn_measures import distances_to_union
from tetraskel.kernels.measures import balls_along, graph_numbers, inside_and_centredness, samples_along
from tetraskel.kernels.surface_rays import nearest_on_surface, surface_of, surface_samples
from tetraskel.vtkfilters.curve_skeleton import skeleton_from

TRUTH = 8000  # points of the surface that all are judged by
SIZES = (1000, 4000, 16_000, 64_000)
CLOCK = 6  # seconds on the clock for each allowed second of the processor
COLUMNS = {
    "loops": "loops (true)", "ends": "ends (true)", "inside": "inside", "centredness": "centredness",
    "reconstruction": "reconstruction, %", "stability": "stability, %", "seconds": "CPU seconds", "peak": "memory, MB",
}  # fmt: skip
HERE = Path(__file__).resolve().parent
TURN = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--python", required=True, help="the Python of the peers' environment")
    parser.add_argument("--meshes", help="folder of closed meshes (.obj) beside the analytic objects")
    parser.add_argument("--out", default="docs", help="folder for the table and the pictures")
    parser.add_argument("--objects", default="", help="names with commas between them; all by default")
    parser.add_argument("--programs", default=",".join(PROGRAMS), help="names with commas between them; all by default")
    parser.add_argument("--sizes", default=",".join(map(str, SIZES)), help="numbers of points")
    parser.add_argument("--seconds", type=float, default=120.0, help="of the processor, for all sizes of one object")
    return parser.parse_args()


def main() -> None:
    chosen = arguments()
    sizes = [int(size) for size in chosen.sizes.split(",")]
    environment = {**os.environ, "MEAN_CURVATURE": built(), "PYTHONPATH": str(HERE.parents[1] / "filters")}
    rows, insides, out = [], [], Path(chosen.out)
    for thing in things(chosen.meshes, list(filter(None, chosen.objects.split(",")))):
        with tempfile.TemporaryDirectory() as folder:
            meshes, truth = written(thing, sizes, Path(folder)), thing.resampled(TRUTH)
            for name in chosen.programs.split(","):
                python = sys.executable if name == "tetraskel" else chosen.python
                drawn(name, python, meshes, Path(folder), environment, chosen.seconds)
                for size in sizes:
                    rows.append(row(thing, name, size, Path(folder), truth))
                    print(rows[-1], flush=True)
        insides += inside_rows(thing, sizes, head=not insides)
        out.mkdir(parents=True, exist_ok=True)
        (out / "peers_table.md").write_text(page(rows, insides, chosen.python))  # a run that is stopped leaves a table
        draw_all(rows, out / "pictures")


def built() -> str:
    """The C++ program, compiled where compiler and library are there; else no name."""
    program = HERE / "build" / "mean_curvature"
    source = HERE / "mean_curvature.cpp"
    if program.exists() and program.stat().st_mtime > source.stat().st_mtime:
        return str(program)
    program.parent.mkdir(exist_ok=True)
    command = ["g++", "-O2", "-DNDEBUG", "-I/usr/include/eigen3", source, "-o", program, "-lgmp", "-lmpfr"]
    try:
        done = subprocess.run(command, capture_output=True, text=True)
    except OSError:
        return ""
    return "" if done.returncode else str(program)


def written(thing: Thing, sizes: list[int], folder: Path) -> list[tuple[str, str]]:
    """The mesh in all sizes, and each turned and permuted; with the file for what is drawn of it."""
    jobs = []
    for size in [min(sizes), *sizes]:
        points, triangles = thing.resampled(size)
        if not (folder / "warm.npz").exists():
            np.savez(folder / "warm.npz", points=points, triangles=triangles)
            continue
        order = np.random.default_rng(0).permutation(len(points))
        place = np.empty(len(points), int)
        place[order] = np.arange(len(points))
        np.savez(folder / f"{size}.npz", points=points, triangles=triangles)
        np.savez(folder / f"{size}t.npz", points=points[order] @ TURN, triangles=place[triangles])
        jobs.append((str(folder / f"{size}.npz"), str(folder / f"{size}_out.npz")))
        if size <= sizes[len(sizes) // 2]:  # the turned one where it is quick
            jobs.append((str(folder / f"{size}t.npz"), str(folder / f"{size}t_out.npz")))
    return jobs


def drawn(name: str, python: str, jobs: list, folder: Path, environment: dict, seconds: float) -> None:
    """Run a program on all meshes; what it leaves undone stays undone."""
    for _, out in jobs:
        Path(out).unlink(missing_ok=True)
    (folder / "jobs.json").write_text(json.dumps(jobs))
    command = [python, str(HERE / "draw.py"), name, str(folder / "jobs.json"), f"{seconds:.0f}"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=CLOCK * seconds)
        too_long = -done.returncode == signal.SIGXCPU
        ended = f"not done in {seconds:g} s" if too_long else f"crashed ({done.returncode})"
    except subprocess.TimeoutExpired:
        ended = f"not done in {seconds:g} s"
    for _, out in jobs:
        if not Path(out).exists():
            np.savez(out, error=ended)


def row(thing: Thing, name: str, size: int, folder: Path, surface: tuple[np.ndarray, np.ndarray]) -> dict:
    """What one program made of one object, in numbers; or why there is nothing."""
    found = np.load(folder / f"{size}_out.npz")
    start = {"object": thing.name, "points": size, "program": name}
    if "error" in found:
        return {**start, "error": str(found["error"])}
    if len(found["edges"]) == 0:
        return {**start, "error": "no lines"}
    skeleton = skeleton_of(found, surface)
    target = surface_of(*surface)
    numbers = graph_numbers(skeleton)
    inside, centredness = inside_and_centredness(skeleton, target)
    away = distances_to_union(*balls_along(skeleton), surface_samples(target, 10_000))
    diagonal = float(np.linalg.norm(np.ptp(surface[0], axis=0)))
    return {
        **start,
        "loops": f"{numbers['loops']:.0f} ({thing.loops})",
        "ends": f"{numbers['ends']:.0f}" + ("" if thing.ends is None else f" ({thing.ends})"),
        "loops_off": abs(numbers["loops"] - thing.loops),
        "inside": inside,
        "centredness": centredness,
        "reconstruction": 100 * float(away.mean()) / diagonal,
        "stability": stability(skeleton, folder / f"{size}t_out.npz", surface),
        "seconds": float(found["seconds"]),
        "peak": float(found["peak"]),
    }


def skeleton_of(found, surface):
    """A program's skeleton in our form."""
    points, edges, radius = found["points"], found["edges"], found["radius"]
    if len(radius) != len(points):
        nearest = nearest_on_surface(surface_of(*surface), points)
        radius = np.sqrt(((points - nearest) ** 2).sum(axis=1))
    data = pyvista.PolyData()
    data.points = np.asarray(points, float)
    data.lines = np.column_stack([np.full(len(edges), 2), edges]).ravel()
    data["MaximumInscribedSphereRadius"] = np.asarray(radius, float)
    return skeleton_from(data)


def stability(skeleton, turned: Path, surface) -> float | None:
    """Hausdorff distance to the skeleton of the turned and permuted object, in percent of the diagonal."""
    if not turned.exists():
        return None
    found = np.load(turned)
    if "error" in found or len(found["edges"]) == 0:
        return None
    other = skeleton_of({**{key: found[key] for key in found}, "points": found["points"] @ TURN.T}, surface)
    here, there = samples_along(skeleton, 4000)[0], samples_along(other, 4000)[0]
    farthest = max(cKDTree(there).query(here)[0].max(), cKDTree(here).query(there)[0].max())
    return float(100 * farthest / np.linalg.norm(np.ptp(surface[0], axis=0)))


def page(rows: list[dict], insides: list[str], python: str) -> str:
    """The table as Markdown, with what it was made by."""
    lines = [f"Made by `make compare` on {time.strftime('%Y-%m-%d')}: {machine()}. {versions(python)}.", ""]
    lines += ["| object | points | program | " + " | ".join(COLUMNS.values()) + " |", "|---" * (3 + len(COLUMNS)) + "|"]
    for one in rows:
        start = f"| {one['object']} | {one['points']} | {one['program']} | "
        if "error" in one:
            lines.append(start + one["error"].replace("|", "/") + " |" * len(COLUMNS))
        else:
            lines.append(start + " | ".join(shown(one[key]) for key in COLUMNS) + " |")
    lines += ["", "Overlap of the inside with the true one (volume of intersection over union):", ""]
    return "\n".join([*lines, *insides, ""])


def shown(value: float | str | None) -> str:
    return "-" if value is None else value if isinstance(value, str) else f"{value:.3g}"


def machine() -> str:
    with open("/proc/cpuinfo", encoding="utf-8") as told:
        names = [line.split(":")[1].strip() for line in told if line.startswith("model name")]
    return f"{names[0] if names else platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}"


def versions(python: str) -> str:
    """Of tetraskel and of the peers."""
    import tetraskel

    code = "from importlib.metadata import version; print(*(f'{n} {version(n)}' for n in %r), sep=', ')"
    names = ["kimimaro", "skeletor", "PyGEL3D", "scikit-image", "vtk"]
    told = subprocess.run([python, "-c", code % names], capture_output=True, text=True).stdout.strip()
    header = Path("/usr/include/CGAL/version.h")
    text = header.read_text(encoding="utf-8", errors="replace") if header.exists() else ""
    cgal = text.partition("CGAL_VERSION ")[2].split("\n")[0]
    return f"tetraskel {tetraskel.__version__} ({engine()}), {told}, CGAL {cgal or 'none'}"


def engine() -> str:
    from tetraskel.kernels.triangulate import available_engine

    return f"engine {available_engine('auto')}"


if __name__ == "__main__":
    main()
