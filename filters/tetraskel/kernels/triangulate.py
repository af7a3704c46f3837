"""Points to Delaunay triangulation: which engine, and what is done before and after it.

The exact engine's triangulation is a function of the coordinates. Qhull's answer on cospherical points depends on the
order of the points too, so every engine is given them in an order that is a function of their coordinates (along a
Morton curve); the same cloud permuted then gives the same triangulation.
"""

from __future__ import annotations

import importlib
import importlib.util
from dataclasses import replace
from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.errors import Aborted, EngineError
from tetraskel.kernels.background import wait_for
from tetraskel.kernels.chunks import Tick, part, silent
from tetraskel.kernels.compilation import SWITCH, first_line, give_up_numba, numba_is_used
from tetraskel.kernels.denoise import denoised
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.plane import plane_of_mesh
from tetraskel.kernels.points import DistinctPoints, distinct_points, full_dimensional, morton_order, unit_box
from tetraskel.kernels.predicates import orientation_signs
from tetraskel.options import DelaunayOptions

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# engine -> (module whose `delaunay(points, tick)` runs it, what that module needs). Named, not imported: the vtk
# engine lives with the VTK classes, and the kernels must load where there is no VTK.
ENGINE_MODULES = {
    "exact": ("tetraskel.kernels.exact.engine", "numba"),
    "qhull": ("tetraskel.kernels.qhull", "scipy"),
    "vtk": ("tetraskel.vtkfilters.delaunay_engine", "vtkmodules"),
}
JOGGLE_SEED = 20
COMPILE_SECONDS = 15.0  # for the progress told only


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
    engine : {"auto", "exact", "qhull", "vtk"}
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

    Warns
    -----
    RuntimeWarning
        Once, when numba is installed but does not work; "auto" then takes another engine.

    Examples
    --------
    >>> square = triangulate([[0, 0], [1, 0], [1, 1], [0, 2]])
    >>> square.simplices.shape
    (2, 3)
    """
    DelaunayOptions(engine=engine, joggle=joggle, denoise=denoise)
    distinct = distinct_points(points)
    if len(distinct.points) == 0:
        return _empty(distinct, available_engine(engine))
    coordinates = full_dimensional(distinct)
    engine = ready_engine(engine, coordinates.shape[1], tick)
    noise, before = 0.0, 0.3 if denoise else 0.0
    if denoise:
        distinct, coordinates, noise = _without_noise(distinct, coordinates, part(tick, 0.0, before))
    order = morton_order(coordinates)
    in_order = coordinates[order]
    as_given = engine == "exact" and not joggle
    inputs = in_order if as_given else unit_box(in_order)[0]  # engines then see every unit and offset alike
    if joggle:
        inputs = inputs + _displacements(inputs, joggle)
    simplices, neighbors, stands_for = _module(engine).delaunay(inputs, part(tick, before, 1.0))
    if len(simplices) == 0:
        raise EngineError(f"the {engine} engine found no simplex in {len(inputs)} points; they may be almost flat.")
    if not as_given:
        simplices, neighbors = oriented_positively(in_order, simplices, neighbors)
    mesh = _in_input_ids(distinct, order, (simplices, neighbors, stands_for), engine)
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


def ready_engine(engine: str, dim: int, tick: Tick = silent) -> str:
    """The engine that will run, ready to.

    The exact engine compiles itself the first time on a machine. Where that fails, "auto" takes another one.

    Raises
    ------
    EngineError
        When its library is missing, or it was asked for by name and cannot be compiled.
    """
    chosen = available_engine(engine)
    if chosen != "exact":
        return chosen
    try:
        wait_for(lambda: _module(chosen).prepare(dim), tick, COMPILE_SECONDS)
    except Aborted:
        raise
    except Exception as error:
        if engine == "exact":
            raise EngineError(f"the exact engine could not be compiled: {first_line(error)}; repair numba.") from error
        give_up_numba(error)
        return available_engine(engine)
    return chosen


def available_engine(engine: str) -> str:
    """The engine that will run: "auto" becomes the best one whose library can be imported.

    Raises
    ------
    EngineError
        When its library is missing.
    """
    if engine == "auto" and numba_is_used():
        return "exact"
    if engine == "auto":
        engine = "qhull" if importlib.util.find_spec("scipy") else "vtk"
    needed = ENGINE_MODULES[engine][1]
    there = numba_is_used() if engine == "exact" else importlib.util.find_spec(needed) is not None
    if not there:
        off = f", does not work or is switched off by {SWITCH}=0" if engine == "exact" else ""
        raise EngineError(
            f"the {engine} engine needs the package {needed}, which is not installed{off}; choose another engine."
        )
    return engine


def _module(engine: str) -> ModuleType:
    return importlib.import_module(ENGINE_MODULES[engine][0])


def _displacements(points: Floats, joggle: float) -> Floats:
    """Reproducible displacements, uniform in a cube: a function of each point's place in the sorted cloud."""
    diagonal = float(np.sqrt((np.ptp(points, axis=0) ** 2).sum()))
    return np.random.default_rng(JOGGLE_SEED).uniform(-1, 1, points.shape) * (joggle * diagonal)


def _in_input_ids(distinct: DistinctPoints, order: Ints, found: tuple[Ints, Ints, Ints], engine: str) -> Triangulation:
    """From the engine's sorted points back to the input's ids, without the points it merged."""
    simplices, neighbors, stands_for = found
    used = np.zeros(len(order), bool)
    used[simplices.ravel()] = True
    kept = np.empty(len(order), bool)
    kept[order] = used
    new_id = np.cumsum(kept) - 1
    representative = np.empty(len(order), np.int64)
    representative[order] = order[stands_for]
    return Triangulation(
        points=distinct.points[kept],
        simplices=new_id[order].astype(np.int32)[simplices],
        neighbors=neighbors,
        original_ids=distinct.original_ids[kept],
        point_map=new_id[representative[distinct.point_map]],
        engine=engine,
    )


def oriented_positively(coordinates: Floats, simplices: Ints, neighbors: Ints) -> tuple[Ints, Ints]:
    """The same simplices, the last two vertices (and neighbours) swapped where the orientation was negative."""
    simplices, neighbors = simplices.astype(np.int32), neighbors.astype(np.int32)
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
