"""The filters one after another on many ranks (threads here), the tree of the inside among them: the serial result."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import pyvista
from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow
from vtkmodules.vtkCommonDataModel import vtkPolyData

from dealt import dealt, torus, uniform
from shapes import SOLIDS
from tetraskel.distributed.in_process import run_on_ranks
from tetraskel.errors import InputError, RankError
from tetraskel.kernels.compilation import numba_is_used
from tetraskel.vtkfilters import DelaunayMesh, FlatTetraRemoval, InteriorCells, SkeletonOutput, TreeBuilder, ranks

needs_numba = pytest.mark.skipif(not numba_is_used(), reason="numba is not installed (the extra fast)")
FACTS = ("InsideCells", "Trees", "Leaves", "FlatRemoved", "DuplicatesMerged")


def two_balls(rng, n):
    """Two objects, and so two trees."""
    return SOLIDS["two_balls"]().sample(n, rng)


def balls_beside_volume(rng, n):
    """Of two ranks one has nothing inside."""
    return np.concatenate([rng.random((n * 5 // 9, 3)), 10 + two_balls(rng, n * 4 // 9)])


CLOUDS = {
    torus: (700, {}),
    two_balls: (350, {"noise": 1.0}),
    uniform: (300, {}),
    balls_beside_volume: (900, {}),
}


def steps(options):
    """The chain of the tree of an inside."""
    mesh = DelaunayMesh(engine="exact", gather_below=0)
    inside = InteriorCells(**options, extract=True)
    return [mesh, inside, TreeBuilder(), FlatTetraRemoval(threshold=0.2), SkeletonOutput()]


def serial(points, options):
    """The skeleton of the filters in a pipeline."""
    chain = steps(options)
    chain[0].SetInputDataObject(0, pyvista.PolyData(points))
    for before, after in pairwise(chain):
        after.SetInputConnection(0, before.GetOutputPort())
    return pyvista.wrap(chain[-1].run())


def on_rank(comm, points, owner, options):
    """This rank's piece of the skeleton, and how many cells inside it has."""
    mine = np.flatnonzero(owner == comm.rank)
    data = pyvista.PolyData(points[mine])
    ranks.set_global_ids(data.GetPointData(), mine, ranks.POINT_IDS)
    cells = 0
    for step in steps(options):
        outputs = [step.GetOutputDataObject(port).NewInstance() for port in range(step.n_outputs)]
        outputs = [vtkPolyData()] if isinstance(step, FlatTetraRemoval) else outputs
        step.execute_on_ranks(comm, [data, None], outputs)
        data = outputs[0]
        cells = data.GetNumberOfCells() if isinstance(step, InteriorCells) else cells
    return pyvista.wrap(data), cells


def edges_of(data, names):
    """From and to, by NodeId, and the branch of each edge; sorted."""
    at, found = 0, []
    for branch in data.cell_data["BranchId"][data.n_verts :]:
        line = names[data.lines[at + 1 : at + 1 + data.lines[at]]].tolist()
        found += [(*ends, int(branch)) for ends in pairwise(line)]
        at += 1 + data.lines[at]
    return sorted(found)


@pytest.fixture
def window():
    """What VTK would print."""
    before, caught = vtkOutputWindow.GetInstance(), vtkStringOutputWindow()
    vtkOutputWindow.SetInstance(caught)
    yield caught
    vtkOutputWindow.SetInstance(before)


@needs_numba
@pytest.mark.parametrize("size", [2, 3, 5])
@pytest.mark.parametrize("cloud", CLOUDS, ids=lambda cloud: cloud.__name__)
def test_the_tree_of_the_inside_on_ranks_is_the_serial_one(cloud, size, window):
    rng = np.random.default_rng(size)
    n, options = CLOUDS[cloud]
    points = cloud(rng, n)
    points = np.concatenate([points, points[:10]])
    expected, said = serial(points, options), window.GetOutput()
    assert (expected.n_points > 20) == (cloud is not uniform)
    owner = dealt(points, size, "random" if size % 2 else "space", rng)
    found, cells = zip(*run_on_ranks(size, lambda comm: on_rank(comm, points, owner, options)), strict=True)
    assert window.GetOutput().removeprefix(said) == said
    alone = {uniform: 0, balls_beside_volume: 1}
    n_with_cells = sum(count > 0 for count in cells)
    assert n_with_cells == alone[cloud] if cloud in alone and size == 2 else n_with_cells != 1
    assert_serial(found, expected)


