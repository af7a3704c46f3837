"""The plugin in a real ParaView without a window: what can share a pvpython runs in one."""

from __future__ import annotations

import numpy as np
import pytest
import pyvista

from paths import PLUGIN, ROOT
from tetraskel import (
    assemble_skeleton,
    bezier_skeleton,
    build_tree,
    curve_model,
    curve_skeleton,
    interior,
    medial_mesh,
    raster_skeleton,
    remove_flat,
    skeleton_surface,
    surface_error,
    triangulate,
    voronoi_skeleton,
)
from tetraskel.kernels.centres import circumballs
from tetraskel.kernels.quality import qualities
from tubes import TUBES

CHAIN = """
cloud = XMLPolyDataReader(FileName="torus.vtp")
mesh = DelaunayMesh(Input=cloud, Engine="Qhull")
tree = TreeBuilder(Input=mesh, Traversal="Depth")
kept = FlatTetraRemoval(Input=tree, Threshold=0.1)
skeleton = SkeletonOutput(Input=kept)
fetched = {name: WrapDataObject(servermanager.Fetch(proxy)) for name, proxy in
           dict(mesh=mesh, tree=tree, kept=kept, skeleton=skeleton).items()}
save(**{"tree_" + name: fetched["tree"].PointData[name] for name in
        "NodeId Depth SonRank SonCount SubtreeSize ApexId EntryFacet Quality Radius".split()},
     points=fetched["skeleton"].Points, branch=fetched["skeleton"].PointData["BranchId"],
     parent=fetched["tree"].PointData["ParentId"], cell=fetched["kept"].PointData["CellId"],
     simplices=fetched["mesh"].Cells.reshape(-1, 5)[:, 1:])
"""
INSIDE = """
inside = InteriorCells(Input=mesh, Method="Gates", Extract=1)
by_surface = InteriorCells(Input=mesh, Boundary=Sphere(Radius=1.2), Method="Surface", Extract=1)
for proxy in (inside, by_surface):
    proxy.UpdatePipeline()
    print(proxy.GetDataInformation().GetNumberOfCells())
"""
DOCUMENTATION = """
joggle = DelaunayMesh().SMProxy
print(joggle.GetDocumentation().GetShortHelp())
print(joggle.GetProperty("Joggle").GetDocumentation().GetDescription())
"""
CURVE = """
curve = CurveSkeleton(Input=cloud)
curve.UpdatePipeline()
data, points = (WrapDataObject(servermanager.Fetch(curve, idx=port)) for port in (0, 1))
save(points=data.Points, radius=data.PointData["MaximumInscribedSphereRadius"],
     parent=data.PointData["ParentId"], node=points.PointData["SkeletonNodeId"])
curve.Detail = 1
curve.UpdatePipeline()
print(curve.GetDataInformation().GetNumberOfPoints())
"""
SMOOTH = """
skeleton = XMLPolyDataReader(FileName="skeleton.vtp")
curves = BezierSkeleton(Input=skeleton, Tolerance=0.05)
surface = SkeletonSurface(Input=curves, Original=skeleton, CellsPerRadius=3)
lines, pieces = (WrapDataObject(servermanager.Fetch(curves, idx=port)) for port in (0, 1))
rebuilt = WrapDataObject(servermanager.Fetch(surface))
save(points=lines.Points, curvature=lines.PointData["Curvature"], control=pieces.Points,
     surface=rebuilt.Points, branch=rebuilt.PointData["BranchId"])
print(rebuilt.FieldData["ErrorMean"][0])
"""
SHEETS = """
curve = CurveSkeleton(Input=XMLPolyDataReader(FileName="lens.vtp"))
curve.UpdatePipeline()
print(servermanager.Fetch(curve, idx=2).GetNumberOfPoints())
curve.Sheets = 1
curve.UpdatePipeline()
sheets = WrapDataObject(servermanager.Fetch(OutputPort(curve, "Sheets"), idx=2))
save(points=sheets.Points, radius=sheets.PointData["MaximumInscribedSphereRadius"],
     angle=sheets.CellData["ObjectAngle"])
print([curve.SMProxy.GetOutputPortName(k) for k in range(curve.SMProxy.GetNumberOfOutputPorts())])
"""
VORONOI = """
voronoi = VoronoiSkeleton(Input=InteriorCells(Input=mesh), LeastAngle=30)
found = {}
for method in ("Sk1", "Sk2", "Sk3", "Sk4"):
    voronoi.Method = method
    data = WrapDataObject(servermanager.Fetch(voronoi))
    found[method.lower() + "_points"] = data.Points
    found[method.lower() + "_radius"] = data.PointData["MaximumInscribedSphereRadius"]
    found[method.lower() + "_angle"] = data.CellData["SeparationAngle"]
save(**found)
"""
RASTER = """
wave = Wavelet(WholeExtent=[-8, 8, -6, 6, -5, 5])
mask = Calculator(Input=wave, ResultArrayName="mask", Function="(RTData > 150)*1")
skeleton = RasterSkeleton(Input=mask, MaskArray="mask")
image = WrapDataObject(servermanager.Fetch(mask))
found = {"mask": np.asarray(image.PointData["mask"]).reshape(11, 13, 17).T}
for method in ("Morphological", "Distance"):
    skeleton.Method = method
    data = WrapDataObject(servermanager.Fetch(skeleton))
    found[method.lower() + "_points"] = data.Points
    found[method.lower() + "_radius"] = data.PointData["MaximumInscribedSphereRadius"]
save(**found)
"""
ERRORS = {
    "flat_points": (
        "DelaunayMesh(Input=Line(Resolution=4))",
        "DelaunayMesh: expected points that span a plane or space, got 5 points",
    ),
    "hexahedra": (
        "TreeBuilder(Input=AppendDatasets(Input=Wavelet(WholeExtent=[0, 10, 0, 10, 0, 10])))",
        "TreeBuilder: expected a mesh of tetrahedra only, or of triangles only, got 1000",
    ),
    "no_tree": ("SkeletonOutput(Input=Sphere())", "SkeletonOutput: expected a tree with the point arrays"),
    "bad_value": (
        "FlatTetraRemoval(Input=mesh, Threshold=2)",
        "FlatTetraRemoval: threshold must lie between 0 and 1; got 2.",
    ),
}
SCRIPTS = {
    "chain": CHAIN,
    "inside": INSIDE,
    "documentation": DOCUMENTATION,
    "curve": CURVE,
    "smooth": SMOOTH,
    "sheets": SHEETS,
    "voronoi": VORONOI,
    "raster": RASTER,
    **{name: f"{call}.UpdatePipeline()" for name, (call, _) in ERRORS.items()},
}
TORUS = TUBES["torus"]().sample(2000)
AXIS = np.linspace(0, 3, 30)
LINE = np.stack([AXIS, np.sin(AXIS), 0.3 * AXIS**2], axis=1)


