"""Inside and outside of an object from points alone: the gate tree.

Take the graph of the simplices and the outside, joined across facets, and its maximum spanning tree by passage width,
rooted outside: the way from the root to a simplex is then the widest way in. A *room* is a simplex that contains its
own circumcentre, its size the circumradius. A *door* is a gate on the way to a room much larger than the gate, at the
narrowest place of that way. Doors divide the simplices into regions, and two regions that share much of their
boundary, with the object's surface between them, lie on opposite sides of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.basins import Basins, gather_basins
from tetraskel.kernels.chunks import Tick, part, silent
from tetraskel.kernels.extent import expect_extent
from tetraskel.kernels.mesh import Triangulation, expect_mesh
from tetraskel.kernels.passage_widths import widths_and_rooms
from tetraskel.kernels.spanning_tree import RootedTree, maximum_spanning_tree, rooted
from tetraskel.options import InteriorOptions

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

# The door is the narrowest place on the way to the room, not the first narrow one: gates wider than this many times
# the narrowest are none. Not 1, because next to the narrowest gate there are others almost as narrow, and the first
# of them is nearer to the surface.
NEARLY_NARROWEST = 1.75


@dataclass(frozen=True)
class GateTree:
    """The widest ways in from outside.

    Attributes
    ----------
    basins : Basins
        The tree's nodes: simplices joined across their widest facets, the outside being the last node.
    tree : RootedTree
        The widest way out of each basin.
    width : (b,) float
        Passage width of the gate between a basin and its parent, in the unit of the points; infinite at the root.
    room_radius : (b,) float
        Radius of the largest room behind that gate.
    narrowest : (b,) float
        Width of the narrowest gate from that gate to that room.
    near_room : (b,) float
        Radius of the largest room found behind that gate without passing one that is much narrower.
    facet : (b,) int
        The gate itself as simplex * (d+1) + opposite vertex, -1 at the root.
    own_room : (b,) float
        Radius of the largest room in the basin itself, 0 where there is none.
    """

    basins: Basins
    tree: RootedTree
    width: Floats
    room_radius: Floats
    narrowest: Floats
    near_room: Floats
    facet: Ints
    own_room: Floats

    @property
    def outside(self) -> int:
        """The node that stands for the outside."""
        return self.basins.count - 1


def gate_tree(mesh: Triangulation, *, tick: Tick = silent) -> GateTree:
    """The gate tree of a triangulation, 2D or 3D.

    Parameters
    ----------
    mesh : Triangulation
        A Delaunay triangulation of the whole convex hull.
    tick : callable, optional
        Told the share of work done; may raise `Aborted`.

    Raises
    ------
    InputError
        For what is not a mesh, or points that span no size that can be calculated with.
    """
    expect_mesh(mesh)
    expect_extent(mesh.points)
    widths, rooms = widths_and_rooms(mesh.coordinates, mesh.simplices, part(tick, 0.0, 0.5))
    return gate_tree_of(mesh.neighbors, widths, rooms, tick)


def gate_tree_of(neighbors: Ints, widths: Floats, rooms: Floats, tick: Tick = silent) -> GateTree:
    """The gate tree from (m, d+1) neighbours, (m, d+1) passage widths and (m,) room radii."""
    basins = gather_basins(neighbors, widths)
    tick(0.7)
    own_room = np.zeros(basins.count)
    np.maximum.at(own_room, basins.of_simplex[:-1], rooms)
    links = Links(basins.first, basins.second, basins.width, basins.facets).spanning(basins.count)
    tick(0.8)
    tree = gate_tree_of_links(basins, links, own_room)
    tick(0.9)
    return tree


@dataclass(frozen=True)
class Links:
    """Facets between basins, as links of a graph; see `Basins` for what each has."""

    first: Ints
    second: Ints
    width: Floats
    facets: Ints

    def spanning(self, n: int) -> Links:
        """Those of the maximum spanning tree of n basins, or forest; of equally wide ones the later is the stronger."""
        chosen = maximum_spanning_tree(n, self.first, self.second, self.width)
        return Links(self.first[chosen], self.second[chosen], self.width[chosen], self.facets[chosen])


def gate_tree_of_links(basins: Basins, links: Links, own_room: Floats) -> GateTree:
    """The gate tree whose gates are these, in the order of their facets; `own_room` is that of `GateTree`."""
    tree = rooted(basins.count, links.first, links.second, basins.count - 1)
    width, facet = np.full(basins.count, np.inf), np.full(basins.count, -1)
    reached = tree.link >= 0
    gates = tree.link[reached]
    width[reached], facet[reached] = links.width[gates], links.facets[gates]
    room_radius, narrowest = _largest_rooms(tree, width, own_room)
    near_room = _largest_rooms(tree, width, own_room, width / NEARLY_NARROWEST)[0]
    return GateTree(basins, tree, width, room_radius, narrowest, near_room, facet, own_room)


def _largest_rooms(
    tree: RootedTree, width: Floats, own_room: Floats, least: Floats | None = None
) -> tuple[Floats, Floats]:
    """Largest room behind each gate, and the narrowest gate on the way to it.

    With `least` a gate hears of no room whose way from there is narrower than its `least`.

    Strategy: deepest level first, each family of sons hands its best to the parent; sons are side by side, so a
    family is one segment of `reduceat`. Of equal rooms the one with the wider way counts.
    """
    radius, narrowest = own_room.copy(), width.copy()
    for level in tree.levels[:0:-1]:
        narrowest[level] = np.minimum(narrowest[level], width[level])
        parents = tree.parent[level]
        told = radius[level] if least is None else np.where(narrowest[level] < least[parents], 0, radius[level])
        first = np.flatnonzero(np.diff(parents, prepend=-1))
        families = parents[first]
        best = np.maximum.reduceat(told, first)
        is_best = told == np.repeat(best, np.diff(first, append=len(level)))
        way = np.maximum.reduceat(np.where(is_best, narrowest[level], 0), first)
        larger = best > radius[families]
        radius[families[larger]], narrowest[families[larger]] = best[larger], way[larger]
    return radius, narrowest


@dataclass(frozen=True)
class GateArrays:
    """The gate tree on the simplices, to look at: what each simplex's basin has.

    Attributes
    ----------
    width : (m,) float
        Passage width of the gate that leads out (GateWidth), infinite where no gate does: outside itself.
    room_radius : (m,) float
        Largest room behind it (RoomRadius).
    parent : (m,) int
        Simplex on the other side of it, -1 for the outside or where there is no gate (GateParent).
    """

    width: Floats
    room_radius: Floats
    parent: Ints


def gate_arrays(tree: GateTree, neighbors: Ints) -> GateArrays:
    """What the gate tree knows, for each of the simplices with these (m, d+1) neighbours."""
    basin = tree.basins.of_simplex[:-1]
    cells, ahead = tree.facet // neighbors.shape[1], np.append(neighbors, -1)[tree.facet]
    beyond = beyond_gates(tree, cells, ahead, tree.basins.of_simplex[cells])
    return GateArrays(tree.width[basin], tree.room_radius[basin], beyond[basin])


def beyond_gates(tree: GateTree, cells: Ints, ahead: Ints, basin: Ints) -> Ints:
    """(b,) simplex on the other side of each basin's gate, -1 for none.

    The gate's facet is known from one of its sides: `cells` have it, in these basins, and `ahead` is across.
    """
    leads_out = basin == np.arange(tree.basins.count)  # else the gate is seen from beyond
    return np.where(tree.facet < 0, -1, np.where(leads_out, ahead, cells))


def inside_by_gates(
    tree: GateTree, *, ratio: float = InteriorOptions.ratio, least_width: Floats | float = 0.0
) -> Bools:
    """(m,) simplices that lie inside an object.

    Parameters
    ----------
    tree : GateTree
    ratio : float
        How many times larger than its door a room must be, to lie on the other side of a surface.
    least_width : float or (b,) float
        Gates narrower than this, in the unit of the points, count as so wide: noise leaves rooms that small.
    """
    regions = regions_behind_doors(tree, ratio, least_width)
    shared = shared_facets(tree.basins, regions, ratio)
    return opposite_sides(shared)[regions.of_basin[tree.basins.of_simplex[:-1]]]


@dataclass(frozen=True)
class Regions:
    """What doors divide the basins into.

    Attributes
    ----------
    of_basin : (b,) int
        0 the outside, then one for what lies behind each door.
    size : (r,) float
        Radius of the largest room in each; the outside has no bounds.
    """

    of_basin: Ints
    size: Floats


def regions_behind_doors(tree: GateTree, ratio: float, least_width: Floats | float) -> Regions:
    """The regions behind all doors; see `inside_by_gates`."""
    door = ratio * np.maximum(tree.width, least_width)
    is_door = (tree.room_radius > door) & (tree.width <= NEARLY_NARROWEST * tree.narrowest) | (tree.near_room > door)
    of_basin = _regions(tree, is_door)
    size = np.zeros(int(of_basin.max(initial=0)) + 1)
    np.maximum.at(size, of_basin, tree.own_room)
    size[0] = np.inf
    return Regions(of_basin, size)


def _regions(tree: GateTree, is_door: Bools) -> Ints:
    """(b,) region of each basin.

    A neck has many gates nearly as narrow as its narrowest; they are one door. So the next door of a way only counts
    once a room has been entered that is larger than the last door by more than "nearly".
    """
    n, parent = tree.basins.count, tree.tree.parent
    entered, last, door = np.ones(n, bool), np.full(n, np.inf), np.full(n, -1)
    for level in tree.tree.levels[1:]:
        above = parent[level]
        opens = is_door[level] & entered[above]
        last[level] = np.where(opens, tree.width[level], last[above])
        in_room = tree.own_room[level] > NEARLY_NARROWEST * last[level]
        entered[level] = in_room | (entered[above] & ~opens)
        door[level] = np.where(opens, level, door[above])
    return np.unique(door, return_inverse=True)[1]


@dataclass(frozen=True)
class SharedFacets:
    """How many facets regions have in common.

    Attributes
    ----------
    n_regions : int
    pairs : (p,) int
        The lower region * n_regions + the higher one, increasing.
    narrow, all : (p,) int
        Facets that either region is so much larger than as doors demand, and all facets.
    """

    n_regions: int
    pairs: Ints
    narrow: Ints
    all: Ints


def shared_facets(basins: Basins, regions: Regions, ratio: float) -> SharedFacets:
    """The facets of `basins` between two regions, counted by pair."""
    n = len(regions.size)
    first, second = regions.of_basin[basins.first], regions.of_basin[basins.second]
    apart = np.flatnonzero(first != second)
    first, second = np.minimum(first, second)[apart], np.maximum(first, second)[apart]
    narrow = ratio * basins.width[apart] < np.minimum(regions.size[first], regions.size[second])
    pairs, pair_of = np.unique(first * n + second, return_inverse=True)
    of_narrow = np.bincount(pair_of[narrow], minlength=len(pairs))
    return SharedFacets(n, pairs, of_narrow, np.bincount(pair_of, minlength=len(pairs)))


def opposite_sides(shared: SharedFacets) -> Bools:
    """(r,) whether each region lies inside.

    Strategy: two regions that have many narrow facets in common have a surface between them, while a neck inside an
    object, or the mouth of a bottle, is a door of few facets. So each region is put opposite the one it shares most
    with: along the maximum spanning tree of the regions by shared facets.
    """
    n = shared.n_regions
    first, second = np.divmod(shared.pairs, n)
    weight = shared.narrow + 0.5 / (shared.all.sum() + 1) * shared.all
    links = maximum_spanning_tree(n, first, second, weight)
    inside = np.zeros(n, bool)
    sides = rooted(n, first[links], second[links], 0)
    for level in sides.levels[1:]:
        inside[level] = ~inside[sides.parent[level]]
    return inside
