"""RasterSkeleton in a real ParaView."""

from __future__ import annotations

import numpy as np

from tetraskel import raster_skeleton
from tetraskel.options import RasterInputOptions


def test_it_is_the_function(pvpython, tmp_path):
    script = """
LoadPlugin(PLUGIN, remote=False, ns=globals())
import numpy as np
from vtkmodules.numpy_interface.dataset_adapter import WrapDataObject
wave = Wavelet(WholeExtent=[-8, 8, -6, 6, -5, 5])
mask = Calculator(Input=wave, ResultArrayName="mask", Function="(RTData > 150)*1")
skeleton = RasterSkeleton(Input=mask, MaskArray="mask")
for name in ("Method", "Element", "RidgeSlope", "Resolution"):
    print(str(skeleton.GetPropertyValue(name)).strip("'").lower())
image = WrapDataObject(servermanager.Fetch(mask))
found = {"mask": np.asarray(image.PointData["mask"]).reshape(11, 13, 17).T}
for method in ("Morphological", "Distance"):
    skeleton.Method = method
    data = WrapDataObject(servermanager.Fetch(skeleton))
    found[method + "_points"] = data.Points
    found[method + "_radius"] = data.PointData["MaximumInscribedSphereRadius"]
np.savez("out.npz", **found)
"""
    done = pvpython(script)
    assert done.stderr == ""
    defaults = RasterInputOptions()
    names = ("method", "element", "ridge_slope", "resolution")
    assert done.stdout.split() == [str(getattr(defaults, name)) for name in names]
    out = np.load(tmp_path / "out.npz")
    for method in ("morphological", "distance"):
        expected = raster_skeleton(out["mask"], method=method, origin=[-8, -6, -5])
        assert np.allclose(out[method.capitalize() + "_points"], expected.points)
        assert np.allclose(out[method.capitalize() + "_radius"], expected.radius)