def lens():
    """Random points of a flat ellipsoid."""
    ways = np.random.default_rng(0).normal(size=(1500, 3))
    return ways / np.linalg.norm(ways, axis=1, keepdims=True) * [1, 1, 0.4]


def put_files(folder):
    """What the scripts read; and the plugin, behind a link."""
    pyvista.PolyData(TORUS).save(folder / "torus.vtp")
    pyvista.PolyData(lens()).save(folder / "lens.vtp")
    line = pyvista.PolyData(LINE, lines=[30, *range(30)])
    line["MaximumInscribedSphereRadius"] = 0.3 + 0.05 * AXIS
    line.save(folder / "skeleton.vtp")
    (folder / "plugins").mkdir()
    (folder / "plugins" / PLUGIN.name).symlink_to(PLUGIN)


@pytest.fixture(scope="module")
def parts(in_one_pvpython):
    """What each script left; the plugin is found by its folder, through a link."""
    return in_one_pvpython(SCRIPTS, put_files, PV_PLUGIN_PATH="plugins")


@pytest.fixture(scope="module")
def torus():
    """The triangulation of the points."""
    return triangulate(TORUS, engine="qhull")


@pytest.fixture(scope="module")
def inside(torus):
    """Its cells inside the object."""
    return interior(torus)


def test_nothing_is_said_but_errors(parts):
    assert {name: part.said for name, part in parts.items() if part.said and name not in ERRORS} == {}


def test_the_chain_gives_the_arrays_of_the_kernels(parts, torus):
    assert_arrays_of_the_kernels(parts["chain"].arrays, torus)


def assert_arrays_of_the_kernels(out, mesh):
    tree = build_tree(mesh, traversal="depth")
    kept = remove_flat(tree, threshold=0.1)
    skeleton = assemble_skeleton(kept)
    assert np.array_equal(out["simplices"], mesh.simplices)
    assert np.array_equal(out["parent"], tree.parent)
    radius, _ = circumballs(mesh)
    for name, values in {
        "NodeId": np.arange(len(tree)),
        "Depth": tree.depth,
        "SonRank": tree.son_rank,
        "SonCount": tree.son_count,
        "SubtreeSize": tree.subtree_size,
        "ApexId": tree.apex,
        "EntryFacet": tree.entry_facet,
        "Quality": qualities(mesh)[tree.cell],
    }.items():
        assert np.array_equal(out["tree_" + name], values), name
    assert np.allclose(out["tree_Radius"], radius[tree.cell], rtol=1e-12)
    assert np.array_equal(out["cell"], kept.cell)
    assert np.array_equal(out["branch"], skeleton.branch_id)
    assert np.array_equal(out["points"], skeleton.points)