def assert_serial(found, expected):
    own = [ranks.own_points(piece) if piece.n_points else np.empty(0, int) for piece in found]
    filled = [(piece, rows) for piece, rows in zip(found, own, strict=True) if len(rows)]
    for name, values in expected.point_data.items():
        if not filled:
            assert len(values) == 0
            continue
        together = np.concatenate([piece.point_data[name][rows] for piece, rows in filled])
        order = np.argsort(np.concatenate([piece.point_data["NodeId"][rows] for piece, rows in filled]))
        serial_order = np.argsort(expected.point_data["NodeId"])
        assert np.array_equal(together[order], values[serial_order]), name
        assert together.dtype == values.dtype, name
        for piece, _ in filled:  # copies say what their owners do
            ids = ranks.global_ids(piece.GetPointData())
            assert ids is None or np.array_equal(piece.point_data[name], values[ids])
    names = expected.point_data["NodeId"]
    ids = [ranks.global_ids(piece.GetPointData()) for piece, _ in filled]
    ids = [np.arange(len(names)) if own is None else own for own in ids]  # of a rank that has all
    pieces = [edges_of(piece, names[own]) for (piece, _), own in zip(filled, ids, strict=True)]
    assert sorted(edge for edges in pieces for edge in edges) == edges_of(expected, names)
    told = [piece for piece in found if piece.field_data]
    for name in FACTS:
        assert {int(piece.field_data[name][0]) for piece in told} == {int(expected.field_data[name][0])}, name


@needs_numba
def test_arrays_of_every_kind_keep_their_names_and_types():
    rng = np.random.default_rng(0)
    points = torus(rng, 400)
    kinds = {
        "byte": rng.integers(0, 200, 400).astype(np.uint8),
        "single": rng.random(400).astype(np.float32),
        "way": rng.random((400, 3)),
        "whole|number": np.arange(400),
    }

    def work(comm):
        mine = np.arange(400)[comm.rank :: 3]
        data = pyvista.PolyData(points[mine])
        for name, values in kinds.items():
            data[name] = values[mine]
        ranks.set_global_ids(data.GetPointData(), mine, ranks.POINT_IDS)
        step = DelaunayMesh(engine="exact", gather_below=0)
        outputs = [step.GetOutputDataObject(0).NewInstance()]
        step.execute_on_ranks(comm, [data], outputs)
        return pyvista.wrap(outputs[0])

    for piece in run_on_ranks(3, work):
        for name, values in kinds.items():
            assert np.array_equal(piece.point_data[name], values[piece.point_data["OriginalPointIds"]]), name
            assert piece.point_data[name].dtype == values.dtype, name


@needs_numba
def test_a_tree_of_flat_cells_alone_is_told_on_every_rank():
    points = uniform(np.random.default_rng(0), 200)

    def work(comm):
        mine = np.arange(200)[comm.rank :: 2]
        data = pyvista.PolyData(points[mine])
        ranks.set_global_ids(data.GetPointData(), mine, ranks.POINT_IDS)
        for step in (DelaunayMesh(engine="exact", gather_below=0), TreeBuilder(), FlatTetraRemoval(threshold=1.0)):
            outputs = [
                vtkPolyData() if isinstance(step, FlatTetraRemoval) else step.GetOutputDataObject(0).NewInstance()
            ]
            step.execute_on_ranks(comm, [data], outputs)
            data = outputs[0]

    with pytest.raises((InputError, RankError), match="expected simplices of quality 1 or better, got none among 1134"):
        run_on_ranks(2, work)
