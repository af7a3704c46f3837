"""What ParaView does with blocks, time steps, selections, partial arrays, aborts and resets; in one pvpython."""

from __future__ import annotations

import json

import numpy as np
import pytest
import pyvista

from paths import PLUGIN
from programs import finished, program
from tetraskel import build_tree, curve_skeleton, triangulate
from tetraskel.kernels.curve_stages import ENDS
from tetraskel.vtkfilters import CurveSkeleton
from tubes import TUBES

SCRIPT = """
import json, sys, time
from paraview.simple import *
from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow
LoadPlugin(sys.argv[1], remote=False, ns=globals())
found = {}

def counted(proxy, *facts):
    proxy.UpdatePipelineInformation()
    return [proxy.GetDataInformation().GetNumberOfPoints(), *(proxy.GetPropertyValue(fact) for fact in facts)]

def said_by(work):
    window = vtkStringOutputWindow()
    vtkOutputWindow.SetInstance(window)
    work()
    vtkOutputWindow.SetInstance(None)
    return window.GetOutput().split()

first, second, few = (XMLPolyDataReader(FileName=name + ".vtp") for name in ("first", "second", "few"))

# blocks
blocks = GroupDatasets(Input=[Elevation(Input=first), second])
mesh = DelaunayMesh(Input=blocks)
tree = TreeBuilder(Input=mesh)
tree.UpdatePipeline()
data = servermanager.Fetch(tree)
found["blocks"] = [data.GetBlock(k).GetNumberOfPoints() for k in range(2)]
found["blocks told"] = counted(tree, "Points", "Trees")
fetched = servermanager.Fetch(mesh)
found["partial"] = [fetched.GetBlock(k).GetPointData().HasArray("Elevation") for k in range(2)]
curves = CurveSkeleton(Input=blocks)
curves.UpdatePipeline()
found["curves of blocks"] = [servermanager.Fetch(curves).GetBlock(k).GetNumberOfPoints() for k in range(2)]
ill = TreeBuilder(Input=DelaunayMesh(Input=GroupDatasets(Input=[few, second])))
found["one ill block"] = " ".join(said_by(ill.UpdatePipeline))

# time
steps = ProgrammableSource(OutputDataSetType="vtkPolyData")
steps.ScriptRequestInformation = '''
times = [0.0, 1.0, 2.0]
info = self.GetOutputInformation(0)
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
info.Remove(Pipeline.TIME_STEPS())
for time in times:
    info.Append(Pipeline.TIME_STEPS(), time)
for time in (0.0, 2.0):
    info.Append(Pipeline.TIME_RANGE(), time)
'''
steps.Script = '''
import numpy as np
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
time = self.GetOutputInformation(0).Get(Pipeline.UPDATE_TIME_STEP()) or 0.0
points = np.load("moving.npz")["step" + str(int(time))]
from tetraskel.vtkfilters.convert import to_points
self.GetOutput().SetPoints(to_points(points))
'''
moving, moving_tree = CurveSkeleton(Input=steps), TreeBuilder(Input=DelaunayMesh(Input=steps))
found["time"] = []
for step in (0, 1, 0, 2, 1):
    for proxy in (moving, moving_tree):
        proxy.UpdatePipeline(step)
    found["time"].append([step, *counted(moving, "Components", "Loops"), *counted(moving_tree)])

# selections
ids = [value for k in range(0, 300) for value in (-1, k)]
chosen = ExtractSelection(Input=first, Selection=IDSelectionSource(IDs=ids, FieldType="POINT"))
selected = DelaunayMesh(Input=chosen)
selected.UpdatePipeline()
found["selection"] = [selected.GetDataInformation().GetDataSetTypeAsString(), *counted(selected, "InputPoints")]
# progress and abort
again = CurveSkeleton(Input=first)
filter_ = again.GetClientSideObject()
texts = []
def tell(*_):
    texts.append([filter_.GetProgressText(), filter_.GetProgress()])
watch = filter_.AddObserver("ProgressEvent", tell)
again.UpdatePipeline()
filter_.RemoveObserver(watch)
found["progress"] = texts
asked = []
def stop(*_):
    if filter_.GetProgress() > 0.1 and not asked:
        asked.append(time.monotonic())
        filter_.SetAbortExecute(1)
watch = filter_.AddObserver("ProgressEvent", stop)
again.LoopSpacings = 2.0
found["abort said"] = said_by(again.UpdatePipeline)
found["abort seconds"] = time.monotonic() - asked[0]
found["aborted"] = again.GetDataInformation().GetNumberOfPoints()
filter_.RemoveObserver(watch)
filter_.SetAbortExecute(0)
again.LoopSpacings = 1.45
again.UpdatePipeline()
found["after abort"] = again.GetDataInformation().GetNumberOfPoints()

# defaults
FILTERS = ("CurveSkeleton DelaunayMesh InteriorCells TreeBuilder FlatTetraRemoval SkeletonOutput SkeletonSurface "
           "BezierSkeleton VoronoiSkeleton RasterSkeleton PointThinning").split()
def taken(proxy):
    names = [name for name in proxy.ListProperties() if not proxy.GetProperty(name).GetInformationOnly()]
    return {name: str(proxy.GetPropertyValue(name)) for name in names if name not in ("Input", "Boundary", "Original")}
found["reset"] = {}
for name in FILTERS:
    proxy = globals()[name]()
    before = taken(proxy)
    for key, value in before.items():
        now, choices = proxy.GetPropertyValue(key), getattr(proxy.GetProperty(key), "Available", None)
        if choices:
            now = next(word for word in choices if word != str(now).strip("'"))
        elif isinstance(now, str):
            now = "another"
        else:
            now = [3.0] * len(now) if hasattr(now, "__len__") else now + 1
        proxy.SetPropertyWithName(key, now)
    changed = taken(proxy)
    proxy.SMProxy.ResetPropertiesToXMLDefaults()
    found["reset"][name] = [before, changed, taken(proxy)]

# errors come once for each update, and go when the reason goes
mild = FlatTetraRemoval(Input=tree, Threshold=2)
found["wrong"] = " ".join(said_by(mild.UpdatePipeline))
mild.Threshold = 0.1
found["right"] = [said_by(mild.UpdatePipeline), mild.GetDataInformation().GetNumberOfPoints() > 0]
json.dump(found, open("found.json", "w"))
"""