@pytest.mark.parametrize("name", ERRORS)
def test_an_error_is_one_line(parts, name):
    (line,) = (line for line in parts[name].said.splitlines() if line.strip())
    assert line.startswith(ERRORS[name][1])


def test_inside_is_found(parts, torus, inside):
    by_gates, by_surface = map(int, parts["inside"].printed.split())
    assert by_gates == inside.sum()
    assert 0 < by_surface < len(torus)


def test_filters_have_documentation_and_tooltips(parts):
    short, tooltip = parts["documentation"].printed.strip().splitlines()
    assert short.startswith("Points to the tetrahedra")
    assert tooltip.endswith("Unit: fraction of the bounding-box diagonal.")


def test_the_curve_skeleton_is_the_kernels(parts):
    out = parts["curve"].arrays
    skeleton = curve_skeleton(TORUS)
    assert np.array_equal(out["parent"], skeleton.parent)
    assert np.array_equal(out["node"], skeleton.point_nodes)
    assert np.allclose(out["points"], skeleton.points, atol=1e-9)
    assert np.allclose(out["radius"], skeleton.radius, atol=1e-9)
    assert int(parts["curve"].printed) == len(curve_skeleton(TORUS, detail=1))


def test_curves_and_surface_of_a_skeleton_are_those_of_the_kernels(parts):
    out = parts["smooth"].arrays
    edges = np.stack([np.arange(29), np.arange(1, 30)], axis=1)
    curves = bezier_skeleton((LINE, edges, 0.3 + 0.05 * AXIS), tolerance=0.05)
    surface = skeleton_surface(curves.skeleton, cells_per_radius=3)
    assert np.allclose(out["points"], curves.skeleton.points, atol=1e-6)
    assert np.allclose(out["curvature"], curves.curvature, rtol=1e-4, atol=1e-6)
    assert len(out["control"]) == 4 * len(curves)
    assert out["surface"].shape == surface.points.shape
    assert np.allclose(out["surface"], surface.points, atol=1e-5)
    error = surface_error(surface, LINE)["ErrorMean"]
    assert float(parts["smooth"].printed) == pytest.approx(error, rel=1e-4)


def test_the_sheets_are_a_third_output_by_name(parts):
    assert parts["sheets"].printed.splitlines() == ["0", "['Skeleton', 'Points', 'Sheets']"]
    out, expected = parts["sheets"].arrays, medial_mesh(curve_model(triangulate(lens())))
    assert np.allclose(out["points"], expected.points, atol=1e-9)
    assert np.allclose(out["radius"], expected.radius, atol=1e-9)
    assert np.allclose(out["angle"], expected.angle, atol=1e-6)


@pytest.mark.parametrize("method", ["sk1", "sk2", "sk3", "sk4"])
def test_voronoi_skeletons_are_the_kernels(parts, torus, inside, method):
    out = parts["voronoi"].arrays
    expected = voronoi_skeleton(torus, inside=inside, method=method, least_angle=30)
    assert np.allclose(out[method + "_points"], expected.points, atol=1e-8)
    assert np.allclose(out[method + "_radius"], expected.radius, atol=1e-8)
    assert len(out[method + "_angle"]) == len(expected.angle)


@pytest.mark.parametrize("method", ["morphological", "distance"])
def test_skeletons_of_masks_are_the_kernels(parts, method):
    out = parts["raster"].arrays
    expected = raster_skeleton(out["mask"], method=method, origin=[-8, -6, -5])
    assert np.allclose(out[method + "_points"], expected.points)
    assert np.allclose(out[method + "_radius"], expected.radius)


KERNELS = [
    "branch_table",
    "centres",
    "decode",
    "flat",
    "outline",
    "predicates",
    "skeleton",
    "tree",
    "triangulate",
    "skeleton_surface",
    "bezier_skeleton",
]


def test_kernels_pass_their_tests_inside(pvpython, missing):
    """On ParaView's own Python, NumPy and SciPy; the filters pass theirs on the same VTK in `make test-oldest`."""
    packages = ROOT / ".pvpython-packages"
    if not packages.is_dir():
        missing("pytest for pvpython is not there; `make test` puts it into .pvpython-packages")
    script = f"""
import sys
sys.path[:0] = [{str(packages)!r}]
import pytest
kernels = [ROOT + "/tests/kernels/test_" + name + ".py" for name in {KERNELS!r}]
sys.exit(pytest.main(["-p", "no:cacheprovider", "--rootdir", ROOT, "-c", ROOT + "/pyproject.toml",
                      "-m", "not slow", *kernels]))
"""
    done = pvpython(script)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-2000:]
    assert "passed" in done.stdout
