"""Every parameter of every filter: name, default, unit, bounds and meaning, in one place.

A frozen dataclass per filter. The kernels take their keyword defaults from it, and the VTK setters, the
ParaView panel and the command-line options are generated from it, so the faces cannot disagree.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from numbers import Real
from typing import Any

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
    flag: str = "",
) -> Any:
    """A dataclass field that carries what the faces need to show it.

    `when` names another option and the word of it for which this one matters (a panel hides it otherwise); `flag` is
    its name on the command line where that is not its own.
    """
    metadata = {"doc": doc, "unit": unit, "bounds": bounds, "choices": choices, "when": when, "flag": flag}
    return field(default=default, metadata=metadata)


@dataclass(frozen=True)
class Options:
    """Base of the parameter sets; checks every value against its declaration."""

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
        "matters where the sampling is denser than the object is thick; larger values demand a denser sampling.",
        unit="room radius / door width",
        bounds=(1.0, 100.0),
        when=("method", "gates"),
    )
    noise: float = option(
        0.0,
        "Gates narrower than this many times the local scatter of the points, estimated from them, are no doors: "
        "rooms between noisy points are then not taken for objects. 0 switches it off; 2 suits noisy scans.",
        unit="standard deviations",
        bounds=(0.0, 100.0),
        when=("method", "gates"),
    )


@dataclass(frozen=True)
class InteriorCellsOptions(InteriorOptions):
    """Parameters of inside and outside on a mesh with named arrays."""

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
class CurveOptions(Options):
    """Parameters of the curve skeleton."""

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
