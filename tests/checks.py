"""What must hold for every result, rebuilt from scratch."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from shapes import Shape
from tetraskel import Skeleton, Triangulation
from tetraskel.kernels.measures import samples_along
from tetraskel.kernels.nearest import Cloud

Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]


def measures(mesh: Triangulation) -> NDArray[np.float64]:
    """Areas of triangles, volumes of tetrahedra, by determinants."""
    corners = mesh.coordinates[mesh.simplices]
    return np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / (2 if mesh.dim == 2 else 6)


def overlap(mesh: Triangulation, inside: Bools, shape: Shape, n: int = 100_000) -> float:
    """Intersection over union of the inside and a shape, from random points of the simplices and of the box."""
    rng = np.random.default_rng(7)
    sizes = np.where(inside, measures(mesh), 0)
    cells = rng.choice(len(mesh), n, p=sizes / sizes.sum())
    weights = rng.dirichlet(np.ones(mesh.dim + 1), n)
    points = np.einsum("kv,kva->ka", weights, mesh.points[mesh.simplices[cells]])
    common = sizes.sum() * shape.contains(points).mean()
    box = np.prod(np.subtract(shape.high, shape.low))
    own = box * shape.contains(shape.probes(4 * n, rng)).mean()
    return float(common / (sizes.sum() + own - common))


def hull_facets(mesh: Triangulation) -> Ints:
    """(f, d) facets on the hull; triangles counter-clockwise as seen from outside."""
    found = []
    for cell, opposite in np.argwhere(mesh.neighbors < 0):
        facet = np.delete(mesh.simplices[cell], opposite)
        if mesh.dim == 3:
            a, b, c = mesh.points[facet]
            inward = np.cross(b - a, c - a) @ (mesh.points[mesh.simplices[cell, opposite]] - a) > 0
            facet = facet[::-1] if inward else facet
        found.append(facet)
    return np.array(found, dtype=np.int64).reshape(-1, mesh.dim)


def euler_characteristic(simplices: Ints) -> int:
    """Vertices - edges + triangles - tetrahedra of the closed set of some simplices, counted one by one."""
    total = 0
    for size in range(1, simplices.shape[1] + 1):
        faces = [simplices[:, chosen] for chosen in combinations(range(simplices.shape[1]), size)]
        count = len(np.unique(np.sort(np.concatenate(faces), axis=1), axis=0))
        total += count if size % 2 else -count
    return total


def hausdorff(first: Skeleton, second: Skeleton, n: int) -> float:
    """Hausdorff distance between two skeletons, from about n places of each."""
    a, b = (samples_along(one, n)[0] for one in (first, second))
    return float(max(Cloud(a).query(b)[0].max(), Cloud(b).query(a)[0].max()))


def count_pieces(neighbors: Ints, side: Bools, *, outside_too: bool = False) -> int:
    """Pieces of the simplices where `side` holds, joined across facets; with the outside as one more simplex."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    m, width = neighbors.shape
    belongs = np.append(side, outside_too)
    cells, ahead = np.repeat(np.arange(m), width), neighbors.ravel() % (m + 1)
    joined = belongs[cells] & belongs[ahead]
    graph = coo_matrix((np.ones(joined.sum()), (cells[joined], ahead[joined])), shape=(m + 1, m + 1))
    labels = connected_components(graph, directed=False)[1]
    return len(np.unique(labels[belongs]))
