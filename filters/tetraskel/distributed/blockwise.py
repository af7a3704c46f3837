"""The tree's skeleton of points larger than memory: the ranks' way, one block after another, from files to files.

Blocks take the place of ranks (`in_turn`), so that the result is the serial one, array for array; the tree may be that
of all simplices, or of those inside by gates. What the blocks find is written where it belongs in the whole skeleton,
which is never in memory either.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetraskel.distributed.flat import contract_part
from tetraskel.distributed.forests import ForestPart
from tetraskel.distributed.in_turn import TurnCommunicator, run_in_turn
from tetraskel.distributed.interior import interior_of_part
from tetraskel.distributed.parts import MeshPart, submesh_of_part
from tetraskel.distributed.shelf import Shelf
from tetraskel.distributed.skeleton import SkeletonPart, skeleton_part
from tetraskel.distributed.space import fills_space
from tetraskel.distributed.tree import build_tree_part, simplex_arrays_of_part
from tetraskel.distributed.triangulation import triangulate_part
from tetraskel.errors import InputError, InsideWarning
from tetraskel.kernels.centres import centres
from tetraskel.kernels.chunks import Tick, part, silent
from tetraskel.kernels.flat import all_flat
from tetraskel.kernels.node_arrays import forest_arrays, skeleton_arrays
from tetraskel.kernels.plane import roundings_by_axis
from tetraskel.kernels.points import distinct_points, finite_points, full_dimensional
from tetraskel.kernels.skeleton import lengths_along
from tetraskel.kernels.triangulate import ready_engine
from tetraskel.options import FlatOptions, InteriorOptions, SkeletonOptions, TreeOptions

Array = NDArray[Any]

POINTS_PER_BLOCK = 500_000  # of a block; not measured at this size
FEW = 100_000  # points that may be looked at together to say what is wrong with them
PIECE = 1 << 14  # branches treated together
INSIDES = ("all", "gates")  # of `InteriorOptions.method`, those that work in blocks


def blocks_for(n: int) -> int:
    """The number of blocks for n points where none is asked for."""
    return max(-(-n // POINTS_PER_BLOCK), 1)


@dataclass(frozen=True)
class BlockOptions:
    """What is asked of the tree's skeleton; see the options of each stage in `tetraskel.options`.

    The tree is that of the simplices inside, by the method `inside`: all, or those that gates find with `ratio` and
    `noise`.
    """

    centre: str = TreeOptions.centre
    threshold: float = FlatOptions.threshold
    keep_leaves: bool = SkeletonOptions.keep_leaves
    inside: str = "all"
    ratio: float = InteriorOptions.ratio
    noise: float = InteriorOptions.noise


@dataclass
class WholeSkeleton:
    """A skeleton in files, in the serial order.

    Attributes
    ----------
    points : (n, 3) float
    nodes : dict of (n, ...) arrays
        What is known of each node, by name.
    alone : (a,) int
        Nodes without lines.
    offsets, path : (b+1,) int, (...) int
        Branch k is `path[offsets[k]:offsets[k+1]]`.
    lengths : (b,) float
    facts : dict
        Single numbers and words.
    original_ids : (p,) int
        Input id of each point that was triangulated.
    messages : list of str
        What there was to warn of.
    """

    shelf: Shelf
    points: Array = field(default_factory=lambda: np.empty((0, 3)))
    nodes: dict[str, Array] = field(default_factory=dict)
    alone: Array = field(default_factory=lambda: np.empty(0, np.int64))
    offsets: Array = field(default_factory=lambda: np.zeros(1, np.int64))
    path: Array = field(default_factory=lambda: np.empty(0, np.int64))
    lengths: Array = field(default_factory=lambda: np.empty(0))
    facts: dict[str, int | float | str] = field(default_factory=dict)
    original_ids: Array = field(default_factory=lambda: np.empty(0, np.int64))
    first_depth: Array = field(default_factory=lambda: np.empty(0, np.int32))
    messages: list[str] = field(default_factory=list)


def skeleton_in_blocks(
    points: Array, folder: Path, n_blocks: int, options: BlockOptions | None = None, tick: Tick = silent
) -> WholeSkeleton:
    """The tree's skeleton of (n, 3) points, which may be a mapping of a file: `n_blocks` stretches of a Morton curve.

    Parameters
    ----------
    folder : path
        Where the blocks' files are meanwhile: on a disk with about 2.3 kB for each point of a volume, 3.7 kB of a
        surface.
    tick : callable, optional
        Told the share of work done; may raise `Aborted`.

    Raises
    ------
    InputError
        For points that are not finite, do not fill space, or give flat simplices only; for an inside that needs all
        points at once; for a full disk.
    EngineError
        When the exact engine is not there.

    Warns
    -----
    InsideWarning
        When nothing lies inside, or only rooms smaller than asked do.
    """
    wanted = BlockOptions() if options is None else options
    if wanted.inside not in INSIDES:
        raise InputError(f"expected the inside {' or '.join(INSIDES)} for work in blocks, got {wanted.inside!r}.")
    InteriorOptions(method=wanted.inside, ratio=wanted.ratio, noise=wanted.noise)
    if points.ndim != 2 or points.shape[1] != 3:
        raise InputError(
            f"expected points in space for work in blocks, got shape {points.shape}; leave out the blocks."
        )
    ready_engine("exact", 3, part(tick, 0.0, 0.02))
    whole, furthest = WholeSkeleton(Shelf(folder)), [0.0]

    def work(comm: TurnCommunicator) -> None:
        def told(share: float) -> None:
            comm.check()
            furthest[0] = max(furthest[0], share)  # blocks that come later in a stage do not go back
            tick(0.02 + 0.98 * furthest[0])

        _block(comm, points, wanted, whole, told)

    run_in_turn(n_blocks, work, folder)
    for message in whole.messages:
        warnings.warn(message, InsideWarning, stacklevel=2)
    return whole


def _block(comm: TurnCommunicator, points: Array, wanted: BlockOptions, whole: WholeSkeleton, tick: Tick) -> None:
    """The work of one block, from its share of the input to its nodes of the skeleton."""
    mine = slice(*(len(points) * k // comm.size for k in (comm.rank, comm.rank + 1)))
    _expect_space(comm, points, points[mine])
    done = (0.6 * comm.rank / comm.size, 0.6 * (comm.rank + 1) / comm.size)
    mesh_part = _triangulated(comm, points[mine], mine.start, whole, part(tick, *done))
    if wanted.inside != "all":
        mesh_part = _inside(comm, mesh_part, wanted, whole, part(tick, 0.6, 0.7))
    tree = build_tree_part(comm, mesh_part)
    del mesh_part
    described = simplex_arrays_of_part(tree, part(tick, 0.8, 0.8))
    if wanted.inside != "all":
        described = {"Inside": np.ones(len(tree.cell), bool), **described}
    names = list(described)
    described = dict(zip(names, comm.keep(*described.values()), strict=True))
    positions = comm.keep(centres(tree.part.mesh, wanted.centre)[tree.cell])[0]
    flat = described["Quality"] < wanted.threshold
    n_cells, n_kept = tree.forest.n_nodes, comm.total(int((~flat).sum()))
    if n_cells and n_kept == 0:
        raise InputError(all_flat(n_cells, wanted.threshold))
    forest, rows = contract_part(comm, tree.forest, *comm.keep(flat))
    del flat, tree
    _count(comm, whole, forest, n_cells - forest.n_nodes)
    skeleton = skeleton_part(comm, forest, keep_leaves=wanted.keep_leaves)
    tick(0.9)
    _write_nodes(comm, whole, (forest, skeleton), rows[skeleton.node], {"": positions, **described})
    _write_lines(comm, whole, skeleton, forest.depth[skeleton.node])
    tick(1.0)


def _expect_space(comm: TurnCommunicator, points: Array, mine: Array) -> None:
    """Raise `InputError` for bad coordinates and for points that do not fill space."""
    own = finite_points(mine)
    if fills_space(comm, own, roundings_by_axis(own, mine.dtype)):
        return
    if len(points) <= FEW:
        full_dimensional(distinct_points(points))  # says more of few points, and of those on a line
    raise InputError(
        "expected points that fill space for work in blocks, got points of one plane; their triangles need the whole "
        "cloud, so leave out the blocks."
    )


def _triangulated(comm: TurnCommunicator, mine: Array, first: int, whole: WholeSkeleton, tick: Tick) -> MeshPart:
    """The simplices of the block, and what is to be said of the points."""
    found = triangulate_part(comm, mine, np.arange(first, first + len(mine)), tick)
    if comm.rank == 0:
        merged = found.n_input - found.n_distinct
        whole.facts.update(Engine="exact", InputPoints=found.n_input, DuplicatesMerged=merged, Noise=0.0)
        (whole.original_ids,) = whole.shelf.room(((found.n_distinct,), np.int64))
    comm.agree()
    whole.original_ids[found.part.point_ids[found.owned]] = found.origins[found.owned, 0]
    whole.shelf.leave()
    return found.part


def _inside(
    comm: TurnCommunicator, mesh_part: MeshPart, wanted: BlockOptions, whole: WholeSkeleton, tick: Tick
) -> MeshPart:
    """Those simplices of the block that lie inside, and what is to be said of them."""
    options = InteriorOptions(method=wanted.inside, ratio=wanted.ratio, noise=wanted.noise)
    found = interior_of_part(comm, mesh_part, options, tick=tick)
    inside, messages = found.inside, found.messages
    del found
    kept = submesh_of_part(comm, mesh_part, inside)
    if comm.rank == 0:
        whole.messages.extend(messages)
        whole.facts["InsideCells"] = kept.n_cells
    return kept


def _count(comm: TurnCommunicator, whole: WholeSkeleton, forest: ForestPart, removed: int) -> None:
    trees, leaves = (comm.total(int(kind.sum())) for kind in (forest.parent < 0, forest.son_count == 0))
    if comm.rank == 0:
        whole.facts.update(Traversal="breadth", Trees=trees, Leaves=leaves, FlatRemoved=removed)


def _write_nodes(
    comm: TurnCommunicator,
    whole: WholeSkeleton,
    parts: tuple[ForestPart, SkeletonPart],
    rows: Array,
    described: dict[str, Array],
) -> None:
    """Put the block's nodes where they belong in the whole skeleton; `rows` are theirs in `described`."""
    forest, skeleton = parts
    arrays = {name: values[skeleton.node] for name, values in forest_arrays(forest).items()}
    arrays |= {name: values[rows] for name, values in described.items()} | skeleton_arrays(skeleton)
    names, values = list(arrays), comm.keep(*arrays.values())
    del arrays
    n_nodes = comm.total(len(skeleton.node))
    if comm.rank == 0:
        kinds = [((n_nodes, *value.shape[1:]), value.dtype) for value in values]
        whole.nodes = dict(zip(names, whole.shelf.room(*kinds), strict=True))
        whole.points = whole.nodes.pop("")
    comm.agree()
    for name, value in zip(names, values, strict=True):
        (whole.nodes[name] if name else whole.points)[skeleton.index] = value
        whole.shelf.leave()


