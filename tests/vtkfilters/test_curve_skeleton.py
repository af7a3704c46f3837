"""CurveSkeleton in a VTK pipeline gives what `curve_skeleton` gives."""

from __future__ import annotations

import time

import numpy as np
import pytest
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkFiltersSources import vtkSphereSource

from tetraskel import Aborted, InputError, curve_model, curve_skeleton, measure, medial_mesh, triangulate
from tetraskel.kernels import curve
from tetraskel.kernels.curve_stages import ENDS
from tetraskel.kernels.triangulate import available_engine
from tetraskel.vtkfilters import CurveSkeleton, DelaunayMesh, InteriorCells, base
from tetraskel.vtkfilters.convert import add_arrays, array_of, points_of, simplices_of, to_points
from tetraskel.vtkfilters.curve_skeleton import skeleton_from


def tube(n=4000):
    """Random points of a torus of radii 1 and 0.3."""
    u, v = np.random.default_rng(0).random((2, n)) * 2 * np.pi
    return np.stack([(1 + 0.3 * np.cos(v)) * np.cos(u), (1 + 0.3 * np.cos(v)) * np.sin(u), 0.3 * np.sin(v)], axis=1)


def polydata(points, **arrays):
    data = vtkPolyData()
    data.SetPoints(to_points(np.asarray(points, float)))
    add_arrays(data.GetPointData(), arrays)
    return data


def skeleton_step(data, **options):
    step = CurveSkeleton(**options)
    step.SetInputDataObject(0, data)
    return step


def assert_is(data, expected):
    points = data.GetPointData()
    assert np.array_equal(points_of(data)[:, : expected.points.shape[1]], expected.points)
    assert np.array_equal(vtk_to_numpy(data.GetLines().GetConnectivityArray()), expected.connectivity)
    assert np.array_equal(array_of(points, "MaximumInscribedSphereRadius"), expected.radius)
    for name, values in {
        "ParentId": expected.parent,
        "Depth": expected.depth,
        "BranchId": expected.branch_id,
        "NodeType": expected.node_type,
        "NodeDegree": expected.node_degree,
        "StrahlerOrder": expected.strahler_order,
        "Abscissas": expected.abscissa,
        "Blanking": expected.blanking,
    }.items():
        assert np.array_equal(array_of(points, name), values), name
    for name, values in {
        "Length": expected.branch_length,
        "Tortuosity": expected.branch_tortuosity,
        "MeanRadius": expected.branch_radius,
        "GroupIds": expected.branch_group,
        "Blanking": expected.branch_blanking,
    }.items():
        assert np.array_equal(array_of(data.GetCellData(), name), values), name
    for name, value in {
        "Components": expected.components,
        "Loops": expected.loops,
        "LoopsRefused": expected.loops_refused,
    }.items():
        assert array_of(data.GetFieldData(), name)[0] == value


@pytest.mark.slow
def test_points_are_enough():
    points = tube()
    expected = curve_skeleton(points)
    step = skeleton_step(polydata(points, number=np.arange(len(points))))
    assert_is(step.run(), expected)
    assert (expected.components, expected.loops) == (1, 1)
    second = step.GetOutputDataObject(1)
    assert np.array_equal(points_of(second), points)
    assert np.array_equal(array_of(second.GetPointData(), "SkeletonNodeId"), expected.point_nodes)
    assert np.array_equal(array_of(second.GetPointData(), "BranchId"), expected.point_branches)
    assert np.array_equal(array_of(second.GetPointData(), "number"), np.arange(len(points)))


@pytest.mark.slow
@pytest.mark.parametrize("options", [{"root": "widest"}, {"root": "point", "root_point": (0, -1, 0)}, {"detail": 1.0}])
def test_options_are_passed_on(options):
    expected = {"detail": options.get("detail", 0.5)}
    if "root" in options:
        expected["root"] = options.get("root_point", options["root"])
    assert_is(skeleton_step(polydata(tube()), **options).run(), curve_skeleton(tube(), **expected))


