"""Which Voronoi vertices lie inside the object, and which parts of Voronoi edges.

Voronoi edges that do not cross the boundary join vertices of one side. Each connected piece of them is labelled by what
is known for certain of its vertices: a crossing says which of its ends is inside, and a simplex that contains its own
circumcentre says where that lies.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.barycentric import barycentric_coordinates
from tetraskel.kernels.loops_in_python import call_compiled
from tetraskel.kernels.pieces import label_pieces
from tetraskel.kernels.voronoi_crossings import AT_END, Crossings
from tetraskel.kernels.voronoi_diagram import VoronoiDiagram
from tetraskel.kernels.walking import walk_to

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

# Barycentric coordinates down to this below 0 still count as inside the simplex a walk ended in.
ABOUT = 1e-6


def vertices_inside(diagram: VoronoiDiagram, crossings: Crossings) -> Bools:
    """(m + h,) positions of the diagram that lie in the object; circumcentres on its boundary do."""
    piece = _pieces(diagram, crossings)
    votes = _votes(diagram, crossings, piece)
    _ask_the_rest(diagram, piece, votes)
    inside = np.zeros(len(diagram.positions), bool)
    inside[: len(piece)] = votes[piece] > 0
    inside[: len(piece)][diagram.centred & diagram.inside] = True
    inside[: len(piece)][crossings.touching[: len(piece)]] = True
    inside[inside] = _near_the_points(diagram, diagram.positions[inside])
    return inside


def _near_the_points(diagram: VoronoiDiagram, spots: Floats) -> Bools:
    """(k,) places in the box of the generators, up to rounding: flat simplices have centres anywhere."""
    if len(spots) == 0:
        return np.empty(0, bool)
    room = AT_END * diagram.size
    low, high = diagram.coordinates.min(axis=0) - room, diagram.coordinates.max(axis=0) + room
    return np.logical_and.reduce(
        [(column >= a) & (column <= b) for column, a, b in zip(spots.T, low, high, strict=True)]
    )


def _pieces(diagram: VoronoiDiagram, crossings: Crossings) -> Ints:
    """(m,) connected piece of each circumcentre along edges that neither cross nor touch the boundary."""
    joined = diagram.neighbors >= 0
    crossed = diagram.on_boundary.copy()
    crossed[crossings.edges] = True
    if crossings.touching.any():
        crossed |= crossings.touching[diagram.ends].any(axis=1)
    joined &= ~diagram.on_halves(crossed)
    found = call_compiled("voronoi_loops.pieces", (diagram.neighbors, joined))
    return np.asarray(label_pieces(np.where(joined, diagram.neighbors, -1)) if found is None else found)


def _votes(diagram: VoronoiDiagram, crossings: Crossings, piece: Ints) -> Ints:
    """For each piece 1 where all that is known of it says inside, -1 where all says outside, else 0."""
    m, n_pieces = len(piece), int(piece.max(initial=-1)) + 1
    certain = np.flatnonzero(diagram.centred)
    voters, signs = [certain], [diagram.inside[certain]]
    edges, entering = crossings.edges, crossings.entering
    usable = _alternating(crossings, len(diagram.ends))[edges]
    first = np.flatnonzero((np.diff(edges, prepend=-1) != 0) & usable)
    last = np.flatnonzero((np.diff(edges, append=-1) != 0) & usable)
    voters.append(diagram.ends[edges[first], 0])
    signs.append(~entering[first])
    finite = last[diagram.ends[edges[last], 1] < m]
    voters.append(diagram.ends[edges[finite], 1])
    signs.append(entering[finite])
    voted, says = piece[np.concatenate(voters)], np.concatenate(signs)
    for_inside, against = np.zeros(n_pieces, bool), np.zeros(n_pieces, bool)
    for_inside[voted[says]] = True
    against[voted[~says]] = True
    return for_inside.astype(np.int8) - against


def _alternating(crossings: Crossings, n_edges: int) -> Bools:
    """(f,) edges that enter and leave by turns, always through a facet."""
    edges, entering = crossings.edges, crossings.entering
    result = np.ones(n_edges, bool)
    result[edges[~crossings.sure]] = False
    result[edges[1:][(edges[1:] == edges[:-1]) & (entering[1:] == entering[:-1])]] = False
    return result


def plain_edges(diagram: VoronoiDiagram, crossings: Crossings, inside: Bools) -> Bools:
    """(f,) Voronoi edges of which all crossings are known: they agree with one another and with the ends."""
    result = inside[diagram.ends[:, 0]] == inside[diagram.ends[:, 1]]
    edges, entering = crossings.edges, crossings.entering
    result[edges] = True
    result[edges[1:][(edges[1:] == edges[:-1]) & (entering[1:] == entering[:-1])]] = False
    first, last = np.diff(edges, prepend=-1) != 0, np.diff(edges, append=-1) != 0
    result[edges[first & (inside[diagram.ends[edges, 0]] == entering)]] = False
    result[edges[last & (inside[diagram.ends[edges, 1]] != entering)]] = False
    if crossings.touching.any():
        result[crossings.touching[diagram.ends].any(axis=1)] = False
    return result


def _ask_the_rest(diagram: VoronoiDiagram, piece: Ints, votes: Ints) -> None:
    """Pieces of which nothing is known: walk to one circumcentre of each, in place."""
    first = np.full(len(votes), -1, np.int64)
    first[piece[::-1]] = np.arange(len(piece))[::-1]
    unknown = np.flatnonzero((votes == 0) & (first >= 0))
    start = first[unknown]
    votes[unknown] = np.where(locate(diagram, start, diagram.positions[start]), 1, -1)


def locate(diagram: VoronoiDiagram, start: Ints, spots: Floats) -> Bools:
    """(k,) whether places lie in the object, by a walk to each from a simplex."""
    homes = walk_to(diagram.coordinates, diagram.simplices, diagram.neighbors, start, spots)
    holds = _hold(diagram, homes, spots)
    return holds & np.append(diagram.inside, False)[homes]


def _hold(diagram: VoronoiDiagram, homes: Ints, spots: Floats) -> Bools:
    """(k,) simplices, where there is one (not -1), that hold their place."""
    result = homes >= 0
    rows = np.flatnonzero(result)
    weights = barycentric_coordinates(diagram.coordinates, diagram.simplices[homes[rows]], spots[rows])
    result[rows] = weights.min(axis=1) >= -ABOUT
    return result


def touching(diagram: VoronoiDiagram, crossings: Crossings, inside: Bools) -> Bools:
    """(k,) crossings that are none: the edge ends on the boundary, at a vertex that counts as inside."""
    ends = diagram.ends[crossings.edges]
    at_first = (crossings.places <= AT_END) & inside[ends[:, 0]]
    at_last = (crossings.places >= 1 - AT_END) & inside[ends[:, 1]]
    return at_first | at_last


def edges_wholly_inside(diagram: VoronoiDiagram, crossings: Crossings, inside: Bools) -> Bools:
    """(f,) Voronoi edges with no point outside; of those that end on the boundary the middle is asked."""
    ends = diagram.ends
    whole = np.asarray(inside[ends[:, 0]] & inside[ends[:, 1]])
    whole[crossings.edges[~touching(diagram, crossings, inside)]] = False
    if crossings.touching.any():
        asked = np.flatnonzero(whole & crossings.touching[ends].any(axis=1))
        whole[asked] = locate(diagram, ends[asked, 0], diagram.positions[ends[asked]].mean(axis=1))
    return whole


def inside_at(diagram: VoronoiDiagram, crossings: Crossings, inside: Bools, edges: Ints, places: Floats) -> Bools:
    """(k,) whether the point at a share of the way along each Voronoi edge lies inside.

    Before the first crossing it is as the edge's first end, after the last as its last end; between two it is inside
    where the edge enters at the one and leaves at the other.
    """
    result = inside[diagram.ends[edges, 0]]
    crossed = np.zeros(len(diagram.ends), bool)
    crossed[crossings.edges] = True
    rows = np.flatnonzero(crossed[edges])
    keys = crossings.edges + 0.5 * crossings.places  # ascending; an edge's keys are below the next one's
    at = np.searchsorted(keys, edges[rows] + 0.5 * places[rows])
    padded = np.concatenate([[-1], crossings.edges, [-1]])
    beyond, begun = padded[at + 1] != edges[rows], padded[at] == edges[rows]
    result[rows[beyond]] = inside[diagram.ends[edges[rows[beyond]], 1]]
    between = begun & ~beyond
    after = at[between]
    result[rows[between]] = crossings.entering[after - 1] & ~crossings.entering[after]
    return result


def parts_of_edges(diagram: VoronoiDiagram, crossings: Crossings, inside: Bools, whole: Bools) -> tuple[Ints, Ints]:
    """Parts of Voronoi edges inside the object, along each edge.

    Parameters
    ----------
    whole : (f,) bool
        Edges of which all is inside.

    Returns
    -------
    edges : (s,) int
    nodes : (s, 2) int
        What a part begins and ends with: a position of the diagram, or after all these a crossing.
    """
    cut, nodes = parts_of_cut_edges(diagram, crossings, inside, whole)
    uncut = np.flatnonzero(whole)
    edges = np.concatenate([uncut, cut])
    order = np.argsort(edges, kind="stable")
    return edges[order], np.concatenate([diagram.ends[uncut], nodes])[order]


def parts_of_cut_edges(diagram: VoronoiDiagram, crossings: Crossings, inside: Bools, whole: Bools) -> tuple[Ints, Ints]:
    """The same of the edges that are not whole alone.

    Between two crossings lies the object where the edge enters at the first and leaves at the second.
    """
    edges, places, entering = crossings.edges, crossings.places, crossings.entering
    begins, finishes = np.diff(edges, prepend=-1) != 0, np.diff(edges, append=-1) != 0
    ends, cut = diagram.ends[edges], ~whole[edges]
    from_first = np.flatnonzero(cut & begins & ~entering & inside[ends[:, 0]] & (places > 0))
    to_last = np.flatnonzero(cut & finishes & entering & inside[ends[:, 1]] & (places < 1))
    between = np.flatnonzero(cut[:-1] & entering[:-1] & ~entering[1:] & ~begins[1:] & (places[1:] > places[:-1]))
    node = len(diagram.positions) + np.arange(len(edges))
    start = np.concatenate([ends[from_first, 0], node[to_last], node[between]])
    stop = np.concatenate([node[from_first], ends[to_last, 1], node[between + 1]])
    at = np.concatenate([from_first, to_last, between])
    order = np.argsort(at, kind="stable")
    return edges[at[order]], np.stack([start[order], stop[order]], axis=1)
