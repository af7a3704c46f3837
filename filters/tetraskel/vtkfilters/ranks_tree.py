"""Meshes and trees on several MPI ranks as VTK data, and back."""

from __future__ import annotations

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkDataSetAttributes

from tetraskel.distributed.communicator import Route
from tetraskel.distributed.copies import Copies, parents_elsewhere
from tetraskel.distributed.forests import ForestPart
from tetraskel.distributed.numbering import owners_of
from tetraskel.distributed.parts import MeshPart, part_of_mesh
from tetraskel.errors import InputError
from tetraskel.kernels.adjacency import triangulation_of
from tetraskel.kernels.node_arrays import forest_arrays
from tetraskel.vtkfilters import ranks
from tetraskel.vtkfilters.convert import (
    add_arrays,
    add_facts,
    array_of,
    copy_rows,
    points_of,
    simplices_of,
    to_cells,
    to_points,
)

NEEDED = ("NodeId", "ParentId", "Depth", "SonRank", "SonCount", "SubtreeSize", "TreeId")


def is_spread(comm, data, warn) -> bool:
    """Whether tetrahedra lie on more than one rank; triangles that do are gathered, which is said."""
    own = ranks.own_cells(data)
    has_cells = len(own) > 0
    flat = has_cells and simplices_of(data).shape[1] == 3
    n_ranks, n_flat = comm.total(int(has_cells)), comm.total(int(flat))
    if n_ranks > 1 and n_flat and comm.rank == 0:
        warn("the triangles of all ranks are gathered to the first one.")
    return n_ranks > 1 and not n_flat


def is_numbered_by_rank(comm, data) -> bool:
    """Whether tetrahedra lie on several ranks with global ids as DelaunayMesh gives them: cells rank after rank."""
    if not is_spread(comm, data, lambda message: None):
        return False
    own, ids = ranks.own_cells(data), ranks.global_ids(data.GetCellData())
    first = comm.before(len(own))
    in_order = len(own) == 0 or (ids is not None and np.array_equal(ids[own], np.arange(first, first + len(own))))
    named = data.GetNumberOfPoints() == 0 or ranks.global_ids(data.GetPointData()) is not None
    return comm.total(int(not (in_order and named))) == 0


def part_of_data(comm, data, *, all_points=False) -> tuple[MeshPart, np.ndarray]:
    """This rank's tetrahedra as a part of the mesh of all ranks; also the index of each among the cells of the data.

    Its points are those the tetrahedra use, or all that the data have.

    Raises
    ------
    InputError
        When the points have no global ids.
    """
    own = ranks.own_cells(data)
    simplices = simplices_of(data)[own] if len(own) else np.empty((0, 4), np.int64)
    used = np.arange(data.GetNumberOfPoints()) if all_points else np.unique(simplices)
    ids, cell_ids = ranks.global_ids(data.GetPointData()), ranks.global_ids(data.GetCellData())
    if len(used) and ids is None:
        raise InputError(
            "expected a mesh on several ranks with global point ids, got one without; apply Generate Global Ids first."
        )
    points = points_of(data)[used] if len(used) else np.empty((0, 3))
    mesh = triangulation_of(points, np.searchsorted(used, simplices))
    unnamed = comm.total(int(len(own) > 0 and cell_ids is None))
    named = None if unnamed else (cell_ids[own] if len(own) else np.empty(0, np.int64))
    return part_of_mesh(comm, mesh, ids[used] if len(used) else np.empty(0, np.int64), named), own


def fill_nodes(comm, output, forest: ForestPart, positions: np.ndarray) -> Copies:
    """Nodes, lines from parent to son, and the forest's arrays; parents on other ranks are copies at the end."""
    copies, above = parents_elsewhere(comm, forest.parent, forest.parent_rank, forest.parent_at)
    output.SetPoints(to_points(copies.with_theirs(comm, positions)))
    sons = np.flatnonzero(forest.parent_rank >= 0)
    output.SetLines(to_cells(np.stack([above[sons], sons], axis=1)))
    alone = np.flatnonzero((forest.parent_rank < 0) & (forest.son_count == 0))
    if len(alone):
        output.SetVerts(to_cells(alone[:, None]))
    whole = {name: copies.with_theirs(comm, values) for name, values in forest_arrays(forest).items()}
    add_arrays(output.GetPointData(), whole)
    output.GetPointData().SetActiveScalars("Depth")
    counts = [comm.total(int(of_kind.sum())) for of_kind in (forest.parent < 0, forest.son_count == 0)]
    add_facts(output, {"Traversal": "breadth", "Trees": counts[0], "Leaves": counts[1]})
    ranks.set_global_ids(output.GetPointData(), whole["NodeId"], ranks.POINT_IDS)
    is_copy = np.arange(len(forest) + len(copies)) >= len(forest)
    ranks.mark_copies(output.GetPointData(), is_copy, vtkDataSetAttributes.DUPLICATEPOINT)
    return copies


