"""Draw skeletons of meshes by one program: python draw.py PROGRAM JOBS.json (in the environment of the peers).

Every job names a mesh (.npz with points and triangles) and the file for what comes out (.npz with points, edges,
radius, seconds; or with error). The radius is empty where a program gives none. One process for all jobs of a program
and a shape, so that imports are not timed; `peak` is that of the process so far, in MB.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable
from itertools import product
from pathlib import Path

import numpy as np

LARGEST_GRID = 256


def voxels(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, float, np.ndarray]:
    """The mesh as a mask with about as many voxels on its surface as it has points; spacing and origin."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPolyData
    from vtkmodules.vtkImagingStencil import vtkImageStencil, vtkPolyDataToImageStencil

    resolution = int(np.clip(np.sqrt(2 * len(points)), 32, LARGEST_GRID))
    low, high = points.min(axis=0), points.max(axis=0)
    step = float((high - low).max() / (resolution - 4))
    shape = np.ceil((high - low) / step).astype(int) + 4
    origin = low - 2 * step
    surface, places, cells, image = vtkPolyData(), vtkPoints(), vtkCellArray(), vtkImageData()
    places.SetData(numpy_to_vtk(points.astype(float), deep=1))
    cells.SetData(
        numpy_to_vtkIdTypeArray(np.arange(0, 3 * len(triangles) + 1, 3, dtype=np.int64), deep=1),
        numpy_to_vtkIdTypeArray(triangles.astype(np.int64).ravel(), deep=1),
    )
    surface.SetPoints(places)
    surface.SetPolys(cells)
    image.SetDimensions(*map(int, shape))
    image.SetSpacing(step, step, step)
    image.SetOrigin(*origin)
    image.AllocateScalars(3, 1)  # bytes
    image.GetPointData().GetScalars().Fill(1)
    stencil, cut = vtkPolyDataToImageStencil(), vtkImageStencil()
    stencil.SetInputData(surface)
    stencil.SetOutputOrigin(*origin)
    stencil.SetOutputSpacing(step, step, step)
    stencil.SetOutputWholeExtent(image.GetExtent())
    cut.SetInputData(image)
    cut.SetStencilConnection(stencil.GetOutputPort())
    cut.SetBackgroundValue(0)
    cut.Update()
    mask = vtk_to_numpy(cut.GetOutput().GetPointData().GetScalars()).reshape(shape[::-1]).T
    return np.ascontiguousarray(mask > 0), step, origin


def by_kimimaro(points, triangles):
    import kimimaro

    mask, step, origin = voxels(points, triangles)
    found = kimimaro.skeletonize(
        mask.astype(np.uint8),
        teasar_params={"scale": 1.5, "const": 3 * step, "pdrf_scale": 100_000, "pdrf_exponent": 4},
        anisotropy=(step,) * 3,
        dust_threshold=0,
        progress=False,
    )
    if 1 not in found:
        raise ValueError("no skeleton")
    one = found[1]
    return one.vertices + origin, one.edges, one.radii


def by_thinning(points, triangles):
    from scipy.ndimage import distance_transform_edt
    from skimage.morphology import skeletonize

    mask, step, origin = voxels(points, triangles)
    chosen = skeletonize(mask) > 0
    places = np.argwhere(chosen)
    number = np.full(chosen.shape, -1)
    number[chosen] = np.arange(len(places))
    edges: list[tuple[int, int]] = []
    beside: list[set[int]] = [set() for _ in places]
    offsets = sorted((o for o in product((-1, 0, 1), repeat=3) if o > (0, 0, 0)), key=lambda o: sum(map(abs, o)))
    for offset in offsets:  # shorter steps first; a diagonal that two shorter steps make is none
        there = places + offset
        ok = ((there >= 0) & (there < chosen.shape)).all(axis=1)
        for a, b in zip(np.flatnonzero(ok), number[tuple(there[ok].T)], strict=True):
            if b >= 0 and not beside[a] & beside[b]:
                edges.append((int(a), int(b)))
        for a, b in edges:
            beside[a].add(b)
            beside[b].add(a)
    radius = distance_transform_edt(mask, sampling=step)[chosen]
    return origin + step * places, np.array(edges).reshape(-1, 2), radius


