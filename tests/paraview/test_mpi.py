"""The filters in a ParaView on two MPI ranks: pvbatch with and without --sym, and pvserver with a client."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import time

import numpy as np
import pytest
import pyvista

from paths import PLUGIN, ROOT
from programs import environment, finished, program
from tetraskel import assemble_skeleton, build_tree, curve_skeleton, remove_flat, triangulate
from tetraskel.kernels.compilation import SWITCH, numba_is_used
from tubes import TUBES
from two_ranks import EXACT, NUMBA, SECONDS, batch, mpirun, write_pieces

THRESHOLD = 0.1
CHAIN = f"""
import sys
import numpy as np
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy
if len(sys.argv) > 3:
    Connect("localhost", int(sys.argv[3]))
LoadPlugin({str(PLUGIN)!r}, remote=True, ns=globals()) if len(sys.argv) > 3 else None
LoadPlugin({str(PLUGIN)!r}, remote=False, ns=globals())
cloud = XMLPartitionedPolydataReader(FileName="cloud.pvtp")
mesh = DelaunayMesh(Input=cloud, Engine=sys.argv[1], GatherBelow=0)
tree = TreeBuilder(Input=mesh)
kept = FlatTetraRemoval(Input=tree, Threshold={THRESHOLD})
skeleton = SkeletonOutput(Input=kept)
stages = dict(mesh=mesh, tree=tree, kept=kept, skeleton=skeleton)
skeleton.UpdatePipeline()
sym = sys.argv[2] == "sym"
from vtkmodules.vtkParallelCore import vtkMultiProcessController
rank = vtkMultiProcessController.GetGlobalController().GetLocalProcessId() if sym else 0
out = {{}}
for name, proxy in stages.items():
    data = proxy.GetClientSideObject().GetOutputDataObject(0) if sym else servermanager.Fetch(proxy)
    attributes = data.GetPointData()
    names = [attributes.GetArrayName(k) for k in range(attributes.GetNumberOfArrays())]
    out.update({{name + "_" + a: vtk_to_numpy(attributes.GetArray(a)) for a in names}})
    facts = data.GetFieldData()
    out[name + "_facts"] = [facts.GetArray(f).GetValue(0) if facts.HasArray(f) else -1 for f in ("Trees", "Leaves")]
    scalars = attributes.GetScalars()
    out[name + "_scalars"] = scalars.GetName() if scalars else ""
    points = data.GetPoints()
    out[name + "_points"] = vtk_to_numpy(points.GetData()) if data.GetNumberOfPoints() else np.empty((0, 3))
    if name == "mesh" and data.GetNumberOfCells():
        out["simplices"] = vtk_to_numpy(data.GetCells().GetConnectivityArray()).reshape(-1, 4)
