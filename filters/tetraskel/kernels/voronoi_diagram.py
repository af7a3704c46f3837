"""The Voronoi diagram of a triangulation's points: its vertices are circumcentres, its edges join those of neighbours.

Edges of cells without an end are cut off beyond the mesh, where nothing of an object lies.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.barycentric import dots
from tetraskel.kernels.chunks import Tick, for_chunks, silent
from tetraskel.kernels.loops_in_python import call_compiled
from tetraskel.kernels.medial_nodes import FLAT, borrow_centres
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.passage_widths import circumscribed, corners_by_axis

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

# Rays end this many bounding-box diagonals beyond their first point's distance from the middle: outside of everything.
FAR = 4.0
# Relative volume up to which rounding decides the orientation. Needles are flat by their volume but well oriented: two
# samples of a surface, close together, and one far away.
UNORIENTED = 1e-12
NO_VOLUME = 1e-30  # relative: rounding made it, and its centre could be anywhere


@dataclass(frozen=True)
class VoronoiDiagram:
    """Vertices and edges, with the Delaunay elements they are dual to.

    Attributes
    ----------
    coordinates : (n, d) float
        The generators.
    simplices, neighbors : (m, d+1) int
    inside : (m,) bool
        Simplices of the object.
    positions : (m + h, d) float
        Circumcentre of each simplex, then the end of the ray through each of h hull facets.
    radii : (m,) float
        Circumradii: distance to the nearest generators.
    signs : (m,) int
        1 where the corners are positively oriented, -1 where negatively, 0 where they are flat.
    centred : (m,) bool
        The simplex contains its circumcentre.
    ends : (f, 2) int
        Positions that each Voronoi edge joins. The first belongs to the simplex that has the dual facet.
    halves : (f,) int
        That facet, as simplex * (d+1) + opposite vertex.
    """

    coordinates: Floats
    simplices: Ints
    neighbors: Ints
    inside: Bools
    positions: Floats
    radii: Floats
    signs: Ints
    centred: Bools
    ends: Ints
    halves: Ints

    @property
    def dim(self) -> int:
        """Dimension of the space."""
        return self.coordinates.shape[1]

    @property
    def size(self) -> float:
        """Diagonal of the bounding box of the generators."""
        return float(np.sqrt((np.ptp(self.coordinates, axis=0) ** 2).sum())) if len(self.coordinates) else 0.0

    @cached_property
    def on_boundary(self) -> Bools:
        """(f,) edges whose dual facet has the object on one side only."""
        here, there = self._labels_beside
        return here != there

    @cached_property
    def within(self) -> Bools:
        """(f,) edges whose dual facet has the object on both sides."""
        here, there = self._labels_beside
        return here & there

    @cached_property
    def stars(self) -> tuple[Ints, Ints] | None:
        """Where the simplices around each generator begin, and these; None without numba."""
        arguments = (self.simplices, len(self.coordinates))
        found = call_compiled("voronoi_loops.stars", arguments)
        return None if found is None else (found[0], found[1])

    @cached_property
    def _labels_beside(self) -> tuple[Bools, Bools]:
        labels = np.append(self.inside, False)
        return labels[self.ends[:, 0]], labels[np.minimum(self.ends[:, 1], len(self.inside))]

    @cached_property
    def edge_of_first_half(self) -> Ints:
        """(m * (d+1),) Voronoi edge of each facet of each simplex that is one of `halves`; others have any."""
        found = np.empty(self.simplices.size, np.int32)
        found[self.halves] = np.arange(len(self.halves), dtype=np.int32)
        return found

    def edges_of_halves(self, halves: Ints) -> Ints:
        """(k,) Voronoi edges of facets of simplices, simplex * (d+1) + opposite vertex."""
        width = self.dim + 1
        cells, beyond = halves // width, self.neighbors.ravel()[halves]
        second = np.flatnonzero(beyond > cells)
        first = halves.copy()
        first[second] = self._facing(beyond[second], cells[second])
        return self.edge_of_first_half[first].astype(np.int64)

    def on_halves(self, flags: Bools) -> Bools:
        """(m, d+1) flags of Voronoi edges (f,) for the facets of each simplex."""
        result = np.zeros(self.simplices.size, bool)
        few = 2 * np.count_nonzero(flags) < len(flags)
        chosen = np.flatnonzero(flags if few else ~flags)
        result[self.halves[chosen]] = True
        inner = chosen[self.ends[chosen, 1] < len(self.simplices)]
        result[self._facing(self.ends[inner, 1], self.ends[inner, 0])] = True
        result = result if few else ~result
        return result.reshape(self.simplices.shape)

    def _facing(self, cells: Ints, others: Ints) -> Ints:
        """(k,) the facet of each cell behind which the other lies."""
        width = self.dim + 1
        beside = self.neighbors[cells] == others[:, None]
        return np.asarray(cells.astype(np.int64) * width + beside.argmax(axis=1))

    def facet_corners(self, edges: Ints) -> Ints:
        """(k, d) generators around each of k edges."""
        width = self.dim + 1
        cells, opposite = np.divmod(self.halves[edges], width)
        return self.simplices.ravel()[(cells * width)[:, None] + _others(width)[opposite]]

    def facet_points(self, edges: Ints) -> Ints:
        """The same, ascending."""
        return np.sort(self.facet_corners(edges), axis=1)


def voronoi_diagram(mesh: Triangulation, inside: Bools, tick: Tick = silent) -> VoronoiDiagram:
    """The diagram dual to a Delaunay triangulation.

    Parameters
    ----------
    mesh : Triangulation
    inside : (m,) bool
        Simplices of the object.
    """
    coordinates, simplices, neighbors = mesh.coordinates, mesh.simplices, mesh.neighbors
    centres, radii, signs, centred = _balls(coordinates, simplices, neighbors, tick)
    halves = np.flatnonzero(neighbors < np.arange(len(mesh), dtype=neighbors.dtype)[:, None])
    cells = halves // simplices.shape[1]
    beyond = neighbors.ravel()[halves].astype(np.int64)
    hull = np.flatnonzero(beyond < 0)
    beyond[hull] = len(mesh) + np.arange(len(hull))
    far = _ray_ends(coordinates, simplices, centres, signs, cells[hull], halves[hull] % simplices.shape[1])
    return VoronoiDiagram(
        coordinates,
        simplices,
        neighbors,
        inside,
        np.concatenate([centres, far]),
        radii,
        signs,
        centred,
        np.stack([cells, beyond], axis=1),
        halves,
    )


def without_flat_rim(diagram: VoronoiDiagram) -> VoronoiDiagram:
    """The same diagram of the object without flat simplices on its boundary.

    They hold nothing, and the boundary behind them has the same place; but only of a solid simplex can it be said on
    which side of a facet it lies.
    """
    inside = diagram.inside.copy()
    flat = np.flatnonzero(diagram.inside & (diagram.signs == 0))
    while len(flat):
        labels = np.append(inside, False)
        rim = ~labels[diagram.neighbors[flat]].all(axis=1)
        if not rim.any():
            break
        inside[flat[rim]] = False
        flat = flat[~rim]
    return replace(diagram, inside=inside)


def _balls(coordinates: Floats, simplices: Ints, neighbors: Ints, tick: Tick) -> tuple[Floats, Floats, Ints, Bools]:
    """Circumcentres, radii, orientations and who contains its centre; flat simplices have that of a neighbour."""
    m, dim = len(simplices), coordinates.shape[1]
    centres, radii = np.empty((m, dim)), np.empty(m)
    signs, centred, flat = np.empty(m, np.int8), np.empty(m, bool), np.empty(m, bool)

    def work(piece: slice) -> None:
        corners = corners_by_axis(coordinates, simplices[piece])
        offset, volume, centred[piece] = circumscribed(corners)
        sides = corners[:, 1:] - corners[:, :1]
        spread = np.einsum("aik,aik->k", sides, sides)
        largest = spread ** (0.5 * dim)
        flat[piece] = np.abs(volume) <= FLAT * largest
        signs[piece] = np.where(np.abs(volume) <= UNORIENTED * largest, 0, np.where(volume < 0, -1, 1))
        none = np.abs(volume) <= NO_VOLUME * largest
        offset /= np.where(none, 1.0, 2 * volume)
        centres[piece] = np.where(none, corners.mean(axis=1), corners[:, 0] + offset).T
        radii[piece] = np.sqrt(np.einsum("ak,ak->k", offset, offset))

    for_chunks(work, m, tick)
    if flat.any():
        borrow_centres(neighbors, flat, centres, radii, np.arange(m))
        rows = np.flatnonzero(flat)  # the radius is the distance to their own corners, whoever lent the centre
        radii[rows] = np.sqrt(((coordinates[simplices[rows, 0]] - centres[rows]) ** 2).sum(axis=1))
        centred[rows] = False
    return centres, radii, signs, centred


def _ray_ends(
    coordinates: Floats, simplices: Ints, centres: Floats, signs: Ints, cells: Ints, opposite: Ints
) -> Floats:
    """(h, d) far points on the rays that leave the mesh through its hull facets."""
    normals = outward_normals(coordinates, simplices, cells, opposite)
    if len(cells) == 0:
        return normals
    middle = (coordinates.max(axis=0) + coordinates.min(axis=0)) / 2
    rows = np.flatnonzero(signs[cells] == 0)  # a flat simplex does not tell in from out, the middle of the mesh does
    backwards = ((coordinates[simplices[cells[rows]]].mean(axis=1) - middle) * normals[rows]).sum(axis=1)
    normals[rows[backwards < 0]] *= -1
    size = np.sqrt((np.ptp(coordinates, axis=0) ** 2).sum())
    away = np.sqrt(((centres[cells] - middle) ** 2).sum(axis=1)) + FAR * size
    return centres[cells] + normals * away[:, None]


def _others(width: int) -> Ints:
    """(width, width - 1) the corners of a simplex beside each."""
    return np.array([[i for i in range(width) if i != j] for j in range(width)])


def outward_normals(coordinates: Floats, simplices: Ints, cells: Ints, opposite: Ints) -> Floats:
    """(k, d) unit normals of facets, away from their simplices; zero where the facet has no area."""
    width = simplices.shape[1]
    others = _others(width)
    result = np.empty((len(cells), width - 1))

    def work(piece: slice) -> None:
        of_cells, apart = simplices[cells[piece]], opposite[piece, None]
        corners = coordinates[np.take_along_axis(of_cells, others[opposite[piece]], axis=1)]
        sides = corners[:, 1:] - corners[:, :1]
        first, last = sides[:, 0], sides[:, -1]
        normals = np.cross(first, last) if width == 4 else np.stack([first[:, 1], -first[:, 0]], axis=1)
        inward = coordinates[np.take_along_axis(of_cells, apart, axis=1)[:, 0]] - corners[:, 0]
        normals = np.where((dots(normals, inward) > 0)[:, None], -normals, normals)
        length = np.sqrt(dots(normals, normals))[:, None]
        result[piece] = normals / np.where(length == 0, 1.0, length)

    for_chunks(work, len(cells))
    return result