@pytest.fixture(scope="module")
def clouds():
    """Points of tubes, small and different."""
    return {"first": TUBES["torus"]().sample(900), "second": TUBES["capsule"]().sample(700)}


@pytest.fixture(scope="module")
def found(clouds, tmp_path_factory):
    """What the script found, in one process."""
    executable, folder = program("pvpython"), tmp_path_factory.mktemp("data")
    for name, points in clouds.items():
        pyvista.PolyData(points).save(folder / f"{name}.vtp")
    pyvista.PolyData(np.eye(3)[:2]).save(folder / "few.vtp")
    np.savez(folder / "moving.npz", **moving(clouds))
    (folder / "script.py").write_text(SCRIPT)
    done = finished([executable, "script.py", str(PLUGIN)], folder, {})
    assert (done.returncode, done.stderr) == (0, "")
    return json.loads((folder / "found.json").read_text())


def moving(clouds):
    """The points of three time steps."""
    return {"step0": clouds["first"], "step1": clouds["second"], "step2": clouds["first"][:800]}


def n_nodes(points):
    return len(build_tree(triangulate(points, engine="qhull")))  # ParaView has no numba here


def test_each_block_has_a_tree_of_its_own(found, clouds):
    alone = [n_nodes(points) for points in clouds.values()]
    assert found["blocks"] == alone
    assert found["blocks told"] == [sum(alone), str(sum(alone)), "2"]


def test_each_block_has_a_curve_of_its_own(found, clouds):
    assert found["curves of blocks"] == [len(curve_skeleton(points)) for points in clouds.values()]


def test_arrays_of_one_block_stay_with_it(found):
    assert found["partial"] == [1, 0]


def test_one_ill_block_is_one_line(found):
    expected = "expected at least 3 distinct points (4 in space), got 2; a triangulation needs more."
    assert found["one ill block"] == f"DelaunayMesh: {expected}"


def test_each_time_step_is_computed_anew(found, clouds):
    for step, n_points, pieces, loops, n_tree in found["time"]:
        points = moving(clouds)[f"step{step}"]
        skeleton = curve_skeleton(points)
        assert (n_points, pieces, loops) == (len(skeleton), str(skeleton.components), str(skeleton.loops))
        assert n_tree == n_nodes(points)


def test_a_selection_is_points(found):
    assert found["selection"] == ["vtkUnstructuredGrid", 300, "300"]


def test_progress_names_the_stages(found):
    texts = [text for text, _ in found["progress"] if text]
    assert list(dict.fromkeys(texts)) == ["Triangulating", *ENDS, "Drawing the lines"]
    shares = [share for _, share in found["progress"]]
    assert shares == sorted(shares)


def test_abort_ends_within_a_second_without_a_red_line(found):
    assert found["abort said"] == []
    assert found["abort seconds"] < 1
    assert found["aborted"] == 0
    assert found["after abort"] > 0


def test_reset_gives_the_defaults(found):
    for before, changed, after in found["reset"].values():
        assert after == before
        assert all(changed[name] != before[name] for name in before)


def test_an_error_goes_with_its_reason(found):
    assert found["wrong"] == "FlatTetraRemoval: threshold must lie between 0 and 1; got 2."
    assert found["right"] == [[], True]


def test_the_facts_are_those_of_the_filter(clouds):
    step = CurveSkeleton()
    assert step.GetFoundLoops() == ""
    step.SetInputDataObject(0, pyvista.PolyData(clouds["first"]))
    step.run()
    assert (step.GetFoundLoops(), step.GetFoundComponents(), step.GetFoundEngine()) == (
        "1",
        "1",
        triangulate(clouds["first"]).engine,
    )
