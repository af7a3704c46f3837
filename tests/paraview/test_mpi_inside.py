"""Inside and outside in a ParaView on two MPI ranks: what one rank finds, and no rank has the whole mesh."""

from __future__ import annotations

import os

import numpy as np
import pytest

from dealt import uniform
from paths import PLUGIN
from programs import finished, program
from tetraskel import InsideWarning, interior, triangulate
from tetraskel.kernels.compilation import numba_is_used
from tubes import TUBES
from two_ranks import EXACT, NUMBA, batch, write_pieces

CLOUDS = {"torus": TUBES["torus"]().sample(700), "volume": uniform(np.random.default_rng(0), 300)}
MESSAGES = {"torus": "taken for inside is what is", "volume": "nothing lies inside: no room is 2 times larger"}
CHAIN = f"""
import numpy as np
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkParallelCore import vtkMultiProcessController
LoadPlugin({str(PLUGIN)!r}, remote=False, ns=globals())
rank = vtkMultiProcessController.GetGlobalController().GetLocalProcessId()
out = {{}}
def values(array):
    return np.empty(0, np.int64) if array is None else vtk_to_numpy(array)
def save(name, data, cells):
    n = data.GetNumberOfCells()
    ids = values(data.GetPointData().GetGlobalIds())
    ids = ids if len(ids) else np.arange(data.GetNumberOfPoints())
    width = 3 if data.IsA("vtkPolyData") else 4
    out[name + "_cells"] = ids[values(cells.GetConnectivityArray())].reshape(-1, width) if n else np.empty((0, width))
    attributes = data.GetCellData()
    names = [attributes.GetArrayName(k) for k in range(attributes.GetNumberOfArrays())]
    out.update({{name + "_" + a: values(attributes.GetArray(a)) for a in names}})
    if attributes.GetScalars():
        out[name + "_scalars"] = attributes.GetScalars().GetName()
for name in {list(CLOUDS)!r}:
    cloud = XMLPartitionedPolydataReader(FileName=name + "/cloud.pvtp")
    mesh = DelaunayMesh(Input=cloud, Engine="Exact", GatherBelow=0)
    both = InteriorCells(Input=mesh, GateArrays=1)
    kept = InteriorCells(Input=mesh, Extract=1)
    tree = TreeBuilder(Input=kept)
    for stage, proxy in dict(both=both, kept=kept, tree=tree).items() if name == "torus" else [("both", both)]:
        proxy.UpdatePipeline()
        found = proxy.GetClientSideObject().GetOutputDataObject(0)
        if stage == "tree":
            own = np.ones(found.GetNumberOfPoints(), bool)
            ghosts = values(found.GetPointData().GetArray("vtkGhostType"))
            own[: len(ghosts)] = ghosts == 0
            for array in ("NodeId", "CellId", "ParentId"):
                out["tree_" + array] = values(found.GetPointData().GetArray(array))[own]
            continue
        save(name + "_" + stage, found, found.GetCells())
        out[name + "_" + stage + "_count"] = values(found.GetFieldData().GetArray("InsideCells"))
        rim = proxy.GetClientSideObject().GetOutputDataObject(1)
        save(name + "_" + stage + "_rim", rim, rim.GetPolys())
np.savez(f"out{{rank}}.npz", **out)
"""


@pytest.fixture(scope="module")
def serial(missing, tmp_path_factory):
    """What one rank finds in a folder with the clouds in one piece; what is compiled there the two ranks load."""
    if not os.path.isdir(NUMBA) or not numba_is_used():
        missing("there is no numba for ParaView (make paraview-numba), or none here (the extra fast)")
    folder = tmp_path_factory.mktemp("one")
    write_clouds(folder, n_pieces=1)
    (folder / "script.py").write_text(CHAIN)
    done = finished([program("pvpython"), "script.py"], folder, EXACT)
    assert done.returncode == 0, done.stderr
    return dict(np.load(folder / "out0.npz")), done.stderr


def write_clouds(folder, n_pieces):
    for name, points in CLOUDS.items():
        (folder / name).mkdir()
        write_pieces(folder / name, points, n_pieces)


def test_two_ranks_find_what_one_finds(serial, tmp_path):
    expected, said = serial
    for name, message in MESSAGES.items():
        with pytest.warns(InsideWarning, match=message):
            inside = interior(triangulate(CLOUDS[name], engine="exact"))
        assert np.array_equal(expected[f"{name}_both_Inside"], inside)
        assert inside.any() == (name == "torus")
    write_clouds(tmp_path, n_pieces=2)
    done = batch(tmp_path, CHAIN, **EXACT)
    assert done.returncode == 0, done.stderr
    parts = [np.load(tmp_path / f"out{rank}.npz") for rank in range(2)]
    for name, values in expected.items():
        if name.startswith("tree"):
            continue
        if name.endswith(("count", "scalars")):
            assert all(np.array_equal(part[name], values) for part in parts), name
        else:
            assert np.array_equal(np.concatenate([part[name] for part in parts]), values), name
    assert min(len(part["torus_both_cells"]) for part in parts) > 1000  # nobody has all
    order = np.argsort(np.concatenate([part["tree_NodeId"] for part in parts]))
    for name in ("tree_NodeId", "tree_CellId", "tree_ParentId"):
        assert np.array_equal(np.concatenate([part[name] for part in parts])[order], expected[name]), name
    for message in MESSAGES.values():
        assert said.count(message) == done.stderr.count(message) > 0
