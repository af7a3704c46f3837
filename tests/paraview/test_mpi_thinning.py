"""Thinning and the curve skeleton of what is left in a ParaView on two MPI ranks: what one finds."""

from __future__ import annotations

import os

import numpy as np

from paths import PLUGIN
from tetraskel import curve_skeleton, thinned
from tetraskel.kernels.compilation import numba_is_used
from tubes import TUBES
from two_ranks import EXACT, NUMBA, batch, write_pieces

SCRIPT = f"""
import sys
import numpy as np
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkParallelCore import vtkMultiProcessController
LoadPlugin({str(PLUGIN)!r}, remote=False, ns=globals())
rank = vtkMultiProcessController.GetGlobalController().GetLocalProcessId()
cloud = XMLPartitionedPolydataReader(FileName="cloud.pvtp")
thin = PointThinning(Input=cloud, MostPoints=1500)
curve = CurveSkeleton(Input=thin)
curve.UpdatePipeline()
kept = thin.GetClientSideObject().GetOutputDataObject(0)
lines = curve.GetClientSideObject().GetOutputDataObject(0)
point_data = kept.GetPointData()
out = {{name: vtk_to_numpy(point_data.GetArray(name)) for name in ("OriginalPointIds", "Spacing", "weight")}}
out["ids"] = vtk_to_numpy(point_data.GetGlobalIds())
out["n"] = vtk_to_numpy(kept.GetFieldData().GetArray("KeptPoints"))
out["coarse"] = vtk_to_numpy(kept.GetFieldData().GetArray("CoarsePoints"))
n_points = lines.GetNumberOfPoints()
out["lines"] = vtk_to_numpy(lines.GetPoints().GetData()) if n_points else np.empty((0, 3))
np.savez(f"out{{rank}}.npz", **out)
"""


def test_two_ranks_keep_and_draw_what_one_does(missing, tmp_path):
    if not os.path.isdir(NUMBA) or not numba_is_used():
        missing("there is no numba for ParaView (make paraview-numba), or none here (the extra fast)")
    points = TUBES["y"]().sample(6000, np.random.default_rng(0))
    write_pieces(tmp_path, points)
    done = batch(tmp_path, SCRIPT, **EXACT)
    assert done.returncode == 0, done.stderr
    parts = [np.load(tmp_path / f"out{rank}.npz") for rank in range(2)]
    expected = thinned(points, most_points=1500)
    assert [int(part["n"][0]) for part in parts] == [len(expected)] * 2
    assert [int(part["coarse"][0]) for part in parts] == [expected.n_coarse] * 2
    assert min(len(part["ids"]) for part in parts) > 300  # each keeps some of its own
    ids, first = np.unique(np.concatenate([part["ids"] for part in parts]), return_index=True)
    assert np.array_equal(ids, expected.ids)
    assert len(ids) == sum(len(part["ids"]) for part in parts)  # points that both ranks have are kept by one
    together = {name: np.concatenate([part[name] for part in parts])[first] for name in parts[0].files[:3]}
    assert np.array_equal(together["OriginalPointIds"], ids)
    assert np.array_equal(together["Spacing"], expected.spacing)
    assert np.array_equal(together["weight"], 2.0 * ids)
    skeleton = curve_skeleton(points[expected.ids])
    assert len(parts[1]["lines"]) == 0
    assert parts[0]["lines"].shape == skeleton.points.shape
    assert np.allclose(parts[0]["lines"], skeleton.points, atol=1e-5)