@pytest.mark.slow
def test_a_mesh_is_found_inside_or_taken_as_labelled():
    points = tube()
    mesh = DelaunayMesh()
    mesh.SetInputDataObject(0, polydata(points))
    grid = mesh.run()
    assert_is(skeleton_step(grid).run(), curve_skeleton(triangulate(points)))
    inside = InteriorCells()
    inside.SetInputDataObject(0, grid)
    assert_is(skeleton_step(inside.run()).run(), curve_skeleton(points))
    everything = InteriorCells(method="all")
    everything.SetInputDataObject(0, grid)
    data = skeleton_step(everything.run()).run()
    assert array_of(data.GetFieldData(), "Loops")[0] == 0  # the hull of a torus has no hole


@pytest.mark.slow
def test_what_was_merged_is_told_whoever_triangulated():
    doubled = np.concatenate([tube(), tube()[:25]])
    mesh = DelaunayMesh()
    mesh.SetInputDataObject(0, polydata(doubled))
    for source in (polydata(doubled), mesh.run()):
        facts = skeleton_step(source).run().GetFieldData()
        assert array_of(facts, "DuplicatesMerged")[0] == 25
        assert facts.GetAbstractArray("Engine").GetValue(0) == available_engine("auto")


@pytest.mark.slow
def test_another_detail_is_drawn_from_the_same_model(monkeypatch):
    from tetraskel.vtkfilters import curve_skeleton as module

    made = []

    def counted(*arguments, **options):
        made.append(1)
        return curve.curve_model(*arguments, **options)

    monkeypatch.setattr(module, "curve_model", counted)
    data = polydata(tube())
    step = skeleton_step(data)
    step.run()
    for detail in (0.1, 0.9):
        step.detail = detail
        assert_is(step.run(), curve_skeleton(tube(), detail=detail))
    assert len(made) == 1
    data.Modified()
    step.loop_spacings = 3
    step.run()
    assert len(made) == 2


def slab(n=2500):
    """Random points of a box 2 x 2 x 0.6."""
    rng = np.random.default_rng(0)
    sides = np.array([2, 2, 0.6])
    points, axis = rng.random((n, 3)) * sides, rng.choice(3, n, p=[0.15, 0.15, 0.7])
    points[np.arange(n), axis] = rng.integers(0, 2, n) * sides[axis]
    return points + rng.normal(0, 1e-4, (n, 3))


def test_sheets_are_the_third_output_where_asked_for(monkeypatch):
    from tetraskel.vtkfilters import curve_skeleton as module

    points = slab()
    step = skeleton_step(polydata(points))
    step.run()
    assert step.GetOutputDataObject(2).GetNumberOfPoints() == 0
    model = curve_model(triangulate(points))
    monkeypatch.setattr(module, "curve_model", None)  # the sheets come from the model there is
    for options in ({}, {"sheet_angle": 60.0}):
        expected = medial_mesh(model, **options)
        step.sheets = True
        step.sheet_angle = options.get("sheet_angle", step.sheet_angle)
        step.run()
        data = step.GetOutputDataObject(2)
        assert len(expected) > 500
        assert np.array_equal(points_of(data), expected.points)
        assert np.array_equal(simplices_of(data)[:, :3], expected.triangles)
        assert np.array_equal(array_of(data.GetPointData(), "MaximumInscribedSphereRadius"), expected.radius)
        assert np.array_equal(array_of(data.GetCellData(), "ObjectAngle"), expected.angle)
    step.sheets = False
    step.run()
    assert step.GetOutputDataObject(2).GetNumberOfPoints() == 0


def test_sheets_of_the_plane_are_an_empty_output_with_its_arrays():
    angle = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    step = skeleton_step(polydata(np.concatenate([ring, 0.6 * ring])), sheets=True)
    assert step.run().GetNumberOfPoints() > 0
    assert array_of(step.GetOutputDataObject(2).GetPointData(), "MaximumInscribedSphereRadius").shape == (0,)


@pytest.mark.slow
def test_another_detail_finds_no_sheets_again(monkeypatch):
    from tetraskel.vtkfilters import curve_skeleton as module

    made = []
    monkeypatch.setattr(module, "medial_mesh", lambda *given, **more: made.append(1) or medial_mesh(*given, **more))
    step = skeleton_step(polydata(slab()), sheets=True)
    for detail in (0.5, 1.0):
        step.detail = detail
        step.run()
    assert len(made) == 1


STAGES = [
    "Triangulating",
    "Telling inside from outside",
    "Placing the nodes",
    "Joining the nodes",
    "Collapsing to a graph",
    "Finding the loops",
    "Burning from the surface",
    "Growing the tree",
    "Growing the branches",
    "Drawing the lines",
]


