"""The methods of `mesh.tetraskel`."""

from __future__ import annotations

import inspect
import pickle
import subprocess
import sys

import numpy as np
import pytest
import pyvista

import tetraskel.pyvista_accessor as accessor
from paths import ENVIRONMENT, ROOT, SAMPLES
from tetraskel import InputError, MeshError, build_tree, curve_skeleton, medial_mesh, triangulate
from tetraskel.kernels.curve import curve_model

CLOUD = np.random.default_rng(0).random((40, 3))
TUBE = SAMPLES / "bent_tube.vtp"
METHODS = [name for name, value in vars(accessor.TetraskelAccessor).items() if hasattr(value, "chain")]


@pytest.fixture
def cloud():
    return pyvista.PolyData(CLOUD)


@pytest.fixture(scope="module")
def tube():
    return pyvista.read(TUBE)


@pytest.fixture(scope="module")
def curve(tube):
    return tube.tetraskel.skeleton()


def test_the_tree_is_the_kernels(cloud):
    result = cloud.tetraskel.tree(traversal="depth")
    tree = build_tree(triangulate(CLOUD), traversal="depth")
    assert isinstance(result, pyvista.PolyData)
    assert result.active_scalars_name == "Depth"
    assert np.array_equal(result["ParentId"], tree.parent)


def test_an_option_of_a_filter_before_the_last_one_counts(cloud):
    doubled = cloud.merge(pyvista.PolyData(CLOUD + 1e-12), merge_points=False)
    result = doubled.tetraskel.tree(engine="vtk")
    assert result.field_data["Engine"][0] == "vtk"


def test_a_mesh_is_taken_as_it_is(cloud):
    mesh = cloud.tetraskel.delaunay().extract_cells([0, 1, 2])
    assert mesh.tetraskel.tree().n_points == 3
    assert mesh.tetraskel.interior(method="all").n_cells == 3
    assert mesh.tetraskel.remove_flat(threshold=1.0).n_cells == 0


def test_an_option_is_checked_though_its_filter_is_left_out(cloud):
    mesh = cloud.tetraskel.delaunay()
    with pytest.raises(InputError, match="engine must be one of auto, qhull, vtk, exact; got 'qhul'"):
        mesh.tetraskel.tree(engine="qhul")


def test_methods_follow_one_another(cloud):
    tree = cloud.tetraskel.tree()
    kept = tree.tetraskel.remove_flat(threshold=0.1)
    branches = kept.tetraskel.branches(keep_leaves=True)
    assert tree.n_points > kept.n_points == branches.n_points
    assert kept.active_scalars_name == branches.active_scalars_name == "Depth"


@pytest.mark.slow
def test_the_curve_skeleton_and_its_other_outputs(tube, curve):
    skeleton = curve_skeleton(np.asarray(tube.points))
    assert np.array_equal(curve.points, skeleton.points)
    assert curve.active_scalars_name == "MaximumInscribedSphereRadius"
    assert np.array_equal(tube.tetraskel.skeleton(output="points")["BranchId"], skeleton.point_branches)
    sheets = tube.tetraskel.skeleton(sheets=True, sheet_angle=0.0, output="sheets")
    expected = medial_mesh(curve_model(triangulate(tube.points, denoise=True)), sheet_angle=0.0)
    assert sheets.n_cells == len(expected.triangles) > 0


@pytest.mark.slow
def test_the_way_back_from_a_skeleton(tube, curve):
    smooth = curve.tetraskel.bezier(samples=3)
    pieces = curve.tetraskel.bezier(output="pieces")
    assert pieces.n_cells == smooth.field_data["Pieces"][0] > 0
    surface = smooth.tetraskel.surface(original=tube)
    assert surface.is_manifold
    assert surface.active_scalars_name == "BranchId"
    assert 0 < surface.field_data["ErrorMean"][0] < surface.field_data["ErrorMax"][0]


def test_inside_a_surface_given_as_boundary():
    points = pyvista.PolyData(np.concatenate([pyvista.Sphere(radius=0.4).points, pyvista.Cube().points]))
    result = points.tetraskel.interior(method="surface", boundary=pyvista.Sphere(radius=0.4), extract=True)
    assert result.active_scalars_name == "Inside"
    assert 0 < result.volume < 4 / 3 * np.pi * 0.4**3


