"""Where a curve skeleton is rooted: at the first facet of each component, or where its nodes have the least value."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.errors import InputError
from tetraskel.kernels.inner_mesh import InnerMesh
from tetraskel.kernels.medial_tree import MedialTree
from tetraskel.kernels.mesh import Triangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


def first_facets(inner: InnerMesh, tree: MedialTree) -> Floats:
    """(c, d) barycentre of the boundary facet of each component that comes first by its coordinates."""
    corners = inner.coordinates
    cells, opposite = np.nonzero(inner.neighbors < 0)
    component = tree.component[cells]
    total = corners[inner.simplices[cells]].sum(axis=1) - corners[inner.simplices[cells, opposite]]
    least = np.full(len(tree.roots), np.inf)
    np.minimum.at(least, component, total[:, 0])
    some = np.flatnonzero(total[:, 0] == least[component])
    order = some[np.lexsort([*total[some].T[::-1], component[some]])]
    first = order[np.flatnonzero(np.diff(component[order], prepend=-1))]
    return np.asarray(total[first] / corners.shape[1])


def first_of_each(component: Ints, value: Floats) -> Ints:
    """Index of the least value of each component, the first of equal ones."""
    order = np.lexsort([np.arange(len(value)), value, component])
    return order[np.flatnonzero(np.diff(component[order], prepend=-1))]


def in_mesh(place: ArrayLike, mesh: Triangulation) -> Floats:
    """(d,) a place in the coordinates of the mesh.

    Raises
    ------
    InputError
        When it is neither as long as the points nor in space.
    """
    dim = mesh.points.shape[1]
    given = np.asarray(place, dtype=float)
    if given.shape not in {(dim,), (3,)}:
        raise InputError(f"expected a root as {dim} coordinates, got shape {given.shape}.")
    return given[:dim] if mesh.plane is None else mesh.plane.project(given[None, :dim])[0]