def by_skeletor(method: str, **options) -> Callable:
    def run(points, triangles):
        import skeletor
        import trimesh

        mesh = trimesh.Trimesh(points, triangles, process=False)
        found = getattr(skeletor.skeletonize, method)(mesh, **options)
        table = found.swc
        row = {int(node): k for k, node in enumerate(table.node_id)}
        edges = [(k, row[int(parent)]) for k, parent in enumerate(table.parent_id) if int(parent) in row]
        radius = table.radius.to_numpy(float) if "radius" in table else np.empty(0)
        return table[["x", "y", "z"]].to_numpy(float), np.array(edges).reshape(-1, 2), radius

    return run


def by_pygel(name: str) -> Callable:
    def run(points, triangles):
        from pygel3d import graph, hmesh

        net = graph.from_mesh(hmesh.Manifold.from_triangles(points, triangles))
        found = getattr(graph, name)(net)
        nodes = list(found.nodes())
        row = {node: k for k, node in enumerate(nodes)}
        edges = {tuple(sorted((row[a], row[b]))) for a in nodes for b in found.neighbors(a) if b in row}
        return np.asarray(found.positions())[nodes], np.array(sorted(edges)).reshape(-1, 2), np.empty(0)

    return run


def by_cgal(points, triangles):
    program = os.environ.get("MEAN_CURVATURE", "")
    if not program:
        raise FileNotFoundError("not built: a C++ compiler, libcgal-dev and libeigen3-dev are needed")
    with tempfile.TemporaryDirectory() as folder:
        mesh, out = Path(folder) / "mesh.off", Path(folder) / "out.txt"
        rows = [f"OFF\n{len(points)} {len(triangles)} 0", *(" ".join(map(repr, p)) for p in points.tolist())]
        mesh.write_text("\n".join([*rows, *(f"3 {a} {b} {c}" for a, b, c in triangles.tolist())]))
        start = seconds_of(resource.RUSAGE_CHILDREN)
        done = subprocess.run([program, mesh, out], capture_output=True, text=True)
        seconds = seconds_of(resource.RUSAGE_CHILDREN) - start
        if done.returncode:
            raise ValueError(
                done.stderr.strip().splitlines()[-1] if done.stderr.strip() else f"ended with {done.returncode}"
            )
        numbers = out.read_text().split()
    n, m = int(numbers[0]), int(numbers[1])
    places = np.array(numbers[2 : 2 + 3 * n], float).reshape(n, 3)
    return places, np.array(numbers[2 + 3 * n :], int).reshape(m, 2), np.empty(0), seconds


def by_tetraskel(points, triangles):
    from tetraskel import curve_skeleton

    found = curve_skeleton(points)  # the triangles are not looked at
    return found.points, found.edges, found.radius


def peak_of_self() -> int:
    """Largest resident memory of this process, in kB; getrusage would count what the starting process had."""
    told = Path("/proc/self/status").read_text(encoding="utf-8")
    return int(told.partition("VmHWM:")[2].split()[0])


PROGRAMS = {
    "tetraskel": by_tetraskel,
    "kimimaro": by_kimimaro,
    "scikit-image thinning": by_thinning,
    "skeletor wavefront": by_skeletor("by_wavefront", waves=1, progress=False),
    "skeletor tangent ball": by_skeletor("by_tangent_ball"),
    "PyGEL3D LS": by_pygel("LS_skeleton"),
    "PyGEL3D MSLS": by_pygel("MSLS_skeleton"),
    "CGAL mean curvature": by_cgal,
}


def seconds_of(whom: int) -> float:
    """What a process, or all its ended children, took of the processors: other programs do not count."""
    used = resource.getrusage(whom)
    return used.ru_utime + used.ru_stime


def main(name: str, jobs: str, seconds: str) -> None:
    run, limit = PROGRAMS[name], int(seconds)
    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 1))  # for a child anew
    for number, (mesh, out) in enumerate(json.loads(Path(jobs).read_text())):
        given = np.load(mesh)
        try:
            if number == 0:  # what is compiled or loaded the first time is not timed
                warm = np.load(Path(mesh).with_name("warm.npz"))
                run(warm["points"], warm["triangles"])
        except Exception:
            pass
        start = seconds_of(resource.RUSAGE_SELF)
        try:
            points, edges, radius, *own = run(given["points"], given["triangles"])
            seconds = own[0] if own else seconds_of(resource.RUSAGE_SELF) - start
            children = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss if own else 0
            peak = (children if own else peak_of_self()) / 1024
            np.savez(out, points=points, edges=edges, radius=radius, seconds=seconds, peak=peak)
        except Exception as error:
            np.savez(out, error=f"{type(error).__name__}: {error}".splitlines()[0][:90])


if __name__ == "__main__":
    main(*sys.argv[1:])
