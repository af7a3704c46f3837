"""The parts of Voronoi faces inside the object, by a walk around each.

Around a part one goes along the face's own edges where they are inside, and along the object's boundary from where it
crosses such an edge to where it crosses the next. Who begins where who ends is known by name, so nothing is measured
and all parts have their corners in common. What is not told that way is left to `voronoi_clip`: faces that touch the
boundary more than they cross it, and the few that the boundary crosses without meeting their edges.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.compilation import numba_is_used
from tetraskel.kernels.loops_in_python import gather_compiled
from tetraskel.kernels.voronoi_crossings import LOST, Crossings
from tetraskel.kernels.voronoi_diagram import VoronoiDiagram
from tetraskel.kernels.voronoi_faces import VoronoiFaces
from tetraskel.kernels.voronoi_sides import parts_of_cut_edges, parts_of_edges, plain_edges

Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]


class Parts(NamedTuple):
    """Polygons around the parts, by their faces, and faces of which they cannot be told.

    Attributes
    ----------
    faces : (p,) int
    counts : (p,) int
        Number of corners, three or more.
    nodes : (total,) int
        Corners, polygon after polygon: positions of the diagram, then crossings, then segments that begin there.
        Counter-clockwise around the face's edge from its smaller to its larger point.
    unsure : (u,) int
    """

    faces: Ints
    counts: Ints
    nodes: Ints
    unsure: Ints


class _Ways(NamedTuple):
    """Ways along edges and segments: face, what they begin and end at, and the node they begin with."""

    face: Ints
    begin: Ints
    end: Ints
    node: Ints


def parts_of_faces(
    diagram: VoronoiDiagram,
    crossings: Crossings,
    inside: Bools,
    whole: Bools,
    faces: VoronoiFaces,
    tick: Tick = silent,
) -> Parts:
    """The parts of ordered faces that lie in the object.

    Parameters
    ----------
    whole : (f,) bool
        Voronoi edges that are wholly inside.
    """
    known = plain_edges(diagram, crossings, inside) | whole
    touching = crossings.touching[: len(diagram.simplices)]
    n_positions, n_nodes = len(diagram.positions), len(diagram.positions) + len(crossings.edges)
    ends = np.where(crossings.segments.ends >= 0, crossings.segments.ends + n_positions, crossings.segments.ends)
    ends[ends[:, 1] == LOST, 1] += 1  # nothing begins where it ends
    bounds = crossings.of_faces(faces.keys)
    compiled = numba_is_used()
    edges, nodes = (parts_of_cut_edges if compiled else parts_of_edges)(diagram, crossings, inside, whole)
    first_part = np.concatenate([[0], np.cumsum(np.bincount(edges, minlength=len(diagram.ends)))])
    if not compiled:
        segments = (crossings.segments_of(bounds), ends, n_nodes)
        return _in_arrays(diagram, known, touching, (first_part, nodes), segments, faces)
    of_faces = (crossings.by_face, ends, n_nodes)
    mesh = (diagram.neighbors, diagram.ends, diagram.edge_of_first_half, diagram.on_halves(whole))
    given = (mesh, known, touching, (first_part, nodes), int(np.diff(first_part).max(initial=1)), of_faces)
    polygons, corners, unsure = gather_compiled(
        "part_loops.walked",
        lambda piece: (*given, piece.start, *faces.rings(piece), bounds[piece]),
        len(faces.keys),
        tick,
    )
    return Parts(polygons[:, 0], polygons[:, 1], corners, np.flatnonzero(unsure))


def _in_arrays(
    diagram: VoronoiDiagram,
    known: Bools,
    touching: Bools,
    parts: tuple[Ints, Ints],
    segments: tuple[tuple[Ints, Ints], Ints, int],
    faces: VoronoiFaces,
) -> Parts:
    """The same as array operations: all faces go a step at a time."""
    own, unsure = _own_ways(diagram, known, touching, parts, faces)
    (face, rows), ends, n_nodes = segments
    begin, end = ends[rows].T
    crossing = _Ways(face, begin, end, np.where(begin >= 0, begin, n_nodes + rows))
    ways = _Ways(*(np.concatenate(column) for column in zip(own, crossing, strict=True)))
    is_own = np.arange(len(ways.face)) < len(own.face)
    order: Ints = np.flatnonzero(~unsure[ways.face])
    order = order[np.argsort(ways.face[order], kind="stable")]
    ways, is_own = _Ways(*(column[order] for column in ways)), is_own[order]
    after, broken = _after(ways)
    unsure[ways.face[broken]] = True
    kept = np.flatnonzero(~unsure[ways.face])
    number = np.cumsum(~unsure[ways.face]) - 1
    ways = _Ways(*(column[kept] for column in ways))
    face, sizes, corners, left = _rounds(ways, is_own[kept], number[after[kept]])
    unsure[left] = True
    good = ~unsure[face]
    good &= sizes >= 3
    return Parts(face[good], sizes[good], corners[np.repeat(good, sizes)], np.flatnonzero(unsure))


def _own_ways(
    diagram: VoronoiDiagram, known: Bools, touching: Bools, parts: tuple[Ints, Ints], faces: VoronoiFaces
) -> tuple[_Ways, Bools]:
    """Ways along the faces' own edges, where these are inside, and the faces of which not all is known."""
    first_part, nodes = parts
    m, face = len(diagram.simplices), np.repeat(np.arange(len(faces.keys)), faces.counts)
    behind = faces.behind
    opening = np.flatnonzero(diagram.neighbors.ravel()[behind] < 0)
    rows = np.concatenate([np.arange(len(face)), opening])
    edge = diagram.edges_of_halves(np.concatenate([faces.ahead, behind[opening]]))
    unsure = ~faces.any_of(~touching[faces.cells])
    unsure[face[rows[~known[edge]]]] = True
    own_first = (diagram.ends[edge, 0] == faces.cells[rows]) | (diagram.ends[edge, 1] >= m)
    # the way round the face: away from the cell along `ahead`, towards it along the ray that opens the face
    forward = own_first != (np.arange(len(rows)) >= len(face))
    counts = first_part[edge + 1] - first_part[edge]
    row = np.repeat(np.arange(len(rows)), counts)
    step = np.arange(len(row)) - np.repeat(np.cumsum(counts) - counts, counts)
    onward = forward[row]
    part = np.where(onward, first_part[edge[row]] + step, first_part[edge[row] + 1] - 1 - step)
    begin = np.where(onward, nodes[part, 0], nodes[part, 1])
    return _Ways(face[rows[row]], begin, np.where(onward, nodes[part, 1], nodes[part, 0]), begin), unsure


