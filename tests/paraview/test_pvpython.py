"""The plugin in a real ParaView without a window."""

from __future__ import annotations

import numpy as np
import pytest

from paths import PLUGIN, ROOT, SAMPLES
from tetraskel import assemble_skeleton, build_tree, remove_flat, triangulate
from tetraskel.options import DelaunayOptions, FlatOptions, SkeletonOptions, TreeOptions

CHAIN = """
LoadPlugin(PLUGIN, remote=False, ns=globals())
import sys
import numpy as np
from vtkmodules.numpy_interface.dataset_adapter import WrapDataObject
cloud = XMLPolyDataReader(FileName=sys.argv[1])
mesh = DelaunayMesh(Input=cloud)
tree = TreeBuilder(Input=mesh, Traversal="Depth")
kept = FlatTetraRemoval(Input=tree, Threshold=0.1)
skeleton = SkeletonOutput(Input=kept)
fetched = {name: WrapDataObject(servermanager.Fetch(proxy)) for name, proxy in
           dict(mesh=mesh, tree=tree, kept=kept, skeleton=skeleton).items()}
np.savez("out.npz", points=fetched["skeleton"].Points, branch=fetched["skeleton"].PointData["BranchId"],
         parent=fetched["tree"].PointData["ParentId"], cell=fetched["kept"].PointData["CellId"],
         simplices=fetched["mesh"].Cells.reshape(-1, 5)[:, 1:])
"""


def test_the_chain_gives_the_arrays_of_the_kernels(pvpython, tmp_path):
    import pyvista

    done = pvpython(CHAIN, SAMPLES / "torus.vtp")
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    out = np.load(tmp_path / "out.npz")
    mesh = triangulate(np.asarray(pyvista.read(SAMPLES / "torus.vtp").points))
    tree = build_tree(mesh, traversal="depth")
    kept = remove_flat(tree, threshold=0.1)
    skeleton = assemble_skeleton(kept)
    assert np.array_equal(out["simplices"], mesh.simplices)
    assert np.array_equal(out["parent"], tree.parent)
    assert np.array_equal(out["cell"], kept.cell)
    assert np.array_equal(out["branch"], skeleton.branch_id)
    assert np.array_equal(out["points"], skeleton.points)


def test_plugin_is_found_by_its_folder(pvpython):
    script = "print(DelaunayMesh().Joggle, TreeBuilder().Traversal)"
    done = pvpython(script, PV_PLUGIN_PATH=str(PLUGIN.parent))
    assert done.stdout.split() == ["0.0", "'Breadth'"], done.stderr


def test_plugin_is_found_through_a_link(pvpython, tmp_path):
    (tmp_path / "plugins").mkdir()
    (tmp_path / "plugins" / PLUGIN.name).symlink_to(PLUGIN)
    done = pvpython("print(FlatTetraRemoval().Threshold)", PV_PLUGIN_PATH=str(tmp_path / "plugins"))
    assert float(done.stdout) == FlatOptions().threshold, done.stderr


def test_defaults_are_those_of_the_options(pvpython):
    script = """
LoadPlugin(PLUGIN, remote=False, ns=globals())
for proxy in (DelaunayMesh(), TreeBuilder(), FlatTetraRemoval(), SkeletonOutput()):
    for name in sorted(set(proxy.ListProperties()) - {"Input"}):
        value = proxy.GetPropertyValue(name)
        print(name, str(value).strip("'").lower())
"""
    told = dict(line.split() for line in pvpython(script).stdout.splitlines())
    expected = {}
    for options in (DelaunayOptions(), TreeOptions(), FlatOptions(), SkeletonOptions()):
        for name, value in vars(options).items():
            shown = int(value) if isinstance(value, bool) else value
            expected["".join(word.capitalize() for word in name.split("_"))] = str(shown)
    assert told == expected


ERRORS = {
    "DelaunayMesh(Input=Line(Resolution=4))": "DelaunayMesh: expected points that span a plane or space, got 5 points",
    "TreeBuilder(Input=hexahedra)": "TreeBuilder: expected a mesh of tetrahedra only, or of triangles only, got 1000",
    "SkeletonOutput(Input=Sphere())": "SkeletonOutput: expected a tree with the point arrays",
}


@pytest.mark.parametrize("call", ERRORS)
def test_an_error_is_one_line(pvpython, call):
    script = f"""
LoadPlugin(PLUGIN, remote=False, ns=globals())
hexahedra = AppendDatasets(Input=Wavelet(WholeExtent=[0, 10, 0, 10, 0, 10]))
{call}.UpdatePipeline()
"""
    done = pvpython(script)
    lines = [line for line in done.stderr.splitlines() if line.strip()]
    assert len(lines) == 1, done.stderr
    assert lines[0].startswith(ERRORS[call])


def test_filters_have_documentation_and_tooltips(pvpython):
    script = """
LoadPlugin(PLUGIN, remote=False, ns=globals())
joggle = DelaunayMesh().SMProxy
print(joggle.GetDocumentation().GetShortHelp())
print(joggle.GetProperty("Joggle").GetDocumentation().GetDescription())
"""
    short, tooltip = pvpython(script).stdout.strip().splitlines()
    assert short.startswith("Points to the tetrahedra")
    assert tooltip.endswith("Unit: fraction of the bounding-box diagonal.")


def test_kernels_and_filters_pass_their_tests_inside(pvpython, missing):
    """The whole suite of kernels and filters, on ParaView's own Python, NumPy, SciPy and VTK."""
    packages = ROOT / ".pvpython-packages"
    if not packages.is_dir():
        missing("pytest for pvpython is not there; `make test` puts it into .pvpython-packages")
    script = f"""
import sys
sys.path[:0] = [{str(packages)!r}]
import pytest
sys.exit(pytest.main(["-p", "no:cacheprovider", "--rootdir", ROOT, "-c", ROOT + "/pyproject.toml",
                      ROOT + "/tests/kernels", ROOT + "/tests/vtkfilters"]))
"""
    done = pvpython(script)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-2000:]
    assert "passed" in done.stdout
