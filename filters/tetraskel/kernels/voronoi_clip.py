"""Voronoi faces cut by the object's boundary, where a walk around the parts (`voronoi_parts`) does not tell them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.barycentric import dots
from tetraskel.kernels.polygon_slabs import (
    BOTTOM,
    ENTER,
    INSIDE,
    LEAVE,
    TOP,
    UNSURE,
    Walls,
    cut_into_slabs,
    monotone_polygons,
    sides_between,
    trapezoids_of,
    walls_from,
)
from tetraskel.kernels.voronoi_crossings import Crossings
from tetraskel.kernels.voronoi_diagram import VoronoiDiagram
from tetraskel.kernels.voronoi_faces import VoronoiFaces, frames
from tetraskel.kernels.voronoi_sides import inside_at, locate, plain_edges

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

BALL = 2.0  # bounding-box diagonals around the middle beyond which no part of a face is looked at
FACES = 1 << 12  # faces at a time
# of 0.7 radians: lines of slabs parallel to no edge of a shape drawn along the axes
COSINE, SINE = math.cos(0.7), math.sin(0.7)


def clipped_faces(
    diagram: VoronoiDiagram, crossings: Crossings, inside: Bools, faces: VoronoiFaces
) -> tuple[Ints, Ints, Floats]:
    """The parts of ordered faces that lie in the object.

    Returns
    -------
    face : (p,) int
        Row of each polygon's face.
    starts : (p+1,) int
    corners : (total, 3) float
    """
    if len(faces.keys) == 0:
        return np.empty(0, np.int64), np.zeros(1, np.int64), np.empty((0, 3))
    plain = plain_edges(diagram, crossings, inside)
    found, n, total = [], len(faces.keys), 0
    for first in range(0, n, FACES):
        chosen = np.arange(first, min(first + FACES, n))
        face, begins, corners = _clip(diagram, crossings, inside, plain, faces.some(chosen))
        found.append((face + first, begins[:-1] + total, corners))
        total += len(corners)
    face, begins, corners = (np.concatenate(column) for column in zip(*found, strict=True))
    return face, np.append(begins, total), corners


def _clip(
    diagram: VoronoiDiagram, crossings: Crossings, inside: Bools, plain: Bools, faces: VoronoiFaces
) -> tuple[Ints, Ints, Floats]:
    low, high = faces.generators.T
    x = diagram.coordinates
    origins = (x[low] + x[high]) / 2
    first, second, _ = frames(x[high] - x[low])
    axes = np.stack([COSINE * first + SINE * second, COSINE * second - SINE * first], axis=1)
    polygon, ends, kinds, edge, places = _own_walls(diagram, faces, origins, axes)
    of_segment, segment_ends, segment_kinds = _boundary_walls(crossings, faces, origins, axes)
    # the left end first, and what belongs to the ends with it
    turned = ends[:, 0, 0] > ends[:, 1, 0]
    places = np.where(turned[:, None], places[:, ::-1], places)
    standing = ends[:, 0, 0] != ends[:, 1, 0]
    edge, places = edge[standing], places[standing]
    own = walls_from(polygon, ends, kinds)
    boundary = walls_from(of_segment, segment_ends, segment_kinds)
    walls = Walls(
        np.concatenate([own.polygon, boundary.polygon]),
        np.concatenate([own.ends, boundary.ends]),
        np.concatenate([own.kind, boundary.kind]),
    )
    cut = cut_into_slabs(walls, len(faces.keys))
    slab, u, wall, heights = cut
    own_says = np.full(len(wall), UNSURE)
    asked = np.flatnonzero(walls.kind[wall] <= TOP)
    at = wall[asked]
    span = walls.ends[at, :, 0]
    share = (0.5 * (u[asked, 0] + u[asked, 1]) - span[:, 0]) / (span[:, 1] - span[:, 0])
    on_edge = places[at, 0] + share * (places[at, 1] - places[at, 0])
    known = plain[edge[at]]
    own_says[asked[known]] = inside_at(diagram, crossings, inside, edge[at[known]], on_edge[known])
    sides = sides_between(walls, slab, wall, own_says)
    unsure = np.flatnonzero(sides == UNSURE)
    if len(unsure):
        middle = np.stack([u[unsure].mean(axis=1), (heights[unsure] + heights[unsure + 1]).mean(axis=1) / 2], axis=1)
        face = walls.polygon[wall[unsure]]
        spots = _in_space(middle, origins[face], axes[face])
        sides[unsure] = locate(diagram, faces.cells[faces.starts[face]], spots)
    parts = trapezoids_of(walls, cut, np.flatnonzero(sides == INSIDE))
    face, starts, corners = monotone_polygons(parts)
    owner = np.repeat(face, np.diff(starts))
    return face, starts, _in_space(corners, origins[owner], axes[owner])


def _in_space(places: Floats, origins: Floats, axes: Floats) -> Floats:
    """(k, 3) places that have two coordinates along two axes."""
    return origins + (places[:, :1] * axes[:, 0] + places[:, 1:] * axes[:, 1])


def _in_plane(places: Floats, origins: Floats, axes: Floats) -> Floats:
    """(k, 2, 2) coordinates along two axes of two places each."""
    return dots((places - origins[:, None])[:, :, None], axes[:, None])


def _own_walls(
    diagram: VoronoiDiagram, faces: VoronoiFaces, origins: Floats, axes: Floats
) -> tuple[Ints, Floats, Ints, Ints, Floats]:
    """Polygon, ends, kind, Voronoi edge and places on it, of the faces' own edges, counter-clockwise."""
    m = len(diagram.simplices)
    face = np.repeat(np.arange(len(faces.keys)), faces.counts)
    ahead, behind = faces.ahead, faces.behind
    opening = np.flatnonzero(diagram.neighbors.ravel()[behind] < 0)
    rows = np.concatenate([np.arange(len(face)), opening])
    edge = diagram.edges_of_halves(np.concatenate([ahead, behind[opening]]))
    incoming = np.arange(len(rows)) >= len(face)
    cell = faces.cells[rows]
    own_first = (diagram.ends[edge, 0] == cell) | (diagram.ends[edge, 1] >= m)
    # the way round the face: away from the cell along `ahead`, towards it along the ray that opens the face
    forward = own_first != incoming
    places = np.where(forward[:, None], [0.0, 1.0], [1.0, 0.0])
    places = _within_ball(diagram, edge, places)
    start, stop = diagram.positions[diagram.ends[edge, 0]], diagram.positions[diagram.ends[edge, 1]]
    ends = start[:, None] + places[:, :, None] * (stop - start)[:, None]
    kept = places[:, 0] != places[:, 1]
    flat = _in_plane(ends, origins[face[rows]], axes[face[rows]])
    kinds = np.where(flat[:, 1, 0] > flat[:, 0, 0], BOTTOM, TOP)
    return face[rows][kept], flat[kept], kinds[kept], edge[kept], places[kept]


