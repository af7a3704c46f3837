"""Which simplices of a triangulation lie inside the object: by gates, by an array, or all of them."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.errors import InputError, InsideWarning
from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.gates import gate_tree, inside_by_gates
from tetraskel.kernels.mesh import Triangulation
from tetraskel.options import InteriorOptions

Bools = NDArray[np.bool_]


def interior(
    mesh: Triangulation,
    *,
    method: str = InteriorOptions.method,
    ratio: float = InteriorOptions.ratio,
    labels: ArrayLike | None = None,
    tick: Tick = silent,
) -> Bools:
    """(m,) simplices that lie inside.

    Parameters
    ----------
    mesh : Triangulation
        A Delaunay triangulation.
    method : {"gates", "array", "all"}
        See `InteriorOptions`.
    ratio : float
        See `InteriorOptions`; for "gates".
    labels : (m,) array of numbers or booleans
        For "array": what is not 0 is inside.
    tick : callable, optional
        Told the share of work done; may raise `Aborted`.

    Raises
    ------
    InputError
        When an option is out of bounds or what a method needs is missing or of the wrong length.

    Warns
    -----
    InsideWarning
        When nothing lies inside.
    """
    InteriorOptions(method=method, ratio=ratio)
    if method == "all" or len(mesh) == 0:
        return np.ones(len(mesh), bool)
    if method == "array":
        return inside_by_labels(len(mesh), labels)
    inside = inside_by_gates(gate_tree(mesh, tick=tick), ratio=ratio)
    if not inside.any():
        warnings.warn(
            f"nothing lies inside: no room is {ratio:g} times larger than the widest way into it. The points may "
            "fill a volume, lie on an open surface, or be too sparse; try method 'all' or a smaller ratio.",
            InsideWarning,
            stacklevel=2,
        )
    return inside


def inside_by_labels(n_simplices: int, labels: ArrayLike | None) -> Bools:
    """(m,) simplices whose label is not 0.

    Raises
    ------
    InputError
        When there are no labels, not one number per simplex, or labels that are not numbers.
    """
    if labels is None:
        raise InputError("expected labels for method 'array', got none; name a cell array of the mesh.")
    given = np.asarray(labels)
    if given.shape != (n_simplices,):
        raise InputError(f"expected one label for each of {n_simplices} simplices, got shape {given.shape}.")
    if given.dtype.kind not in "biuf":
        raise InputError(f"expected labels as numbers or booleans, got an array of type {given.dtype}.")
    if given.dtype.kind == "f" and not np.isfinite(given).all():
        raise InputError("expected finite labels, got NaN or infinity.")
    return np.asarray(given != 0)