def _after(ways: _Ways) -> tuple[Ints, Bools]:
    """The way after each of its face, and those that have none, or are not after exactly one."""
    n = len(ways.face)
    names = np.unique(np.concatenate([ways.begin, ways.end]), return_inverse=True)[1].ravel()
    size = int(names.max(initial=0)) + 1
    begins, ends = ways.face * size + names[:n], ways.face * size + names[n:]
    order = np.argsort(begins, kind="stable")
    place = np.minimum(np.searchsorted(begins[order], ends), n - 1)
    after = order[place]
    broken = begins[after] != ends
    broken |= np.bincount(after[~broken], minlength=n) != 1
    return after, broken


def _rounds(ways: _Ways, is_own: Bools, after: Ints) -> tuple[Ints, Ints, Ints, Ints]:
    """Ways around, from the first of each face's own that is left, until none is: their faces, how many corners, and
    these; and faces of which others are left.
    """
    n = len(ways.face)
    left = np.ones(n, bool)
    rounds: list[tuple[Ints, Ints]] = []  # the first way and the one that is there now
    while True:
        open_ways = np.flatnonzero(left & is_own)
        heads = open_ways[np.diff(ways.face[open_ways], prepend=-1) != 0]
        if len(heads) == 0:
            break
        here, head = heads, heads
        while len(here):
            left[here] = False
            rounds.append((head, here))
            here = after[here]
            going = here != head
            here, head = here[going], head[going]
    first, row = (np.concatenate(column) for column in zip(*rounds, strict=True)) if rounds else (np.empty(0, int),) * 2
    order = np.argsort(first, kind="stable")
    begins = np.flatnonzero(np.diff(first[order], prepend=-1) != 0)
    counts = np.diff(np.append(begins, len(order)))
    return ways.face[first[order][begins]], counts, ways.node[row[order]], ways.face[left]