def add_node_arrays(comm, output, attributes, rows: np.ndarray, arrays: dict[str, np.ndarray], copies: Copies) -> None:
    """Add arrays of the nodes, made and carried; of the copies, at the end, they are their owners'.

    Arrays that are carried but that not all ranks have, or no numbers, are empty there.
    """
    theirs = ranks.fetched_arrays(comm, attributes, copies.owners, copies.rows, rows)
    arrays = {name: copies.with_theirs(comm, values) for name, values in arrays.items() if values is not None}
    own = output.GetPointData()
    skip = {own.GetArrayName(k) for k in range(own.GetNumberOfArrays())} | {ranks.GHOSTS, ranks.POINT_IDS, *arrays}
    carried = output.NewInstance()
    if len(rows):
        copy_rows(attributes, carried.GetPointData(), rows, (*skip, ranks.CELL_IDS))
    data = carried.GetPointData()
    found = {data.GetArrayName(k): array_of(data, data.GetArrayName(k)) for k in range(data.GetNumberOfArrays())}
    for name, values in found.items():
        if values is not None:
            none = np.zeros((len(copies), *values.shape[1:]), values.dtype)
            add_arrays(own, {name: np.concatenate([values, theirs.get(name, none)])})
    add_arrays(own, arrays)
    if not own.HasArray(ranks.GHOSTS):
        is_copy = np.arange(output.GetNumberOfPoints()) >= output.GetNumberOfPoints() - len(copies)
        ranks.mark_copies(own, is_copy, vtkDataSetAttributes.DUPLICATEPOINT)


def is_spread_tree(comm, data) -> bool:
    """Whether nodes of a tree lie on more than one rank."""
    return comm.total(int(data.GetNumberOfPoints() > 0)) > 1


def forest_part_of(comm, data) -> tuple[ForestPart, np.ndarray]:
    """This rank's part of a tree on several ranks, and the point of each of its nodes.

    Raises
    ------
    InputError
        When arrays are missing, or the nodes of all ranks are no tree's.
    """
    own = ranks.own_points(data)
    arrays = {name: array_of(data.GetPointData(), name) for name in NEEDED}
    missing = [name for name, values in arrays.items() if values is None]
    if (missing and len(own)) or data.GetPointData().HasArray("NodeType"):
        raise InputError(
            f"expected a tree with the point arrays {', '.join(NEEDED)}, got others; connect the output of TreeBuilder."
        )
    if missing:
        arrays = dict.fromkeys(NEEDED, np.empty(0, np.int64))
    number, parent = arrays["NodeId"][own].astype(np.int64), arrays["ParentId"][own].astype(np.int64)
    order = np.argsort(number, kind="stable")
    own, number, parent = own[order], number[order], parent[order]
    n_nodes = comm.total(len(own))
    _check_numbers(comm, number, parent, n_nodes)
    sons = np.flatnonzero(parent >= 0)
    parent_rank, parent_at = np.full(len(own), -1, np.int64), np.full(len(own), -1, np.int64)
    parent_rank[sons] = owners_of(comm, number, parent[sons], n_nodes)
    route = Route(comm, parent_rank[sons])
    parent_at[sons] = route.back(np.searchsorted(number, route.forward(parent[sons])))
    rest = (arrays[name][own].astype(np.int64) for name in NEEDED[2:])
    return ForestPart(number, parent, *rest, parent_rank, parent_at, n_nodes), own


def _check_numbers(comm, number, parent, n_nodes) -> None:
    """Raise `InputError` unless the nodes of all ranks are numbered from 0 and parents come before their sons."""
    twice = int((np.diff(number) == 0).sum())
    outside = int(((number < 0) | (number >= n_nodes)).sum())
    total = comm.total(int(number.sum()))
    if twice or outside or (parent >= number).any() or (parent < -1).any() or total != n_nodes * (n_nodes - 1) // 2:
        raise InputError("expected nodes numbered from 0, parents before sons, got others; build the tree again.")