def test_an_image_is_a_mask():
    image = pyvista.ImageData(dimensions=(9, 9, 9))
    image["mask"] = (np.abs(image.points - 4).max(axis=1) <= 2).astype(np.uint8)
    result = image.tetraskel.raster()
    assert result.points.tolist() == [[4, 4, 4]]
    assert result["MaximumInscribedSphereRadius"].shape == (1,)


def test_input_is_left_alone(cloud):
    before = cloud.copy()
    cloud.tetraskel.tree()
    assert cloud == before


ERRORS = {
    "a wrong value": (lambda data: data.tetraskel.tree(centre="middle"), InputError, "centre must be one of"),
    "no such output": (lambda data: data.tetraskel.skeleton(output="faces"), InputError, "output must be one of skel"),
    "no radii": (lambda data: data.tetraskel.surface(), InputError, "expected a skeleton with the point array"),
    "no tree": (lambda data: data.tetraskel.branches(), InputError, "expected a tree with the point arrays"),
    "no mesh": (lambda _: pyvista.Plane().tetraskel.remove_flat(), MeshError, "got 100 of type quad"),
    "no points": (lambda _: pyvista.ImageData().tetraskel.tree(), InputError, "input of type vtkPointSet"),
    "too few": (lambda _: pyvista.PolyData(CLOUD[:2]).tetraskel.tree(), InputError, "expected"),
    "misspelt": (lambda data: data.tetraskel.tree(center="incentre"), TypeError, r"tree\(\) has no option 'center'"),
    "by place": (lambda data: data.tetraskel.tree("depth"), TypeError, "positional"),
}


@pytest.mark.parametrize("case", ERRORS)
def test_errors_are_raised_and_nothing_is_printed(case, cloud, capfd):
    call, kind, message = ERRORS[case]
    with pytest.raises(kind, match=message):
        call(cloud)
    assert capfd.readouterr() == ("", "")


def test_a_warning_of_a_filter_is_a_warning():
    with pytest.warns(UserWarning, match="^InteriorCells: ") as caught:
        pyvista.PolyData(CLOUD[:8]).tetraskel.interior()
    assert caught[0].filename == __file__


def test_progress_is_drawn_where_it_is_asked_for(cloud, capfd):
    cloud.tetraskel.tree()
    assert capfd.readouterr().err == ""
    cloud.tetraskel.tree(progress_bar=True)
    assert "%" in capfd.readouterr().err


@pytest.mark.parametrize("name", METHODS)
def test_help_shows_every_option(name):
    method = getattr(accessor.TetraskelAccessor, name)
    text = inspect.getdoc(method)
    parameters = list(inspect.signature(method).parameters.values())[1:]
    assert parameters[-1].name == "progress_bar"
    for parameter in parameters:
        assert parameter.kind is parameter.KEYWORD_ONLY
        assert f"\n{parameter.name} : " in text
    assert method.__qualname__ == f"TetraskelAccessor.{name}"


def test_results_can_be_pickled(cloud, curve):
    for result in (cloud.tetraskel.tree(), cloud.tetraskel.delaunay(), curve):
        again = pickle.loads(pickle.dumps(result))
        assert again == result
        assert again.active_scalars_name == result.active_scalars_name


@pytest.mark.skipif(not hasattr(pyvista, "register_dataset_accessor"), reason="PyVista 0.48 and later")
def test_pyvista_finds_it_by_its_entry_point(tmp_path):
    tomllib = pytest.importorskip("tomllib")
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["entry-points"]["pyvista.accessors"]
    info = tmp_path / "tetraskel_here-0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: tetraskel-here\nVersion: 0\n")
    lines = [f"{name} = {value}" for name, value in declared.items()]
    (info / "entry_points.txt").write_text("\n".join(["[pyvista.accessors]", *lines, ""]))
    code = "import pyvista, sys; print('tetraskel' in sys.modules, pyvista.Sphere().tetraskel.delaunay().n_points)"
    path = f"{tmp_path}:{ENVIRONMENT['PYTHONPATH']}"
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, env={**ENVIRONMENT, "PYTHONPATH": path})
    assert done.stdout.split() == ["False", "842"], done.stderr


def test_an_older_pyvista_gets_it_by_the_import():
    code = """
import pyvista
vars(pyvista).pop("register_dataset_accessor", None)
pyvista.__getattr__ = lambda name: (_ for _ in ()).throw(AttributeError(name))
import tetraskel.pyvista_accessor
print(isinstance(vars(pyvista.DataSet)["tetraskel"], property), pyvista.Sphere().tetraskel.delaunay().n_points)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=ENVIRONMENT)
    assert done.stdout.split() == ["True", "842"], done.stderr
