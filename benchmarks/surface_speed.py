"""The surface of a skeleton beside VTK's contouring of the same grid, in one run: python benchmarks/surface_speed.py.

A skeleton of 1,000 points on a closed curve, on a grid of 256 places along the longest side of its box, made a cube.
VTK contours the same values, computed at every place of the grid; only its contouring is timed. Medians of several
interleaved runs, in seconds of the processor, all on one core; and the process's peak memory before the grid is filled.
"""

from __future__ import annotations

import resource
import time

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkContourFilter, vtkFlyingEdges3D

from tetraskel import skeleton_surface
from tetraskel.kernels.round_cones import nearest_along, round_cones

PLACES = 256
REPEATS = 7


def curve(n=1000):
    """A closed curve in a box of about equal sides, with a radius that goes up and down."""
    turn = np.linspace(0, 2 * np.pi, n, endpoint=False)
    points = np.stack(
        [np.sin(turn) + 2 * np.sin(2 * turn), np.cos(turn) - 2 * np.cos(2 * turn), -2.5 * np.sin(3 * turn)], axis=1
    )
    edges = np.stack([np.arange(n), (np.arange(n) + 1) % n], axis=1)
    return points, edges, 0.35 + 0.1 * np.sin(5 * turn)


def grid_of(skeleton, spacing):
    """Values of the same function at every place of a cubic grid."""
    points, _, radius = skeleton
    every = np.arange(0, len(points), 4)  # every fourth point: the same to a thousandth, sooner
    cones = round_cones(points, radius, np.stack([every, (every + 4) % len(points)], axis=1))
    axis = spacing * (np.arange(PLACES) - (PLACES - 1) / 2)
    values = np.full((PLACES,) * 3, np.inf, np.float32)
    for cone in range(len(cones)):
        low, high = np.sort([cones.start[cone], cones.start[cone] + cones.length[cone] * cones.axis[cone]], axis=0)
        first, last = np.searchsorted(axis, low - 0.6), np.searchsorted(axis, high + 0.6)
        box = tuple(slice(a, b) for a, b in zip(first, last, strict=True))
        places = np.stack(np.meshgrid(*(axis[part] for part in box), indexing="ij")).reshape(3, -1)
        distance, _ = nearest_along(cones, places, np.full(places.shape[1], cone))
        values[box] = np.minimum(values[box], distance.reshape(values[box].shape))
    image = vtkImageData()
    image.SetDimensions(PLACES, PLACES, PLACES)
    image.SetSpacing(spacing, spacing, spacing)
    image.GetPointData().SetScalars(numpy_to_vtk(np.minimum(values, 1).transpose(2, 1, 0).ravel(), deep=1))
    return image


def vtk_surface(image, kind):
    step = kind()
    step.SetInputData(image)
    step.SetValue(0, 0.0)
    step.Update()
    return step.GetOutput()


def main():
    skeleton = curve()
    reach = np.abs(skeleton[0]).max(axis=0).max() + 0.5
    spacing = 2 * reach / (PLACES - 1)
    skeleton_surface(skeleton, spacing=spacing)
    ours_peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    image = grid_of(skeleton, spacing)
    works = {
        "skeleton_surface": lambda: skeleton_surface(skeleton, spacing=spacing).simplices,
        "vtkFlyingEdges3D": lambda: vtk_surface(image, vtkFlyingEdges3D),
        "vtkContourFilter": lambda: vtk_surface(image, vtkContourFilter),
    }
    seconds: dict[str, list[float]] = {name: [] for name in works}
    sizes = {}
    for _ in range(REPEATS):
        for name, work in works.items():
            start = time.process_time()
            result = work()
            seconds[name].append(time.process_time() - start)
            sizes[name] = len(result) if isinstance(result, np.ndarray) else result.GetNumberOfPolys()
    ours = float(np.median(seconds["skeleton_surface"]))
    print("| | s | triangles | ours / its |")
    print("|---|---|---|---|")
    for name, taken in seconds.items():
        median = float(np.median(taken))
        print(f"| {name} | {median:.3f} | {sizes[name]:,} | {ours / median:.2f} |")
    print(f"peak memory of the process before the grid is filled: {ours_peak:,.0f} MB")


if __name__ == "__main__":
    main()
