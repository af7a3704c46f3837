"""VoronoiSkeleton in a real ParaView."""

from __future__ import annotations

import numpy as np
import pyvista

from paths import SAMPLES
from tetraskel import interior, triangulate, voronoi_skeleton
from tetraskel.options import VoronoiOptions


def test_it_is_the_function(pvpython, tmp_path):
    script = """
LoadPlugin(PLUGIN, remote=False, ns=globals())
import numpy as np
from vtkmodules.numpy_interface.dataset_adapter import WrapDataObject
mesh = DelaunayMesh(Input=XMLPolyDataReader(FileName=ROOT + "/sample_data/torus.vtp"), Engine="Qhull")
voronoi = VoronoiSkeleton(Input=InteriorCells(Input=mesh))
print(voronoi.Method, voronoi.LeastSeparation, voronoi.LeastAngle)
found = {}
for method in ("Sk1", "Sk2", "Sk3", "Sk4"):
    voronoi.Method = method
    voronoi.LeastAngle = 30
    data = WrapDataObject(servermanager.Fetch(voronoi))
    found[method + "_points"] = data.Points
    found[method + "_radius"] = data.PointData["MaximumInscribedSphereRadius"]
    found[method + "_angle"] = data.CellData["SeparationAngle"]
np.savez("out.npz", **found)
"""
    done = pvpython(script)
    assert done.stderr == ""
    defaults = VoronoiOptions()
    assert done.stdout.split() == [
        repr(defaults.method.capitalize()),
        str(defaults.least_separation),
        str(defaults.least_angle),
    ]
    out = np.load(tmp_path / "out.npz")
    mesh = triangulate(np.asarray(pyvista.read(SAMPLES / "torus.vtp").points), engine="qhull")
    inside = interior(mesh)
    for method in ("sk1", "sk2", "sk3", "sk4"):
        expected = voronoi_skeleton(mesh, inside=inside, method=method, least_angle=30)
        name = method.capitalize()
        assert np.allclose(out[name + "_points"], expected.points, atol=1e-8)
        assert np.allclose(out[name + "_radius"], expected.radius, atol=1e-8)
        assert len(out[name + "_angle"]) == len(expected.angle)
