"""The four filters in a VTK pipeline give what the kernels give, and say what went wrong."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkBitArray, vtkStringArray
from vtkmodules.vtkCommonDataModel import (
    VTK_HEXAHEDRON,
    VTK_TETRA,
    vtkImageData,
    vtkMultiBlockDataSet,
    vtkPolyData,
    vtkStructuredGrid,
    vtkUnstructuredGrid,
)
from vtkmodules.vtkFiltersCore import vtkDelaunay3D
from vtkmodules.vtkFiltersVerdict import vtkMeshQuality

from tetraskel import (
    Aborted,
    EngineError,
    InputError,
    MeshError,
    assemble_skeleton,
    build_tree,
    remove_flat,
    triangulate,
)
from tetraskel.kernels.centres import centres, circumballs
from tetraskel.kernels.decode import decode_simplices, encode_tree
from tetraskel.kernels.quality import qualities
from tetraskel.kernels.triangulate import available_engine
from tetraskel.vtkfilters import DelaunayMesh, FlatTetraRemoval, SkeletonOutput, TreeBuilder
from tetraskel.vtkfilters.convert import add_arrays, array_of, points_of, simplices_of, to_cells, to_points

CLOUDS = {
    "3D": np.random.default_rng(0).random((300, 3)),
    "plane": np.random.default_rng(1).random((200, 2)),
    "lattice": np.stack(np.meshgrid(*[np.arange(4.0)] * 3), -1).reshape(-1, 3),
}


def polydata(points, **arrays):
    data = vtkPolyData()
    data.SetPoints(to_points(np.asarray(points, float)))
    add_arrays(data.GetPointData(), arrays)
    return data


def grid(points, cells, kind):
    data = vtkUnstructuredGrid()
    data.SetPoints(to_points(np.asarray(points, float)))
    data.SetCells(kind, to_cells(np.asarray(cells)))
    return data


def chain(source, *filters):
    filters[0].SetInputDataObject(0, source)
    for before, after in itertools.pairwise(filters):
        after.SetInputConnection(0, before.GetOutputPort())
    return filters[-1].run()


def names(attributes):
    return [attributes.GetArrayName(k) for k in range(attributes.GetNumberOfArrays())]


def point_array(data, name):
    return array_of(data.GetPointData(), name)


@pytest.mark.parametrize("name", CLOUDS)
def test_delaunay_mesh_is_triangulate(name):
    mesh = triangulate(CLOUDS[name])
    data = chain(polydata(CLOUDS[name]), DelaunayMesh())
    assert np.array_equal(simplices_of(data), mesh.simplices)
    assert np.array_equal(points_of(data)[:, : mesh.points.shape[1]], mesh.points)
    assert data.GetFieldData().GetAbstractArray("Engine").GetValue(0) == mesh.engine == available_engine("auto")


@pytest.mark.parametrize("traversal", ["breadth", "depth"])
@pytest.mark.parametrize("centre", ["barycentre", "incentre", "circumcentre"])
@pytest.mark.parametrize("name", CLOUDS)
def test_tree_builder_is_build_tree(name, traversal, centre):
    tree = build_tree(triangulate(CLOUDS[name]), traversal=traversal)
    data = chain(polydata(CLOUDS[name]), DelaunayMesh(), TreeBuilder(traversal=traversal, centre=centre))
    radius, contains = circumballs(tree.mesh)
    expected = {
        "NodeId": np.arange(len(tree)),
        "ParentId": tree.parent,
        "Depth": tree.depth,
        "SonRank": tree.son_rank,
        "SonCount": tree.son_count,
        "SubtreeSize": tree.subtree_size,
        "TreeId": tree.tree_id,
        "IsLeaf": tree.is_leaf,
        "CellId": tree.cell,
        "ApexId": tree.apex,
        "EntryFacet": tree.entry_facet,
        "Quality": qualities(tree.mesh)[tree.cell],
        "Radius": radius[tree.cell],
        "ContainsCircumcentre": contains[tree.cell],
    }
    for array, values in expected.items():
        assert np.array_equal(point_array(data, array), values), array
    assert np.array_equal(points_of(data)[:, : tree.mesh.points.shape[1]], centres(tree.mesh, centre)[tree.cell])
    lines = vtk_to_numpy(data.GetLines().GetConnectivityArray()).reshape(-1, 2)
    sons = np.flatnonzero(tree.parent >= 0)
    assert np.array_equal(lines, np.stack([tree.parent[sons], sons], axis=1))


@pytest.mark.parametrize("name", CLOUDS)
def test_tree_arrays_alone_decode_to_the_mesh(name):
    data = chain(polydata(CLOUDS[name]), DelaunayMesh(), TreeBuilder())
    code = encode_tree(*(point_array(data, array) for array in ("ParentId", "EntryFacet", "ApexId")))
    decoded = decode_simplices(code, point_array(data, "Depth"))
    expected = triangulate(CLOUDS[name]).simplices[point_array(data, "CellId")]
    assert np.array_equal(np.sort(decoded), np.sort(expected))


@pytest.mark.parametrize("traversal", ["breadth", "depth"])
@pytest.mark.parametrize("name", CLOUDS)
def test_flat_removal_and_skeleton_are_the_kernels(name, traversal):
    kept = remove_flat(build_tree(triangulate(CLOUDS[name]), traversal=traversal), threshold=0.2)
    flat = FlatTetraRemoval(threshold=0.2)
    drawn = SkeletonOutput()
    data = chain(polydata(CLOUDS[name]), DelaunayMesh(), TreeBuilder(traversal=traversal), flat, drawn)
    tree = flat.GetOutputDataObject(0)
    assert np.array_equal(point_array(tree, "CellId"), kept.cell)
    assert np.array_equal(point_array(tree, "ParentId"), kept.parent)
    assert np.array_equal(point_array(tree, "Depth"), kept.depth)
    assert np.array_equal(point_array(tree, "SubtreeSize"), kept.subtree_size)
    assert (point_array(tree, "Quality") >= 0.2).all()
    skeleton = assemble_skeleton(kept)
    assert np.array_equal(points_of(data)[:, : skeleton.points.shape[1]], skeleton.points)
    assert np.array_equal(vtk_to_numpy(data.GetLines().GetConnectivityArray()), skeleton.branch_nodes)
    assert np.array_equal(vtk_to_numpy(data.GetLines().GetOffsetsArray()), skeleton.branch_offsets)
    assert np.array_equal(point_array(data, "BranchId"), skeleton.branch_id)
    assert np.array_equal(point_array(data, "NodeType"), skeleton.node_type)
    lengths = array_of(data.GetCellData(), "Length")
    assert lengths[data.GetNumberOfVerts() :] == pytest.approx(skeleton.branch_lengths)


def test_flat_cells_leave_a_mesh_and_arrays_follow():
    source = chain(polydata(CLOUDS["3D"]), DelaunayMesh())
    quality = qualities(triangulate(CLOUDS["3D"]))
    add_arrays(source.GetCellData(), {"number": np.arange(len(quality))})
    rest = chain(source, FlatTetraRemoval(threshold=0.3))
    assert rest.IsA("vtkUnstructuredGrid")
    assert np.array_equal(array_of(rest.GetCellData(), "number"), np.flatnonzero(quality >= 0.3))
    assert array_of(rest.GetFieldData(), "FlatRemoved")[0] == (quality < 0.3).sum()


def test_triangles_of_polygonal_data_are_a_mesh_too():
    flat = triangulate(CLOUDS["plane"])
    data = polydata(flat.points)
    data.SetPolys(to_cells(flat.simplices))
    assert np.array_equal(point_array(chain(data, TreeBuilder()), "CellId"), build_tree(flat).cell)
    assert chain(data, FlatTetraRemoval(threshold=0.3)).IsA("vtkPolyData")


def test_arrays_are_carried_from_points_and_cells():
    points = np.concatenate([CLOUDS["3D"], CLOUDS["3D"][:7]])
    source = polydata(points, temperature=np.arange(len(points), dtype=np.float32), id=np.arange(len(points)))
    words = vtkStringArray()
    words.SetName("label")
    for k in range(len(points)):
        words.InsertNextValue(f"p{k}")
    source.GetPointData().AddArray(words)
    source.GetPointData().SetActiveScalars("temperature")
    mesh = chain(source, DelaunayMesh())
    original = point_array(mesh, "OriginalPointIds")
    assert np.array_equal(point_array(mesh, "temperature"), original)
    assert mesh.GetPointData().GetScalars().GetName() == "temperature"
    assert mesh.GetPointData().GetAbstractArray("label").GetValue(5) == f"p{original[5]}"
    assert array_of(mesh.GetFieldData(), "DuplicatesMerged")[0] == 7
    add_arrays(mesh.GetCellData(), {"density": np.arange(mesh.GetNumberOfCells()) * 2.0})
    tree = chain(mesh, TreeBuilder())
    assert np.array_equal(point_array(tree, "density"), point_array(tree, "CellId") * 2.0)


def test_meshes_made_by_vtk_are_walked():
    delaunay = vtkDelaunay3D()
    delaunay.SetInputData(polydata(CLOUDS["3D"]))
    delaunay.SetTolerance(1e-9)
    delaunay.Update()
    data = chain(delaunay.GetOutput(), TreeBuilder())
    assert data.GetNumberOfPoints() == delaunay.GetOutput().GetNumberOfCells()


def test_other_kinds_of_meshes_are_refused():
    with pytest.raises(MeshError, match="got 8 of type hexahedron"):
        chain(structured_grid(), TreeBuilder())


def structured_grid():
    data = vtkStructuredGrid()
    data.SetDimensions(3, 3, 3)
    data.SetPoints(to_points(np.stack(np.meshgrid(*[np.arange(3.0)] * 3), -1).reshape(-1, 3)))
    return data


def test_bit_arrays_are_carried():
    source = polydata(CLOUDS["3D"])
    bits = vtkBitArray()
    bits.SetName("bits")
    for k in range(source.GetNumberOfPoints()):
        bits.InsertNextValue(k % 3 == 0)
    source.GetPointData().AddArray(bits)
    mesh = chain(source, DelaunayMesh())
    carried = mesh.GetPointData().GetAbstractArray("bits")
    assert [carried.GetValue(k) for k in range(9)] == [1, 0, 0] * 3


def test_ids_of_a_tree_lead_back_to_the_input():
    points = np.concatenate([CLOUDS["3D"][:5], CLOUDS["3D"]])
    data = chain(polydata(points), DelaunayMesh(), TreeBuilder(), FlatTetraRemoval(), SkeletonOutput())
    original = array_of(data.GetFieldData(), "OriginalPointIds")
    mesh = triangulate(points)
    assert np.array_equal(points[original], mesh.points)
    assert set(point_array(data, "ApexId")) <= set(range(len(original)))


def test_many_sons_of_one_node():
    """A contracted node can have more sons than a byte counts."""
    fan = polydata(np.random.default_rng(0).random((302, 3)))
    parents = np.array([-1, 0, *[1] * 300])
    arrays = {
        "NodeId": np.arange(302),
        "ParentId": parents,
        "Depth": np.array([0, 1, *[2] * 300], np.int32),
        "TreeId": np.zeros(302, np.int32),
        "Quality": np.where(np.arange(302) == 1, 0.0, 1.0),
    }
    add_arrays(fan.GetPointData(), arrays)
    kept = chain(fan, FlatTetraRemoval())
    assert point_array(kept, "SonCount")[0] == 300
    assert point_array(kept, "SonRank").max() == 299
    assert chain(fan, FlatTetraRemoval(), SkeletonOutput(keep_leaves=True)).GetNumberOfLines() == 300


def test_pieces_make_a_forest_and_single_cells_can_be_seen():
    apart = grid(
        np.concatenate([CLOUDS["lattice"][:0], np.eye(4, 3), np.eye(4, 3) + 5]), [[0, 1, 2, 3], [4, 5, 6, 7]], VTK_TETRA
    )
    data = chain(apart, TreeBuilder())
    assert point_array(data, "TreeId").tolist() == [0, 1]
    assert data.GetNumberOfVerts() == 2
    assert chain(apart, TreeBuilder(), SkeletonOutput()).GetNumberOfVerts() == 2


def test_blocks_get_a_tree_each():
    blocks = vtkMultiBlockDataSet()
    blocks.SetBlock(0, polydata(CLOUDS["3D"]))
    blocks.SetBlock(1, polydata(CLOUDS["lattice"]))
    result = chain(blocks, DelaunayMesh(), TreeBuilder())
    assert result.GetBlock(0).GetNumberOfPoints() == len(triangulate(CLOUDS["3D"]))
    assert result.GetBlock(1).GetNumberOfPoints() == len(triangulate(CLOUDS["lattice"]))


def test_vtk_engine_is_labelled_and_covers_the_cloud():
    for points in (CLOUDS["3D"], CLOUDS["plane"]):
        mesh = triangulate(points, engine="vtk")
        assert mesh.engine == "vtk"
        assert set(mesh.simplices.ravel()) == set(range(len(points)))
    data = chain(polydata(CLOUDS["3D"]), DelaunayMesh(engine="vtk"))
    assert data.GetFieldData().GetAbstractArray("Engine").GetValue(0) == "vtk"
    assert np.array_equal(simplices_of(data), triangulate(CLOUDS["3D"], engine="vtk").simplices)


def test_empty_input_gives_empty_output_with_all_arrays(messages):
    full = chain(polydata(CLOUDS["3D"]), DelaunayMesh(), TreeBuilder(), FlatTetraRemoval(), SkeletonOutput())
    empty = chain(vtkPolyData(), DelaunayMesh(), TreeBuilder(), FlatTetraRemoval(), SkeletonOutput())
    assert empty.GetNumberOfPoints() == 0
    assert names(empty.GetPointData()) == names(full.GetPointData())
    assert names(empty.GetCellData()) == names(full.GetCellData())
    assert messages.GetOutput() == ""


HEXAHEDRON = [[x, y, z] for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)) for z in (0, 1)]
BAD = [
    (polydata([[0, 0, 0], [np.nan, 0, 0]]), DelaunayMesh, InputError, "got 1 of 2 points with NaN"),
    (polydata([[0, 0, 0], [1, 0, 0]]), DelaunayMesh, InputError, "got 2; a triangulation needs more"),
    (polydata([[k, k, k] for k in range(5)]), DelaunayMesh, InputError, "5 points on one line"),
    (
        grid(HEXAHEDRON, [range(8)], VTK_HEXAHEDRON),
        TreeBuilder,
        MeshError,
        "got 1 of type hexahedron; convert it first",
    ),
    (polydata([[0, 0, 0]]), SkeletonOutput, InputError, "data without NodeId, ParentId, Depth, TreeId"),
    (
        polydata([[0, 0, 0]], ParentId=np.array([-1])),
        FlatTetraRemoval,
        InputError,
        "data without NodeId, Depth, TreeId",
    ),
]


@pytest.mark.parametrize(("source", "kind", "error", "message"), BAD)
def test_errors_are_raised_each_time_printed_in_one_line_and_cleared(messages, source, kind, error, message):
    step = kind()
    for _ in range(2):
        with pytest.raises(error, match=message):
            chain(source, step)
        assert step.GetOutputDataObject(0).GetNumberOfPoints() == 0
    lines = messages.GetOutput().split("\n\n")[:-1]
    assert len(lines) == 2
    assert all(line.startswith(f"{kind.__name__}: ") for line in lines)


def test_a_mended_input_clears_the_error():
    step = DelaunayMesh()
    with pytest.raises(InputError):
        chain(BAD[0][0], step)
    assert chain(polydata(CLOUDS["3D"]), step).GetNumberOfCells() > 0
    assert step.last_error is None


def test_errors_upstream_are_raised_at_the_end_of_the_chain():
    with pytest.raises(InputError, match="NaN"):
        chain(BAD[0][0], DelaunayMesh(), TreeBuilder(), SkeletonOutput())


def test_options_are_properties_setters_and_keywords():
    step = DelaunayMesh(joggle=1e-6)
    assert step.GetJoggle() == step.joggle == 1e-6
    step.SetJoggle(1e-5)
    assert step.joggle == 1e-5
    step.SetEngine(1)  # ParaView sends the number of a word
    assert step.engine == "qhull"
    before = step.GetMTime()
    step.joggle = 1e-5
    assert step.GetMTime() == before
    with pytest.raises(InputError, match="joggle must lie between"):
        step.joggle = 7
    with pytest.raises(InputError, match="joggle must be a finite number; got 'much'"):
        step.joggle = "much"
    assert step.joggle == 1e-5
    with pytest.raises(InputError, match="keep_leaves must be True or False; got 'no'"):
        SkeletonOutput(keep_leaves="no")
    assert DelaunayMesh(joggle=np.float32(0.0)).joggle == 0


def test_setters_leave_a_bad_value_to_the_execution(messages):
    step = DelaunayMesh()
    step.SetJoggle(7)
    with pytest.raises(InputError, match="joggle must lie between"):
        chain(polydata(CLOUDS["3D"]), step)
    assert messages.GetOutput().count("DelaunayMesh: joggle must lie between") == 1


def test_inputs_of_the_wrong_type_are_errors(messages):
    mesh = chain(polydata(CLOUDS["3D"]), DelaunayMesh())
    with pytest.raises(InputError, match="expected an input of type vtkPolyData, got another type or none"):
        chain(mesh, SkeletonOutput())
    with pytest.raises(InputError, match="expected an input of type vtkPointSet"):
        chain(vtkImageData(), DelaunayMesh())
    with pytest.raises(InputError, match="expected an input of type vtkPointSet"):
        TreeBuilder().run()
    assert len(messages.GetOutput().split("\n\n")[:-1]) == 3


def damaged(name, change):
    tree = chain(polydata(CLOUDS["3D"]), DelaunayMesh(), TreeBuilder())
    values = change(point_array(tree, name).copy())
    tree.GetPointData().RemoveArray(name)
    add_arrays(tree.GetPointData(), {name: values})
    return tree


@pytest.mark.parametrize("kind", [FlatTetraRemoval, SkeletonOutput])
@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("ParentId", lambda parent: parent[::-1]),
        ("ParentId", lambda parent: parent + 0.5),
        ("ParentId", lambda parent: np.stack([parent] * 3, axis=1)),
        ("ParentId", lambda parent: np.full_like(parent, -1)),
        ("Depth", lambda depth: depth * 0 + 3),
        ("TreeId", lambda tree: np.arange(len(tree), dtype=np.int32)),
        ("NodeId", lambda node: node + 1),
    ],
)
def test_damaged_trees_are_refused(name, change, kind):
    with pytest.raises(InputError, match="build the tree again"):
        chain(damaged(name, change), kind())


def test_a_skeleton_is_no_tree():
    skeleton = chain(polydata(CLOUDS["3D"]), DelaunayMesh(), TreeBuilder(), SkeletonOutput())
    with pytest.raises(InputError, match="got a skeleton made of one"):
        chain(skeleton, SkeletonOutput())


def test_quality_that_is_no_number_is_refused():
    with pytest.raises(InputError, match="point array Quality, got none or NaN"):
        chain(damaged("Quality", lambda quality: quality * np.nan), FlatTetraRemoval())


def test_misspelt_options_are_refused():
    with pytest.raises(AttributeError, match="has no option 'treshold'; it has: threshold"):
        FlatTetraRemoval(treshold=0.1)
    with pytest.raises(AttributeError, match="no option 'treshold'"):
        FlatTetraRemoval().treshold = 0.1


def test_progress_is_told_and_abort_is_honoured():
    step, heard = DelaunayMesh(), []
    cloud = polydata(np.random.default_rng(2).random((30000, 3)))
    step.AddObserver("ProgressEvent", lambda *_: heard.append(step.GetProgressText()))
    chain(cloud, step)
    assert "Triangulating" in heard
    for engine in ("qhull", "vtk"):
        stopped = DelaunayMesh(engine=engine)
        stopped.AddObserver("ProgressEvent", lambda *_, step=stopped: step.SetAbortExecute(1))
        with pytest.raises(Aborted):
            chain(cloud, stopped)
        assert stopped.GetOutputDataObject(0).GetNumberOfCells() == 0


def test_a_missing_engine_reaches_the_caller(monkeypatch):
    from tetraskel.kernels import triangulate as module

    monkeypatch.setitem(module.ENGINE_MODULES, "qhull", ("tetraskel.kernels.qhull", "no_such_package"))
    with pytest.raises(EngineError, match="needs the package no_such_package"):
        chain(polydata(CLOUDS["3D"]), DelaunayMesh(engine="qhull"))


def test_quality_is_the_reciprocal_of_vtks_measures():
    """Of Aspect Gamma in 3D and of Aspect Frobenius in 2D."""
    for name, measure in (
        ("3D", "SetTetQualityMeasureToAspectGamma"),
        ("plane", "SetTriangleQualityMeasureToAspectFrobenius"),
    ):
        judge = vtkMeshQuality()
        getattr(judge, measure)()
        judge.SetInputData(chain(polydata(CLOUDS[name]), DelaunayMesh()))
        judge.Update()
        theirs = array_of(judge.GetOutput().GetCellData(), "Quality")
        assert 1 / qualities(triangulate(CLOUDS[name])) == pytest.approx(theirs, rel=1e-6)


@pytest.mark.parametrize("name", CLOUDS)
def test_pyvista_s_data_sets_are_inputs_like_any(name):
    pyvista = pytest.importorskip("pyvista")  # ParaView has none
    cloud = pyvista.PolyData(points_of(polydata(CLOUDS[name])).copy())
    ours, theirs = (chain(data, DelaunayMesh(), TreeBuilder()) for data in (polydata(CLOUDS[name]), cloud))
    assert np.array_equal(points_of(theirs), points_of(ours))
    for array in names(ours.GetPointData()):
        assert np.array_equal(point_array(theirs, array), point_array(ours, array)), array
    assert np.array_equal(pyvista.wrap(theirs)["Depth"], build_tree(triangulate(CLOUDS[name])).depth)


def test_a_structured_grid_without_cells_is_thinned_to_nothing():
    removal = FlatTetraRemoval()
    removal.SetInputDataObject(0, vtkStructuredGrid())
    result = removal.run()
    assert result.IsA("vtkUnstructuredGrid")
    assert result.GetNumberOfCells() == 0


def test_a_tree_of_which_nothing_is_left_is_told():
    mesh, tree, removal = DelaunayMesh(), TreeBuilder(), FlatTetraRemoval(threshold=1.0)
    mesh.SetInputDataObject(0, polydata(CLOUDS["3D"]))
    tree.SetInputConnection(0, mesh.GetOutputPort())
    removal.SetInputConnection(0, tree.GetOutputPort())
    with pytest.raises(InputError, match="lower the threshold"):
        removal.run()


def test_a_filter_that_is_not_used_any_more_is_gone():
    gone = []
    for source in (polydata(CLOUDS["3D"]), vtkImageData()):  # one that runs, one that VTK refuses
        made = DelaunayMesh()
        made.AddObserver("DeleteEvent", lambda *_: gone.append(1))
        made.SetInputDataObject(0, source)
        made.Update()
        del made
    assert len(gone) == 2
