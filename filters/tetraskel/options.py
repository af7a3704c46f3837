"""Every parameter of every filter: name, default, unit, bounds and meaning, in one place.

A frozen dataclass per filter. The kernels take their keyword defaults from it, and the VTK setters, the
ParaView panel and the command-line options are generated from it, so the faces cannot disagree.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from numbers import Real
from typing import Any, ClassVar

import numpy as np

from tetraskel.errors import InputError


def option(
    default: Any,
    doc: str,
    *,
    unit: str = "",
    bounds: tuple[float, float] | None = None,
    choices: tuple[str, ...] = (),
    when: tuple[str, str] | None = None,
    flag: str | None = "",
    slider: tuple[float, float] | None = None,
) -> Any:
    """A dataclass field that carries what the faces need to show it.

    `when` names another option and the word of it for which this one matters, or Input and image or points (a panel
    hides it otherwise); `flag` is its name on the command line where that is not its own, None where a command asks in
    another way; `slider` spans the usual values where the bounds are much wider.
    """
    metadata = {"doc": doc, "unit": unit, "bounds": bounds, "choices": choices, "when": when, "flag": flag}
    return field(default=default, metadata={**metadata, "slider": slider or bounds})


@dataclass(frozen=True)
class Options:
    """Base of the parameter sets; checks every value against its declaration.

    `groups` are headings with the options a panel shows under them; the others come first.
    """

    groups: ClassVar[dict[str, tuple[str, ...]]] = {}

    def __post_init__(self) -> None:
        for declared in fields(self):
            check_value(declared.name, getattr(self, declared.name), declared.metadata, declared.default)


def check_value(name: str, value: Any, metadata: Any, default: Any) -> None:
    """Raise `InputError` when `value` is not one the option `name` can take."""
    choices, bounds = metadata["choices"], metadata["bounds"]
    if choices and value not in choices:
        raise InputError(f"{name} must be one of {', '.join(choices)}; got {value!r}.")
    if isinstance(default, bool) and not isinstance(value, (bool, np.bool_)):
        raise InputError(f"{name} must be True or False; got {value!r}.")
    if isinstance(default, tuple):
        whole = isinstance(value, (tuple, list, np.ndarray)) and len(value) == len(default)
        if not whole or not all(isinstance(x, Real) and math.isfinite(x) for x in value):
            raise InputError(f"{name} must be {len(default)} finite numbers; got {value!r}.")
    if isinstance(default, str) and not isinstance(value, str):
        raise InputError(f"{name} must be a word; got {value!r}.")
    if bounds is None:
        return
    if not isinstance(value, Real) or not math.isfinite(value):
        raise InputError(f"{name} must be a finite number; got {value!r}.")
    if not bounds[0] <= value <= bounds[1]:
        raise InputError(f"{name} must lie between {bounds[0]:g} and {bounds[1]:g}; got {value:g}.")
    if isinstance(default, int) and value != round(value):
        raise InputError(f"{name} must be a whole number; got {value!r}.")


ENGINES = ("auto", "qhull", "vtk", "exact")  # saved states of ParaView hold the number
TRAVERSALS = ("breadth", "depth")
CENTRES = ("barycentre", "incentre", "circumcentre")
INSIDES = ("gates", "surface", "outline", "array", "all")


@dataclass(frozen=True)
class DelaunayOptions(Options):
    """Parameters of the Delaunay triangulation."""

    groups: ClassVar = {"Changes to the Points": ("joggle", "denoise")}

    engine: str = option(
        "auto",
        "Who computes the triangulation: exact (ours, compiled by numba; fast, and unique for every cloud), qhull "
        "(SciPy; uses every point, the hull is the convex hull), vtk (vtkDelaunay3D/2D, for a ParaView without SciPy; "
        "the hull may miss slivers), or auto (exact where numba can be imported, else qhull where SciPy can be, else "
        "vtk).",
        choices=ENGINES,
    )
    joggle: float = option(
        0.0,
        "Largest displacement given to each point before triangulating, to make cospherical points generic "
        "as the paper does. 0 switches it off; 1e-6 is a good value. The output keeps the original coordinates.",
        unit="fraction of the bounding-box diagonal",
        bounds=(0.0, 0.01),
    )
    denoise: bool = option(
        False,
        "Move noisy points of a surface back onto it first, and of those closer to one another than the noise keep "
        "one. Points without noise are left as they are.",
    )
    gather_below: int = option(
        100_000,
        "On several MPI ranks: fewer points than this are gathered and triangulated on the first rank, more are spread "
        "over all ranks by place. Has no effect on one rank.",
        unit="points",
        bounds=(0, math.inf),
        flag=None,
    )


@dataclass(frozen=True)
class TreeOptions(Options):
    """Parameters of the walk over the simplices."""

    traversal: str = option(
        "breadth",
        "Order of the walk: breadth (a first-in-first-out queue, smallest depths) or depth (follow the first son to "
        "its end).",
        choices=TRAVERSALS,
    )
    centre: str = option(
        "barycentre",
        "Where a node is drawn in its simplex: barycentre (the paper's iso-centre), incentre, or circumcentre "
        "(may lie outside the simplex).",
        choices=CENTRES,
    )


@dataclass(frozen=True)
class FlatOptions(Options):
    """Parameters of the removal of flat simplices."""

    threshold: float = option(
        0.01,
        "Simplices whose quality 1/Qk is below this are flat and removed. 1 is the regular simplex, 0 a flat one.",
        unit="quality 1/Qk",
        bounds=(0.0, 1.0),
    )


@dataclass(frozen=True)
class SkeletonOptions(Options):
    """Parameters of the skeleton drawn from a tree."""

    keep_leaves: bool = option(False, "Draw the nodes without sons too. The paper's skeleton is the tree without them.")


@dataclass(frozen=True)
class InteriorOptions(Options):
    """Parameters of the classification into inside and outside."""

    method: str = option(
        "gates",
        "How inside is told from outside: gates (from the points alone), surface (a closed surface as second input), "
        "outline (closed lines as second input, 2D), array (a cell array of the mesh), or all (everything is "
        "inside: the convex case).",
        choices=INSIDES,
        flag="inside",
    )
    ratio: float = option(
        2.0,
        "How many times larger than its widest door a room must be to count as the other side of a surface. Hardly "
        "matters where the sampling is denser than the object is thick; larger values demand a denser sampling. "
        "Where no room is so large and the points lie on a surface, smaller ratios are tried.",
        unit="room radius / door width",
        bounds=(1.0, 100.0),
        slider=(1.0, 10.0),
        when=("method", "gates"),
    )
    noise: float = option(
        0.0,
        "Gates narrower than this many times the local scatter of the points, estimated from them, are no doors: "
        "rooms between noisy points are then not taken for objects. 0 switches it off; 2 suits noisy scans.",
        unit="standard deviations",
        bounds=(0.0, 100.0),
        slider=(0.0, 10.0),
        when=("method", "gates"),
    )


@dataclass(frozen=True)
class InteriorCellsOptions(InteriorOptions):
    """Parameters of inside and outside on a mesh with named arrays."""

    groups: ClassVar = {"Output": ("extract", "gate_arrays")}

    label_array: str = option(
        "Inside", "Cell array of the mesh that is not 0 inside, for the method array.", when=("method", "array")
    )
    extract: bool = option(False, "Keep the inside cells only.")
    gate_arrays: bool = option(
        False,
        "Add what the gate tree knows of each cell: GateWidth, RoomRadius and GateParent.",
        when=("method", "gates"),
    )


ROOTS = ("paper", "widest", "point")


@dataclass(frozen=True)
class ThinningOptions(Options):
    """Parameters of thinning."""

    most_points: int = option(
        100_000,
        "How many points are kept at most. A cloud of no more points is passed as it is.",
        bounds=(100, math.inf),
        slider=(1000, 1_000_000),
    )
    samples_per_radius: float = option(
        6.0,
        "How many points lie on a stretch of the surface as long as its distance from the medial axis, inside or "
        "outside. Fewer where the cloud has no more, or where no more may be kept.",
        bounds=(1.0, 100.0),
        slider=(3.0, 20.0),
    )


@dataclass(frozen=True)
class CurveOptions(Options):
    """Parameters of the curve skeleton."""

    groups: ClassVar = {"Root": ("root", "root_point"), "Medial Sheets": ("sheets", "sheet_angle")}

    detail: float = option(
        0.5,
        "How much is drawn, from the main lines (0) through what a person would draw (0.5) to every bump (1). Loops "
        "are drawn at every detail.",
        bounds=(0.0, 1.0),
    )
    loop_spacings: float = option(
        1.45,
        "How wide the narrowest passage of a loop must be for the loop to count. Narrower ones are gaps between "
        "samples and are cut.",
        unit="local distance between points",
        bounds=(0.0, 100.0),
        slider=(0.0, 5.0),
    )
    denoise: bool = option(
        True,
        "Move noisy points of a surface back onto it first; for points only, a mesh is taken as it is. Points without "
        "noise are left as they are.",
    )
    root: str = option(
        "paper",
        "Where each piece is rooted: at the node nearest to the hull facet with the smallest first coordinate (paper), "
        "at the widest node (widest), or at the node nearest to the root point (point).",
        choices=ROOTS,
    )
    root_point: tuple[float, ...] = option(
        (0.0, 0.0, 0.0), "The point for root = point.", unit="length of the input", when=("root", "point")
    )
    sheets: bool = option(
        False,
        "Give the medial sheets too, as triangles with radii on the third output: they lie midway between facing sides "
        "of the object, and describe plates, which no curve does.",
        flag=None,
    )
    sheet_angle: float = option(
        120.0,
        "Least angle between the nearest points of the surface as seen from a sheet. 180 keeps what lies between "
        "parallel sides only; below 90 come the sheets that run into right-angled edges, then faces between "
        "neighbouring samples; 0 keeps every face.",
        unit="degrees",
        bounds=(0.0, 180.0),
        when=("sheets", "1"),
    )


DIMENSIONS = ("auto", "space", "plane")


@dataclass(frozen=True)
class SurfaceOptions(Options):
    """Parameters of the surface rebuilt from a skeleton."""

    groups: ClassVar = {"Grid": ("spacing", "cells_per_radius", "max_cells")}

    spacing: float = option(
        0.0,
        "Side of the cells of the grid on which the surface is found. 0 chooses it from the radii.",
        unit="length of the input",
        bounds=(0.0, math.inf),
    )
    cells_per_radius: float = option(
        5.0,
        "How many cells go into a thin part's radius when the spacing is chosen: a tenth of the skeleton's length may "
        "be thinner than that part.",
        bounds=(0.5, 100.0),
        slider=(1.0, 20.0),
        when=("spacing", "0"),
    )
    max_cells: int = option(
        1_000_000,
        "About how many cells the surface may pass through when the spacing is chosen; time and memory grow with them.",
        bounds=(1000, 100_000_000),
        slider=(100_000, 10_000_000),
        when=("spacing", "0"),
    )
    dimension: str = option(
        "auto",
        "What comes back: a closed surface (space), or the region of a plane, as its closed outline (plane). Auto goes "
        "by the skeleton: by its number of coordinates, or by what the filter that made it says.",
        choices=DIMENSIONS,
    )
    radius_array: str = option("MaximumInscribedSphereRadius", "Point array of the skeleton that holds the radii.")


@dataclass(frozen=True)
class BezierOptions(Options):
    """Parameters of the smooth curves fitted to a skeleton."""

    tolerance: float = option(
        0.1,
        "How far a curve may be from the points of its branch, in place and in radius. It stays inside the balls.",
        unit="local radius",
        bounds=(1e-6, 0.9),
        slider=(0.01, 0.5),
    )
    samples: int = option(8, "Edges of the sampled line for each cubic piece.", bounds=(2, 1000), slider=(2, 50))
    radius_array: str = option("MaximumInscribedSphereRadius", "Point array of the skeleton that holds the radii.")


VORONOI_METHODS = ("sk1", "sk2", "sk3", "sk4")


@dataclass(frozen=True)
class VoronoiOptions(Options):
    """Parameters of the Voronoi skeletons."""

    groups: ClassVar = {"Leave Out": ("least_separation", "least_angle")}

    method: str = option(
        "sk4",
        "Which skeleton: sk1 (Voronoi vertices inside the object), sk2 (all points of Voronoi edges, in space of "
        "faces, inside: they are cut at the boundary), sk3 (Voronoi vertices, edges and faces wholly inside), or sk4 "
        "(the duals of Delaunay cells inside and of their common facets and edges).",
        choices=VORONOI_METHODS,
    )
    least_separation: float = option(
        0.0,
        "Elements whose two farthest nearest points are closer together than this are left out: branches and sheets "
        "that run between neighbouring samples of one side (the lambda of the lambda-medial axis). 0 keeps all.",
        unit="fraction of the bounding-box diagonal",
        bounds=(0.0, 1.0),
    )
    least_angle: float = option(
        0.0,
        "Elements from whose widest place their two farthest nearest points are seen at a smaller angle are left out "
        "(the separation angle, twice the bisector angle). 0 keeps all; 60 keeps what lies between two sides.",
        unit="degrees",
        bounds=(0.0, 180.0),
    )


RASTER_METHODS = ("morphological", "thinning", "distance")
ELEMENTS = ("box", "cross")


@dataclass(frozen=True)
class RasterOptions(Options):
    """Parameters of the skeletons of masks."""

    method: str = option(
        "morphological",
        "Which skeleton: morphological (Lantuejoul's, from which dilations give back the mask exactly), thinning "
        "(simple points are removed until lines are left; needs scikit-image), or distance (the ridge of the map of "
        "distances to the outside).",
        choices=RASTER_METHODS,
    )
    element: str = option(
        "box",
        "What the mask is eroded with: box (a point and all its neighbours, 3 by 3 by 3) or cross (its neighbours "
        "across faces only).",
        choices=ELEMENTS,
        when=("method", "morphological"),
    )
    ridge_slope: float = option(
        0.75,
        "A point is on the ridge when the distance grows by less than this, per length, towards each of its "
        "neighbours. Up a flank it grows by 1, along a ridge between two parallel sides by 0; smaller values keep "
        "less.",
        unit="slope",
        bounds=(0.0, 1.0),
        when=("method", "distance"),
    )


@dataclass(frozen=True)
class RasterInputOptions(RasterOptions):
    """Parameters of the skeletons of masks, with what the mask is made from."""

    groups: ClassVar = {"Mask": ("mask_array", "resolution")}

    mask_array: str = option(
        "",
        "Point array of an image that is not 0 inside; without a name the image's active scalars.",
        when=("Input", "image"),
    )
    resolution: int = option(
        128,
        "For points and meshes, which are made into a mask first: grid points along the longest side of the box.",
        unit="grid points",
        bounds=(2, 2048),
        slider=(16, 512),
        when=("Input", "points"),
    )


COMPARED = ("curve", "tree", *VORONOI_METHODS, *RASTER_METHODS, "bezier")


@dataclass(frozen=True)
class CompareOptions(Options):
    """Parameters of the comparison; what is not named here is at its default in every method."""

    methods: str = option(
        "all",
        f"Which skeletons to draw: all, or some of {', '.join(COMPARED)}, with commas between them.",
    )
    detail: float = option(
        CurveOptions.detail,
        "Of curve and bezier: how much is drawn, from the main lines (0) to every bump (1).",
        bounds=(0.0, 1.0),
    )
    least_angle: float = option(
        VoronoiOptions.least_angle,
        "Of sk1 to sk4: elements whose nearest points are seen at a smaller angle are left out. 0 keeps all.",
        unit="degrees",
        bounds=(0.0, 180.0),
    )
    resolution: int = option(
        RasterInputOptions.resolution,
        "Of morphological, thinning and distance: grid points along the longest side of the box.",
        unit="grid points",
        bounds=(2, 2048),
    )
