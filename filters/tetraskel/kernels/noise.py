"""How far a cloud's points scatter about the surface they were taken from, estimated from the points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tetraskel.errors import EngineError
from tetraskel.kernels.chunks import CHUNK, for_chunks
from tetraskel.kernels.gates import GateTree
from tetraskel.kernels.mesh import Triangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

NEIGHBORS = {2: 8, 3: 16}  # enough for a plane or a line with some scatter, few enough to follow a bend


def scatter(coordinates: Floats) -> Floats:
    """(n,) standard deviation of each point's neighbourhood across its best-fitting line or plane.

    In the unit of the points. The root of the smallest eigenvalue of the covariance of the nearest points; on a
    bent surface without noise it is the bend's sagitta.

    Raises
    ------
    EngineError
        When SciPy is missing.
    """
    try:
        from scipy.spatial import cKDTree
    except ImportError as error:
        raise EngineError(
            "estimating noise needs the package scipy, which is not installed; set noise to 0."
        ) from error
    n, dim = coordinates.shape
    near = cKDTree(coordinates).query(coordinates, min(NEIGHBORS[dim], n))[1]
    deviation = np.empty(n)

    def work(piece: slice) -> None:
        around = coordinates[near[piece]]
        around = around - around.mean(axis=1, keepdims=True)
        covariance = np.einsum("kia,kib->kab", around, around) / around.shape[1]
        deviation[piece] = np.sqrt(np.maximum(np.linalg.eigvalsh(covariance)[:, 0], 0))

    for_chunks(work, n, chunk=CHUNK // 4)
    return deviation


def noise_at_gates(mesh: Triangulation, tree: GateTree) -> Floats:
    """(b,) mean scatter at the corners of each gate, 0 at the root."""
    return mean_at_gates(tree, scatter(mesh.coordinates), mesh.simplices[tree.facet // (mesh.dim + 1)])


def mean_at_gates(tree: GateTree, values: Floats, simplices: Ints) -> Floats:
    """(b,) mean of point values (n,) at the corners of gates, facets of these (b, d+1) simplices; 0 at the root."""
    dim = simplices.shape[1] - 1
    corners = values[simplices]
    total = corners.sum(axis=1) - corners[np.arange(len(corners)), tree.facet % (dim + 1)]
    return np.where(tree.facet < 0, 0, total / dim)