def _within_ball(diagram: VoronoiDiagram, edges: Ints, places: Floats) -> Floats:
    """Places drawn together to the part of each edge in a ball around everything; equal where there is none."""
    x = diagram.coordinates
    middle, radius = (x.max(axis=0) + x.min(axis=0)) / 2, BALL * diagram.size
    start = diagram.positions[diagram.ends[edges, 0]] - middle
    way = diagram.positions[diagram.ends[edges, 1]] - middle - start
    square = dots(way, way)
    square[square == 0] = 1.0
    nearest = -dots(start, way) / square
    off = start + nearest[:, None] * way
    off = dots(off, off)
    half = np.sqrt(np.maximum(radius**2 - off, 0) / square)
    low, high = np.clip(nearest - half, 0, 1), np.clip(nearest + half, 0, 1)
    return np.clip(places, low[:, None], high[:, None])


def _boundary_walls(
    crossings: Crossings, faces: VoronoiFaces, origins: Floats, axes: Floats
) -> tuple[Ints, Floats, Ints]:
    """Polygon, ends and kind of the boundary's segments on the faces."""
    if len(faces.keys) == 0:
        return np.empty(0, np.int64), np.empty((0, 2, 2)), np.empty(0, np.int64)
    segments = crossings.segments
    face, rows = crossings.segments_of(crossings.of_faces(faces.keys))
    ends = _in_plane(segments.places[rows], origins[face], axes[face])
    up = dots(segments.outward[rows], axes[face, 1])
    return face, ends, np.where(up < 0, ENTER, LEAVE)
