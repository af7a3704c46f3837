"""The medial sheets as triangles: for plates, which no curve describes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.curve import CurveModel, lifted
from tetraskel.kernels.dual_complex import dual_complex

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


@dataclass(frozen=True)
class MedialMesh:
    """Triangles of the medial sheets.

    Attributes
    ----------
    points : (p, e) float
        Medial nodes, then one centre per face.
    triangles : (t, 3) int
    radius : (p,) float
        Of the ball around each point: a node's own, a centre's mean of its nodes'.
    """

    points: Floats
    triangles: Ints
    radius: Floats


def medial_mesh(model: CurveModel) -> MedialMesh:
    """Interior faces of the Voronoi diagram, each as a fan of triangles around its centre.

    Faces are the 2-cells of the dual complex: one per mesh edge (in 2D none has an area of interest, but the cells
    are the same) whose ring of simplices closes inside. Those with a corner that is no circumcentre are left out.

    Parameters
    ----------
    model : CurveModel

    Returns
    -------
    MedialMesh
        Faces in the order of their mesh edges.
    """
    inner, nodes = model.inner, model.nodes
    cells = dual_complex(inner.simplices, inner.neighbors, len(inner.coordinates))
    sizes = np.diff(cells.ring_start)
    face = np.repeat(np.arange(cells.n_ridges), sizes)
    ends = cells.facets[cells.ring_facets]  # every corner of a face ends two of its edges
    good = np.ones(cells.n_ridges, bool)
    good[face[~nodes.is_medial[ends].all(axis=1)]] = False
    centres = _means(nodes.positions[ends].mean(axis=1), face, sizes)[good]
    radii = _means(nodes.radii[ends].mean(axis=1)[:, None], face, sizes)[good, 0]
    number = np.cumsum(good) - 1 + len(nodes.positions)
    drawn = good[face]
    triangles = np.column_stack([ends[drawn], number[face[drawn]]])
    positions = np.concatenate([nodes.positions, centres])
    return MedialMesh(lifted(positions, inner.mesh), triangles, np.concatenate([nodes.radii, radii]))


def _means(values: Floats, face: Ints, sizes: Ints) -> Floats:
    """(faces, k) means of (edges, k) values."""
    columns = [np.bincount(face, column, minlength=len(sizes)) for column in values.T]
    return np.stack(columns, axis=1) / np.maximum(sizes, 1)[:, None]