def _write_lines(comm: TurnCommunicator, whole: WholeSkeleton, skeleton: SkeletonPart, depth: Array) -> None:
    """Put the block's nodes where they belong on the branches; then the first block measures these.

    Strategy: a branch goes down one level with each node, so a node's place on it is its depth's.
    """
    shelf, n_branches = whole.shelf, skeleton.n_branches
    drawn = np.flatnonzero(skeleton.branch_id >= 0).astype(np.int32)
    drawn, branch, depth = comm.keep(drawn, skeleton.branch_id[drawn], depth[drawn])
    alone = np.concatenate(comm.allgather(skeleton.index[skeleton.degree == 0]))
    if comm.rank == 0:
        whole.alone = np.sort(alone).astype(np.int64)
        kinds = ((n_branches + 1,), np.int64), ((n_branches,), np.float64), ((n_branches,), np.int32)
        whole.offsets, whole.lengths, whole.first_depth = shelf.room(*kinds)
        whole.first_depth[:] = np.iinfo(np.int32).max
    comm.agree()
    np.add.at(whole.offsets, branch + 1, 1)
    np.minimum.at(whole.first_depth, branch, depth)
    shelf.leave()
    comm.agree()
    if comm.rank == 0:
        _add_up(whole.offsets)
        (whole.path,) = shelf.room(((int(whole.offsets[-1]),), np.int64))
    comm.agree()
    place = depth - whole.first_depth[branch]
    begins = np.flatnonzero(place == 0)
    whole.path[whole.offsets[branch] + 1 + place] = skeleton.index[drawn]
    whole.path[whole.offsets[branch[begins]]] = skeleton.parent[drawn[begins]]
    shelf.leave()
    comm.agree()
    if comm.rank == 0:
        _measure(whole)
    comm.agree()


def _add_up(offsets: Array) -> None:
    """From the number of nodes that each branch leads to, to where its path ends; the paths begin with one more."""
    total = 0
    for start in range(1, len(offsets), PIECE):
        ends = total + np.cumsum(offsets[start : start + PIECE] + 1)
        offsets[start : start + PIECE] = ends
        total = int(ends[-1])


def _measure(whole: WholeSkeleton) -> None:
    for start in range(0, len(whole.lengths), PIECE):
        offsets = whole.offsets[start : start + PIECE + 1]
        path = whole.path[offsets[0] : offsets[-1]]
        whole.lengths[start : start + PIECE] = lengths_along(whole.points[path], offsets - offsets[0])
        whole.shelf.leave()