def test_progress_names_the_stages():
    """In the order in which they work, each with its share, and none is passed over however short it is."""
    step, told = skeleton_step(polydata(tube())), []
    step.AddObserver("ProgressEvent", lambda *_: told.append((step.GetProgressText(), step.GetProgress())))
    step.run()
    told = [(text, share) for text, share in told if text and share < 1]
    assert list(dict.fromkeys(text for text, _ in told)) == STAGES
    changes = [k for k in range(1, len(told)) if told[k][0] != told[k - 1][0]]
    assert len(changes) == len(STAGES) - 1  # no stage comes twice
    begins = [told[k][1] for k in changes]
    assert begins == sorted(begins)
    assert begins[1:-1] == pytest.approx([0.5 + 0.45 * end for end in list(ENDS.values())[:-1]])


@pytest.mark.parametrize("stage", ["Triangulating", "Placing the nodes", "Collapsing to a graph", "Finding the sheets"])
def test_a_stop_is_honoured_within_a_second(monkeypatch, stage):
    """In each stage, as the button of ParaView does it."""
    monkeypatch.setattr(base, "PROGRESS_SECONDS", 0.0)
    step = skeleton_step(polydata(slab(4000)), sheets=True)
    asked = []

    def ask(*_):
        if step.GetProgressText() == stage and not asked:
            step.SetAbortExecute(1)
            asked.append(time.monotonic())

    step.AddObserver("ProgressEvent", ask)
    with pytest.raises(Aborted):
        step.run()
    assert time.monotonic() - asked[0] < 1
    assert all(step.GetOutputDataObject(port).GetNumberOfPoints() == 0 for port in range(3))
    step.SetAbortExecute(0)
    step.Modified()
    assert step.run().GetNumberOfPoints() > 0


def test_surfaces_keep_their_cells_on_the_second_output():
    source = vtkSphereSource()
    source.SetThetaResolution(20)
    source.SetPhiResolution(20)
    source.Update()
    step = skeleton_step(source.GetOutput())
    step.run()
    assert step.GetOutputDataObject(1).GetNumberOfPolys() == source.GetOutput().GetNumberOfPolys()


@pytest.mark.slow
def test_a_skeleton_read_back_measures_the_same():
    source = vtkSphereSource()
    source.SetRadius(2)
    source.Update()
    surface = points_of(source.GetOutput()), simplices_of(source.GetOutput())
    skeleton = curve_skeleton(tube())
    read = skeleton_from(skeleton_step(polydata(tube())).run())
    assert measure(read, surface) == pytest.approx(measure(skeleton, surface))


def test_a_line_through_one_point_is_told():
    """Found by fuzzing, in a file that was cut off."""
    found = skeleton_step(polydata(tube())).run()
    line = vtkCellArray()
    line.InsertNextCell(1, [0])
    found.SetLines(line)
    with pytest.raises(InputError, match="expected lines through two points or more, got 1 of 1 through fewer"):
        skeleton_from(found)


@pytest.mark.parametrize(
    ("points", "message"),
    [
        (np.random.default_rng(1).random((300, 3)), "expected an object with an inside, got none"),
        ([[0, 0, 0], [1, 0, 0]], "expected at least 3 distinct points"),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "expected an object with an inside, got none in 3 points"),
        (np.eye(4)[:, :3], "expected an object with an inside, got none in 4 points"),
        ([[0, 0, 0], [1, 1, 1], [2, 2, 2], [3, 3, 3]], "on one line"),
        ([[0, 0, 0], [1, np.nan, 0]], "with NaN"),
    ],
)
def test_what_has_no_skeleton_is_one_line(messages, points, message):
    with pytest.raises(InputError, match=message):
        skeleton_step(polydata(points)).run()
    assert messages.GetOutput().count("CurveSkeleton: ") == 1


def test_no_points_give_an_empty_skeleton_with_all_arrays():
    full, empty = skeleton_step(polydata(tube())).run(), skeleton_step(vtkPolyData()).run()
    for attributes in ("GetPointData", "GetCellData"):
        named = [getattr(data, attributes)() for data in (full, empty)]
        names = [{one.GetArrayName(k) for k in range(one.GetNumberOfArrays())} for one in named]
        assert names[0] == names[1]
    assert empty.GetNumberOfPoints() == 0