counts = mesh.GetDataInformation()
np.savez(f"out{{rank}}.npz", cells=counts.GetNumberOfCells(), **out)
"""


LATTICE = np.stack(np.meshgrid(*[np.arange(5.0)] * 3), -1).reshape(-1, 3)
POINTS = np.concatenate([np.random.default_rng(0).random((300, 3)) * 4, LATTICE])


@pytest.fixture(scope="module")
def alone(missing, tmp_path_factory):
    """Where one rank has run, with the numba beside the plugin: the ranks load what it compiled."""
    if not os.path.isdir(NUMBA) or not numba_is_used():
        missing("there is no numba for ParaView (make paraview-numba), or none here (the extra fast)")
    folder = tmp_path_factory.mktemp("alone")
    write_pieces(folder, POINTS, n_pieces=1)
    (folder / "script.py").write_text(CHAIN)
    done = finished([program("pvpython"), "script.py", "Exact", "sym"], folder, EXACT)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.fixture
def exact(alone):
    """Numba for ParaView, and one place for what it compiles."""
    return EXACT


@pytest.fixture
def cloud(tmp_path):
    """Points of a lattice and between them, in two pieces."""
    write_pieces(tmp_path, POINTS)
    return POINTS


def test_the_exact_engine_in_one_paraview(alone):
    assert_is_serial(alone, POINTS, "exact")


def assert_is_serial(folder, points, engine, fetched=False):
    """The arrays of all ranks, sorted by their ids and without copies, are those of one.

    ParaView 5.11 fetches unstructured grids from its first rank only: of a fetched mesh only the size is known.
    """
    parts = [np.load(path) for path in sorted(folder.glob("out*.npz"))]
    mesh = triangulate(points, engine=engine)
    tree = build_tree(mesh)
    kept = remove_flat(tree, threshold=THRESHOLD)
    skeleton = assemble_skeleton(kept)
    marks = {}

    def whole(stage, name):
        found = [part[f"{stage}_{name}"][marks[stage][k]] for k, part in enumerate(parts) if len(marks[stage][k])]
        return np.concatenate(found)[order[stage]]

    order = {}
    keys_of = {"mesh": "OriginalPointIds", "tree": "NodeId", "kept": "NodeId", "skeleton": "NodeId"}
    for stage, key in keys_of.items():
        marks[stage] = [_own(part, stage) for part in parts]
        keys = np.concatenate(
            [part[f"{stage}_{key}"][own] for part, own in zip(parts, marks[stage], strict=True) if len(own)]
        )
        order[stage] = np.argsort(keys)
        assert len(np.unique(keys)) == len(keys)
    if fetched:
        assert parts[0]["cells"] == len(mesh)
    else:
        assert np.array_equal(whole("mesh", "points"), mesh.points)
        assert np.array_equal(whole("mesh", "weight"), 2.0 * mesh.original_ids)
    for stage, nodes in (("tree", tree), ("kept", kept)):
        assert len(order[stage]) == len(nodes)
        expected = {
            "ParentId": nodes.parent, "Depth": nodes.depth, "SonRank": nodes.son_rank, "SonCount": nodes.son_count,
            "SubtreeSize": nodes.subtree_size, "CellId": nodes.cell, "ApexId": nodes.apex,
            "EntryFacet": nodes.entry_facet,
        }  # fmt: skip
        for name, values in expected.items():
            assert np.array_equal(whole(stage, name), values), (stage, name)
        if not fetched:
            counts = [int((nodes.parent < 0).sum()), int(nodes.is_leaf.sum())]
            with_nodes = [part for part, own in zip(parts, marks[stage], strict=True) if len(own)]
            assert all(np.array_equal(part[f"{stage}_facts"], counts) for part in with_nodes)
            assert all(part[f"{stage}_scalars"] == "Depth" for part in with_nodes)
    assert np.array_equal(whole("skeleton", "NodeId"), skeleton.node)
    assert np.array_equal(whole("skeleton", "points"), skeleton.points)
    for name, values in {"NodeType": skeleton.node_type, "BranchId": skeleton.branch_id}.items():
        assert np.array_equal(whole("skeleton", name), values)


def _own(part, stage):
    name = f"{stage}_vtkGhostType"
    n = len(part[f"{stage}_points"]) if f"{stage}_NodeId" in part or f"{stage}_OriginalPointIds" in part else 0
    return np.flatnonzero(part[name] == 0) if name in part else np.arange(n)


def test_pvbatch_with_a_script_on_each_rank(exact, cloud, tmp_path):
    done = batch(tmp_path, CHAIN, "Exact", "sym", **exact)
    assert done.returncode == 0, done.stderr
    assert_is_serial(tmp_path, cloud, "exact")
    assert min(np.load(path)["tree_NodeId"].size for path in tmp_path.glob("out*.npz")) > 500  # nobody has all


def test_pvbatch_with_a_script_on_the_first_rank(exact, cloud, tmp_path):
    done = batch(tmp_path, CHAIN, "Exact", "client", sym=False, **exact)
    assert done.returncode == 0, done.stderr
    assert_is_serial(tmp_path, cloud, "exact", fetched=True)


def test_a_client_of_pvserver(exact, cloud, tmp_path):
    server = mpirun(tmp_path, program("pvserver"), "--multi-clients", "--server-port=0", **exact)
    try:
        port = next(found[1] for line in server.stdout if (found := re.search(r"Accepting connection.*:(\d+)", line)))
        (tmp_path / "script.py").write_text(CHAIN)
        done = subprocess.run(
            [program("pvpython"), "script.py", "Exact", "client", port],
            cwd=tmp_path, text=True, capture_output=True, timeout=SECONDS, env=environment(**exact),
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
    finally:
        server.terminate()
        server.communicate(timeout=30)
    assert_is_serial(tmp_path, cloud, "exact", fetched=True)


def test_qhull_and_the_curve_skeleton_are_for_one_rank(tmp_path):
    cloud = TUBES["torus"]().sample(900)
    write_pieces(tmp_path, cloud)
    script = (
        CHAIN
        + """
