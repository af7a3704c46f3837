"""Points to Delaunay triangulation: which engine, and what is done before and after it.

Qhull's answer on cospherical points depends on the order of the points, so it is given them in an order that is a
function of their coordinates (along a Morton curve); the same cloud permuted then gives the same triangulation.
"""

from __future__ import annotations

import importlib
import importlib.util
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.errors import EngineError
from tetraskel.kernels.chunks import Tick, part, silent
from tetraskel.kernels.denoise import denoised
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.plane import plane_of_mesh
from tetraskel.kernels.points import DistinctPoints, distinct_points, full_dimensional, morton_order
from tetraskel.kernels.predicates import orientation_signs
from tetraskel.options import DelaunayOptions

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# engine -> (module whose `delaunay(points, tick)` runs it, what that module needs). Named, not imported: the vtk
# engine lives with the VTK classes, and the kernels must load where there is no VTK.
ENGINE_MODULES = {
    "qhull": ("tetraskel.kernels.qhull", "scipy"),
    "vtk": ("tetraskel.vtkfilters.delaunay_engine", "vtkmodules"),
}
JOGGLE_SEED = 20


def triangulate(
    points: ArrayLike,
    *,
    engine: str = DelaunayOptions.engine,
    joggle: float = DelaunayOptions.joggle,
    denoise: bool = DelaunayOptions.denoise,
    tick: Tick = silent,
) -> Triangulation:
    """Delaunay triangulation of a point cloud.

    Parameters
    ----------
    points : (n, 2) or (n, 3) array
        Any unit. Equal points are merged. Points of one plane in space are triangulated in that plane.
    engine : {"auto", "qhull", "vtk"}
        See `DelaunayOptions`.
    joggle : float
        Largest displacement, as a fraction of the bounding-box diagonal; the result has the original coordinates.
    denoise : bool
        Triangulate the points that `denoised` leaves, instead of the points themselves. The result's `point_map` then
        gives every input point the one nearest to it, `original_ids` the input point that each was.
    tick : callable, optional
        Told the share of work done; may raise `Aborted`.

    Returns
    -------
    Triangulation
        Simplices are positively oriented and do not depend on the order of the points, ids aside. No points give
        no simplices.

    Raises
    ------
    InputError
        For points that are not finite, too few, or all on one line.
    EngineError
        For an engine that is not there or fails.

    Examples
    --------
    >>> square = triangulate([[0, 0], [1, 0], [1, 1], [0, 2]])
    >>> square.simplices.shape
    (2, 3)
    """
    DelaunayOptions(engine=engine, joggle=joggle, denoise=denoise)
    distinct = distinct_points(points)
    engine = available_engine(engine)
    if len(distinct.points) == 0:
        return _empty(distinct, engine)
    coordinates = full_dimensional(distinct)
    noise, before = 0.0, 0.3 if denoise else 0.0
    if denoise:
        distinct, coordinates, noise = _without_noise(distinct, coordinates, part(tick, 0.0, before))
    order = morton_order(coordinates)
    inputs = _unit_box(coordinates[order])
    if joggle:
        inputs = inputs + _displacements(inputs, joggle)
    module = importlib.import_module(ENGINE_MODULES[engine][0])
    simplices, neighbors, stands_for = module.delaunay(inputs, part(tick, before, 1.0))
    if len(simplices) == 0:
        raise EngineError(f"the {engine} engine found no simplex in {len(inputs)} points; they may be almost flat.")
    mesh = _in_input_ids(distinct, coordinates, order, (simplices, neighbors, stands_for), engine)
    return replace(mesh, noise=noise)


def _without_noise(distinct: DistinctPoints, coordinates: Floats, tick: Tick) -> tuple[DistinctPoints, Floats, float]:
    """The points back on their surface, their coordinates, and the noise that was found."""
    found = denoised(coordinates, tick)
    if found.noise == 0:
        return distinct, coordinates, 0.0
    in_space = distinct.points.shape[1] > coordinates.shape[1]
    points = plane_of_mesh(distinct.points).lift(found.points) if in_space else found.points
    ids, rows = distinct.original_ids[found.ids], found.stands_for[distinct.point_map]
    return DistinctPoints(points, ids, rows, distinct.roundoff), found.points, found.noise


def available_engine(engine: str) -> str:
    """The engine that will run: "auto" becomes the best one whose library can be imported.

    Raises
    ------
    EngineError
        When its library is missing.
    """
    if engine == "auto":
        engine = "qhull" if importlib.util.find_spec("scipy") else "vtk"
    needed = ENGINE_MODULES[engine][1]
    if importlib.util.find_spec(needed) is None:
        raise EngineError(
            f"the {engine} engine needs the package {needed}, which is not installed; choose another engine."
        )
    return engine


def _unit_box(points: Floats) -> Floats:
    """Moved to the origin and scaled by a power of two: engines then see every unit and offset alike."""
    moved = points - points.min(axis=0)
    return np.ldexp(moved, -int(np.frexp(moved.max())[1]))


def _displacements(points: Floats, joggle: float) -> Floats:
    """Reproducible displacements, uniform in a cube: a function of each point's place in the sorted cloud."""
    diagonal = float(np.sqrt((np.ptp(points, axis=0) ** 2).sum()))
    return np.random.default_rng(JOGGLE_SEED).uniform(-1, 1, points.shape) * (joggle * diagonal)


def _in_input_ids(
    distinct: DistinctPoints, coordinates: Floats, order: Ints, found: tuple[Ints, Ints, Ints], engine: str
) -> Triangulation:
    """From the engine's sorted points back to the input's ids, without the points it merged."""
    simplices, neighbors, stands_for = found
    kept = np.zeros(len(order), bool)
    kept[order[simplices.ravel()]] = True
    new_id = np.cumsum(kept) - 1
    representative = np.empty(len(order), np.int64)
    representative[order] = order[stands_for]
    oriented, neighbors = oriented_positively(coordinates, order[simplices].astype(np.int32), neighbors)
    return Triangulation(
        points=distinct.points[kept],
        simplices=new_id[oriented].astype(np.int32),
        neighbors=neighbors,
        original_ids=distinct.original_ids[kept],
        point_map=new_id[representative[distinct.point_map]],
        engine=engine,
    )


def oriented_positively(coordinates: Floats, simplices: Ints, neighbors: Ints) -> tuple[Ints, Ints]:
    """The same simplices, the last two vertices (and neighbours) swapped where the orientation was negative."""
    simplices, neighbors = simplices.copy(), neighbors.astype(np.int32)
    for start in range(0, len(simplices), 1 << 16):
        piece = slice(start, start + (1 << 16))
        negative = start + np.flatnonzero(orientation_signs(coordinates[simplices[piece]]) < 0)
        for array in (simplices, neighbors):
            array[negative, -1], array[negative, -2] = array[negative, -2], array[negative, -1]
    return simplices, neighbors


def _empty(distinct: DistinctPoints, engine: str) -> Triangulation:
    width = distinct.points.shape[1] + 1
    nothing = np.empty((0, width), np.int32)
    return Triangulation(distinct.points, nothing, nothing, distinct.original_ids, distinct.point_map, engine)
