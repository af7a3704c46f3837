"""All skeletons of one object, measured alike."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.errors import Aborted, InputError, TetraskelError
from tetraskel.kernels.bezier_skeleton import bezier_skeleton
from tetraskel.kernels.chunks import Tick, part, silent
from tetraskel.kernels.curve import curve_skeleton, lifted
from tetraskel.kernels.curve_skeleton import Skeleton
from tetraskel.kernels.drawn import Drawn, drawn_raster, drawn_skeleton, drawn_tree, drawn_voronoi
from tetraskel.kernels.drawn_measures import MEASURES, judge
from tetraskel.kernels.interior import inside_of_object
from tetraskel.kernels.mesh import Triangulation, submesh
from tetraskel.kernels.nearest import Cloud
from tetraskel.kernels.object_boundary import Boundary, boundary_of, given_boundary
from tetraskel.kernels.raster_mask import Mask, rasterise
from tetraskel.kernels.raster_skeleton import raster_skeleton
from tetraskel.kernels.triangulate import triangulate
from tetraskel.kernels.voronoi_skeleton import voronoi_skeleton
from tetraskel.options import COMPARED, RASTER_METHODS, VORONOI_METHODS, CompareOptions, CurveOptions
from tetraskel.pipeline import tree_skeleton

Bools = NDArray[np.bool_]

GIVEN, OWN = "surface", "boundary"
INSIDE_SHARE, METHODS_FROM = 0.1, 0.15  # of the work


@dataclass(frozen=True)
class Row:
    """One method of a comparison.

    Attributes
    ----------
    method : str
        One of `COMPARED`.
    kind : str
        What was drawn: points, lines or sheets; empty where the method failed.
    measures : dict
        See `tetraskel.kernels.drawn_measures.judge`; None where a measure has no meaning.
    seconds : float
        To draw it, without the triangulation and the inside, which all methods share, and without measuring.
    judged_by : {"surface", "boundary"}
        The surface that was given, or the boundary of the object's inside.
    failure : str
        Why there is no skeleton; empty where there is one.
    drawn : Drawn or None
        The skeleton.
    """

    method: str
    kind: str
    measures: dict[str, float | None]
    seconds: float
    judged_by: str
    failure: str = ""
    drawn: Drawn | None = field(default=None, repr=False)


@dataclass(frozen=True)
class _Object:
    """What all methods start from; the curve and the mask are made when the first method asks for them."""

    mesh: Triangulation
    inside: Bools
    options: CompareOptions

    @cached_property
    def curve(self) -> Skeleton:
        return curve_skeleton(self.mesh, inside=self.inside, detail=self.options.detail)

    @cached_property
    def mask(self) -> Mask:
        return rasterise(self.mesh, inside=self.inside, resolution=self.options.resolution)


def compare(
    points_or_mesh: ArrayLike | Triangulation,
    surface: tuple[ArrayLike, ArrayLike] | None = None,
    *,
    inside: ArrayLike | None = None,
    methods: str | Sequence[str] = CompareOptions.methods,
    detail: float = CompareOptions.detail,
    least_angle: float = CompareOptions.least_angle,
    resolution: int = CompareOptions.resolution,
    denoise: bool = CurveOptions.denoise,
    tick: Tick = silent,
) -> list[Row]:
    """Draw the skeletons of an object by all methods, and measure each.

    Parameters
    ----------
    points_or_mesh : (n, 2) or (n, 3) array, or Triangulation
        Points are triangulated once, after `denoise`, for all methods.
    surface : (vertices, facets), optional
        Closed surface to judge by: (t, 3) triangles, or of an object of the plane (s, 2) segments. Without it the
        boundary of the inside is taken.
    inside : (m,) array, optional
        Simplices that lie inside: those that are not 0. Without it the inside is found by gates; a triangulation
        made by others (`triangulation_of`) is all inside.
    methods, detail, least_angle, resolution
        See `CompareOptions`; methods may be a list of names too.
    tick : callable, optional
        Told the share of work done; may raise `Aborted`.

    Returns
    -------
    list of Row
        One for each method, in the order asked for. A method that fails is a row that says why.

    Raises
    ------
    InputError
        For unknown methods or options out of bounds, points that cannot be triangulated, an object without inside,
        or a surface that does not fit.

    Examples
    --------
    >>> from tetraskel import triangulate
    >>> rectangle = triangulate([[0, 0], [1, 0], [2.5, 0], [4, 0], [4, 2], [3, 2], [1.5, 2], [0, 2]])
    >>> rows = compare(rectangle, inside=[1] * 6, methods="sk1,sk4")
    >>> [(row.method, row.kind, row.measures["points"]) for row in rows]
    [('sk1', 'points', 6), ('sk4', 'lines', 6)]
    """
    named = methods if isinstance(methods, str) else ",".join(methods)
    options = CompareOptions(methods=named, detail=detail, least_angle=least_angle, resolution=resolution)
    chosen = chosen_methods(named)
    mesh = _mesh(points_or_mesh, denoise, part(tick, 0.0, INSIDE_SHARE))
    thing = _Object(mesh, _inside(mesh, inside, part(tick, INSIDE_SHARE, METHODS_FROM)), options)
    boundary = boundary_of(mesh, thing.inside) if surface is None else given_boundary(mesh, surface)
    judged_by = OWN if surface is None else GIVEN
    rows = []
    for number, method in enumerate(chosen):
        tick(METHODS_FROM + (1 - METHODS_FROM) * number / len(chosen))
        rows.append(_row(thing, method, boundary, judged_by))
    tick(1.0)
    return rows


def chosen_methods(named: str) -> tuple[str, ...]:
    """The methods in "all" or in names with commas between them, each once.

    Raises
    ------
    InputError
        For a name that is none of `COMPARED`.
    """
    if named.strip() == "all":
        return COMPARED
    names = tuple(dict.fromkeys(name.strip() for name in named.split(",")))
    for name in names:
        if name not in COMPARED:
            raise InputError(f"methods must be all or some of {', '.join(COMPARED)}; got {name!r}.")
    return names


def _mesh(points_or_mesh: ArrayLike | Triangulation, denoise: bool, tick: Tick) -> Triangulation:
    if isinstance(points_or_mesh, Triangulation):
        return points_or_mesh
    return triangulate(points_or_mesh, denoise=denoise, tick=tick)


def _inside(mesh: Triangulation, given: ArrayLike | None, tick: Tick) -> Bools:
    inside = inside_of_object(mesh, given, tick)
    if not inside.any():
        raise InputError(
            f"expected an object with an inside, got none of {len(mesh)} cells inside; label some, or take all."
        )
    return inside


def _row(thing: _Object, method: str, boundary: Boundary, judged_by: str) -> Row:
    """Draw and measure; what goes wrong in one method must not take the others with it."""
    start = time.perf_counter()
    try:
        drawn = DRAWERS[method](thing, method)
        seconds = time.perf_counter() - start
        flat = thing.mesh.plane
        measures = judge(drawn, drawn.points if flat is None else flat.project(drawn.points), boundary)
    except Aborted:
        raise
    except Exception as error:
        reason = str(error) if isinstance(error, TetraskelError) else f"{type(error).__name__}: {error}"
        nothing: dict[str, float | None] = dict.fromkeys(MEASURES)
        return Row(method, "", nothing, time.perf_counter() - start, judged_by, " ".join(reason.split()))
    return Row(method, drawn.kind, measures, seconds, judged_by, "", drawn)


def _curve(thing: _Object, _: str) -> Drawn:
    return drawn_skeleton(thing.curve)


def _bezier(thing: _Object, _: str) -> Drawn:
    return drawn_skeleton(bezier_skeleton(thing.curve).skeleton)


def _tree(thing: _Object, _: str) -> Drawn:
    """The tree of the inside; a node's radius is its distance to the nearest of the points, as in a curve skeleton."""
    tree = tree_skeleton(submesh(thing.mesh, thing.inside))
    used = np.unique(thing.mesh.simplices[thing.inside])
    return drawn_tree(tree, Cloud(thing.mesh.points[used]).query(tree.points)[0])


def _voronoi(thing: _Object, method: str) -> Drawn:
    angle = thing.options.least_angle
    return drawn_voronoi(voronoi_skeleton(thing.mesh, method=method, inside=thing.inside, least_angle=angle))


def _raster(thing: _Object, method: str) -> Drawn:
    mask = thing.mask
    found = raster_skeleton(mask.values, method=method, spacing=mask.spacing, origin=mask.origin)
    return drawn_raster(found, lifted(found.points, thing.mesh))


DRAWERS: dict[str, Callable[[_Object, str], Drawn]] = {
    "curve": _curve,
    "tree": _tree,
    **dict.fromkeys(VORONOI_METHODS, _voronoi),
    **dict.fromkeys(RASTER_METHODS, _raster),
    "bezier": _bezier,
}