curve = CurveSkeleton(Input=mesh)
curve.UpdatePipeline()
import sys
n = curve.GetClientSideObject().GetOutputDataObject(0).GetNumberOfPoints()
sys.stdout.write(f"{rank} curve {n}\\n")  # at once, or the ranks' words mix
sys.stdout.flush()
"""
    )
    done = batch(tmp_path, script, "Qhull", "sym", **{SWITCH: "0"})
    assert done.returncode == 0, done.stderr
    n = len(cloud) + len(cloud[::50])  # some are in both pieces
    assert (
        f"DelaunayMesh: all {n} points are gathered to the first rank: only the exact engine gives one" in done.stderr
    )
    assert_is_serial(tmp_path, cloud, "qhull")
    counts = dict(re.findall(r"(\d) curve (\d+)", done.stdout))
    assert counts == {"0": str(len(curve_skeleton(triangulate(cloud, engine="qhull")))), "1": "0"}


def test_what_one_rank_cannot_use_fails_on_both_with_its_words(cloud, tmp_path):
    """The second rank's points hold a NaN; all end at once, and both say why."""
    path = tmp_path / "piece1.vtp"
    piece = pyvista.read(path)
    piece.points[3] = np.nan
    piece.save(path)
    script = (
        CHAIN.split("stages =")[0]
        + """
mesh.UpdatePipeline()
print(mesh.GetClientSideObject().last_error)
"""
    )
    started = time.monotonic()
    done = batch(tmp_path, script, "Qhull", "sym", **{SWITCH: "0"})
    assert time.monotonic() - started < 60
    assert done.stdout.count("expected finite coordinates below 1e+100, got 1 of") == 2
    assert done.stdout.count("rank 1: expected finite") == 1


def test_below_the_size_the_first_rank_has_all(exact, cloud, tmp_path):
    done = batch(tmp_path, CHAIN.replace("GatherBelow=0", f"GatherBelow={2 * len(cloud)}"), "Exact", "sym", **exact)
    assert done.returncode == 0, done.stderr
    assert_is_serial(tmp_path, cloud, "exact")
    sizes = [np.load(path)["tree_points"].shape[0] for path in sorted(tmp_path.glob("out*.npz"))]
    assert sizes == [len(build_tree(triangulate(cloud, engine="exact"))), 0]


def test_when_a_rank_is_killed_the_other_ends(tmp_path):
    script = """
import os, signal, sys, time
from vtkmodules.vtkParallelCore import vtkMultiProcessController
sys.path.insert(0, sys.argv[1])
from tetraskel.distributed.mpi import MpiCommunicator
from vtkmodules.vtkParallelMPI4Py import vtkMPI4PyCommunicator
controller = vtkMultiProcessController.GetGlobalController()
comm = MpiCommunicator(vtkMPI4PyCommunicator.ConvertToPython(controller.GetCommunicator()))
comm.agree()
if comm.rank == 1:
    os.kill(os.getpid(), signal.SIGKILL)
comm.agree()
"""
    started = time.monotonic()
    done = batch(tmp_path, script, ROOT / "filters")
    assert time.monotonic() - started < 60
    assert done.returncode != 0
    assert re.search(rf"exited on signal {signal.SIGKILL.value}", done.stdout + done.stderr)


DIES = f"""
import os, time
from paraview.simple import *
LoadPlugin({str(PLUGIN)!r}, remote=False, ns=globals())
from tetraskel.distributed.mpi import MpiCommunicator
swap = MpiCommunicator.swap
def dying(self, messages):
    if self.rank == 1:
        print("dies at", time.time(), flush=True)
        os._exit(7)
    return swap(self, messages)
MpiCommunicator.swap = dying
DelaunayMesh(Input=XMLPartitionedPolydataReader(FileName="cloud.pvtp"), Engine="Qhull").UpdatePipeline()
print("went on", flush=True)
"""


def test_when_a_rank_dies_in_an_exchange_the_other_ends(cloud, tmp_path):
    """The other waits for what it would have sent; mpirun ends it within seconds, and says why."""
    done = batch(tmp_path, DIES)
    ended = time.time()
    assert ended - float(re.search(r"dies at (\S+)", done.stdout)[1]) < 10
    assert done.returncode == 7
    assert "processes exited with non-zero status" in done.stderr
    assert "went on" not in done.stdout
