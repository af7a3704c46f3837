"""Every filter through each of its faces: kernel, VTK, ParaView, PyVista and shell agree in defaults and results."""

from __future__ import annotations

import ast
import inspect
import json
from collections.abc import Callable
from dataclasses import dataclass, fields

import numpy as np
import pytest
import pyvista

import tetraskel
from paths import PLUGIN
from programs import finished, program
from results import assert_same_data
from tetraskel import cli, pyvista_accessor, vtkfilters
from tetraskel.vtkfilters.base import camel_case

FACES = ("kernel", "ParaView", "PyVista", "shell")


def filters():
    """The names of all filters there are."""
    return [name for name in vtkfilters.__all__ if name != "SkeletonFilter"]


FILTERS = filters()


@dataclass(frozen=True)
class Case:
    """A filter on a sample.

    `chain` are the filters up to it, each with options that are not the defaults, behind the points of `source`;
    `kernel` makes the same of arrays, `arguments` are those of a command. `not_in_kernel` and `not_in_shell` are the
    options these two ask for in another way.
    """

    chain: tuple[tuple[str, dict], ...]
    kernels: tuple[str, ...]
    kernel: Callable
    arguments: str
    source: str = "points"
    not_in_kernel: frozenset = frozenset()
    not_in_shell: frozenset = frozenset()


def inner(points, **options):
    """A mesh and its inside."""
    mesh = tetraskel.triangulate(points)
    return mesh, tetraskel.interior(mesh, **options)


def centres_of(mesh):
    return mesh.points[mesh.simplices].mean(axis=1)


def kernel_mesh(points):
    return centres_of(tetraskel.triangulate(points, joggle=0.001))


def kernel_interior(points):
    return centres_of(tetraskel.submesh(*inner(points, ratio=1.5)))


def kernel_thinned(points):
    return points[tetraskel.thinned(points, most_points=700, samples_per_radius=5.0).ids]


def kernel_tree(points):
    tree = tetraskel.build_tree(tetraskel.triangulate(points), traversal="depth")
    return tetraskel.assemble_skeleton(tree, centre="incentre", keep_leaves=True).points


def kernel_kept(points, keep_leaves=True):
    tree = tetraskel.remove_flat(tetraskel.build_tree(tetraskel.triangulate(points)), threshold=0.1)
    return tetraskel.assemble_skeleton(tree, keep_leaves=keep_leaves).points


def kernel_voronoi(points):
    mesh, inside = inner(points)
    return tetraskel.voronoi_skeleton(mesh, inside=inside, method="sk3", least_angle=60.0).points


def kernel_raster(points):
    mesh, inside = inner(points)
    mask = tetraskel.rasterise(mesh, inside=inside, resolution=24)
    options = {"method": "distance", "ridge_slope": 0.5, "spacing": mask.spacing, "origin": mask.origin}
    return tetraskel.raster_skeleton(mask.values, **options).points


MESH = ("DelaunayMesh", {})
TREE = (MESH, ("TreeBuilder", {}))
KEPT = (*TREE, ("FlatTetraRemoval", {"threshold": 0.1}))
CASES = {
    "CurveSkeleton": Case(
        (("CurveSkeleton", {"detail": 0.9, "root": "widest"}),),
        ("curve_skeleton", "medial_mesh"),
        lambda points: tetraskel.curve_skeleton(points, detail=0.9, root="widest").points,
        "skeleton --detail 0.9 --root widest",
        not_in_kernel=frozenset({"root_point", "sheets"}),  # the root is a point; another function makes the sheets
        not_in_shell=frozenset({"sheets", "denoise"}),  # a file for the sheets; denoise goes by the method
    ),
    "PointThinning": Case(
        (("PointThinning", {"most_points": 700, "samples_per_radius": 5.0}),),
        ("thinned",),
        kernel_thinned,
        "thin --most-points 700 --samples-per-radius 5",
    ),
    "DelaunayMesh": Case(
        (("DelaunayMesh", {"joggle": 0.001}),),
        ("triangulate",),
        kernel_mesh,
        "tree --joggle 0.001",
        not_in_kernel=frozenset({"gather_below"}),  # of several MPI ranks, which only filters have
        not_in_shell=frozenset({"gather_below"}),
    ),
    "InteriorCells": Case(
        (MESH, ("InteriorCells", {"ratio": 1.5, "extract": True})),
        ("interior",),
        kernel_interior,
        "tree --inside gates --ratio 1.5",
        not_in_kernel=frozenset({"label_array", "extract", "gate_arrays"}),  # arrays of a data set
        not_in_shell=frozenset({"method", "extract", "gate_arrays"}),  # a tree is of all; the inside is what is kept
    ),
    "TreeBuilder": Case(
        (MESH, ("TreeBuilder", {"traversal": "depth", "centre": "incentre"})),
        ("build_tree", "assemble_skeleton"),
        kernel_tree,
        "tree --traversal depth --centre incentre",
    ),
    "FlatTetraRemoval": Case(
        KEPT, ("remove_flat",), kernel_kept, "skeleton --method tree --threshold 0.1 --keep-leaves"
    ),
    "SkeletonOutput": Case(
        (*KEPT, ("SkeletonOutput", {"keep_leaves": True})),
        ("assemble_skeleton",),
        kernel_kept,
        "skeleton --method tree --threshold 0.1 --keep-leaves",
    ),
    "SkeletonSurface": Case(
        (("SkeletonSurface", {"spacing": 0.25}),),
        ("skeleton_surface",),
        lambda skeleton: tetraskel.skeleton_surface(skeleton, spacing=0.25).points,
        "surface --spacing 0.25",
        source="skeleton",
        not_in_kernel=frozenset({"radius_array"}),
    ),
    "BezierSkeleton": Case(
        (("BezierSkeleton", {"tolerance": 0.05, "samples": 6}),),
        ("bezier_skeleton",),
        lambda skeleton: tetraskel.bezier_skeleton(skeleton, tolerance=0.05, samples=6).skeleton.points,
        "bezier --tolerance 0.05 --samples 6",
        source="skeleton",
        not_in_kernel=frozenset({"radius_array"}),
    ),
    "VoronoiSkeleton": Case(
        (("VoronoiSkeleton", {"method": "sk3", "least_angle": 60.0}),),
        ("voronoi_skeleton",),
        kernel_voronoi,
        "voronoi --method sk3 --least-angle 60",
    ),
    "RasterSkeleton": Case(
        (("RasterSkeleton", {"method": "distance", "ridge_slope": 0.5, "resolution": 24}),),
        ("raster_skeleton", "rasterise"),
        kernel_raster,
        "raster --method distance --ridge-slope 0.5 --resolution 24",
        not_in_kernel=frozenset({"mask_array"}),
    ),
}


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    """Files the cases begin from, and what the kernels take in their place."""
    folder = tmp_path_factory.mktemp("parity")
    around, across = np.random.default_rng(0).random((2, 1600)) * 2 * np.pi
    out = 2 + 0.8 * np.cos(across)
    points = np.stack([out * np.cos(around), out * np.sin(around), 0.8 * np.sin(across)], axis=1)
    cloud = pyvista.PolyData(points)
    cloud.save(folder / "points.vtp")
    cloud.tetraskel.skeleton().save(folder / "skeleton.vtp")
    arrays = {"points": points, "skeleton": tetraskel.curve_skeleton(points)}
    return {name: (folder / f"{name}.vtp", value) for name, value in arrays.items()}


def places(data):
    """What two results are compared by: centres of a mesh's cells, else points, in an order of their own."""
    wrapped = pyvista.wrap(data)
    if isinstance(wrapped, pyvista.UnstructuredGrid):
        wrapped = wrapped.cell_centers()
    return ordered(np.asarray(wrapped.points))


def ordered(points):
    return points[np.lexsort(np.round(points, 6).T)]


@pytest.fixture(scope="module")
def expected(sources):
    """The kernels' results by filter."""
    return {name: ordered(case.kernel(sources[case.source][1])) for name, case in CASES.items()}


@pytest.fixture(scope="module")
def described(sources):
    """Arrays of the kernels' results, by filter and by the name they have on its points."""
    points, skeleton = sources["points"][1], sources["skeleton"][1]
    tree = tetraskel.build_tree(tetraskel.triangulate(points), traversal="depth")
    flat = tetraskel.remove_flat(tetraskel.build_tree(tetraskel.triangulate(points)), threshold=0.1)
    drawn = {
        "TreeBuilder": tetraskel.assemble_skeleton(tree, centre="incentre", keep_leaves=True),
        "FlatTetraRemoval": tetraskel.assemble_skeleton(flat, keep_leaves=True),
        "CurveSkeleton": tetraskel.curve_skeleton(points, detail=0.9, root="widest"),
        "BezierSkeleton": tetraskel.bezier_skeleton(skeleton, tolerance=0.05, samples=6).skeleton,
    }
    drawn["SkeletonOutput"] = drawn["FlatTetraRemoval"]
    tree_arrays = {
        "Depth": "depth", "SonRank": "son_rank", "SonCount": "son_count", "SubtreeSize": "subtree_size",
        "CellId": "cell", "ApexId": "apex", "EntryFacet": "entry_facet", "ParentId": "parent",
    }  # fmt: skip
    curve_arrays = {
        "MaximumInscribedSphereRadius": "radius", "Depth": "depth", "ParentId": "parent", "BranchId": "branch_id",
        "NodeDegree": "node_degree", "NodeType": "node_type", "StrahlerOrder": "strahler_order",
        "Abscissas": "abscissa",
    }  # fmt: skip
    trees = {"TreeBuilder": tree, "FlatTetraRemoval": flat, "SkeletonOutput": flat}
    return {
        name: {"points": one.points}
        | (
            {array: getattr(trees[name], field)[one.node] for array, field in tree_arrays.items()}
            if name in trees
            else {array: getattr(one, field) for array, field in curve_arrays.items()}
        )
        for name, one in drawn.items()
    }


def assert_same(found, wanted):
    assert found.shape == wanted.shape
    assert len(wanted) > 20
    assert np.allclose(found, wanted, atol=1e-6)


def method_of(name):
    """The accessor's method for a filter, or None."""
    methods = vars(pyvista_accessor.TetraskelAccessor)
    found = [key for key, made in methods.items() if hasattr(made, "chain") and made.chain[-1].__name__ == name]
    return found[0] if found else None


def missing_faces(name):
    """Which of `FACES` a filter does not have."""
    case = CASES.get(name)
    declared = {node.name for node in ast.parse(PLUGIN.read_text()).body if isinstance(node, ast.ClassDef)}
    has = {
        "kernel": case is not None and all(hasattr(tetraskel, function) for function in case.kernels),
        "ParaView": name in declared,
        "PyVista": method_of(name) is not None,
        "shell": case is not None and case.arguments.split()[0] in cli.COMMANDS,
    }
    return [face for face in FACES if not has[face]]


@pytest.mark.parametrize("name", FILTERS)
def test_every_filter_has_every_face(name):
    assert missing_faces(name) == []


def test_a_filter_without_faces_is_found(monkeypatch):
    class Fake(vtkfilters.SkeletonFilter):
        """A filter that nobody has given a face."""

    monkeypatch.setattr(vtkfilters, "Fake", Fake, raising=False)
    monkeypatch.setattr(vtkfilters, "__all__", [*vtkfilters.__all__, "Fake"])
    missing = {name: missing_faces(name) for name in filters() if missing_faces(name)}
    assert missing == {"Fake": list(FACES)}


def test_a_filter_without_one_face_is_found(monkeypatch, tmp_path):
    with monkeypatch.context() as without:
        without.delattr(pyvista_accessor.TetraskelAccessor, "voronoi")
        assert missing_faces("VoronoiSkeleton") == ["PyVista"]
    with monkeypatch.context() as without:
        others = {name: made for name, made in cli.COMMANDS.items() if name != "voronoi"}
        without.setattr(cli, "COMMANDS", others)  # put back into a dict it would be the last of them
        assert missing_faces("VoronoiSkeleton") == ["shell"]
    with monkeypatch.context() as without:
        without.delattr(tetraskel, "voronoi_skeleton")
        assert missing_faces("VoronoiSkeleton") == ["kernel"]
    plugin = tmp_path / "plugin.py"
    plugin.write_text(PLUGIN.read_text().replace("class VoronoiSkeleton(", "class Other("))
    monkeypatch.setitem(globals(), "PLUGIN", plugin)
    assert missing_faces("VoronoiSkeleton") == ["ParaView"]


def defaults_of(name):
    return {declared.name: declared.default for declared in fields(getattr(vtkfilters, name).options)}


@pytest.mark.parametrize("name", FILTERS)
class TestDefaults:
    def test_of_the_kernel(self, name):
        taken = {}
        for function in CASES[name].kernels:
            taken.update(inspect.signature(getattr(tetraskel, function)).parameters)
        for option, default in defaults_of(name).items():
            assert (option in taken) != (option in CASES[name].not_in_kernel), option
            assert option not in taken or taken[option].default == default, option

    def test_of_the_vtk_filter(self, name):
        made = getattr(vtkfilters, name)()
        for option, default in defaults_of(name).items():
            assert getattr(made, option) == getattr(made, f"Get{camel_case(option)}")() == default

    def test_of_the_accessor(self, name):
        taken = inspect.signature(getattr(pyvista_accessor.TetraskelAccessor, method_of(name))).parameters
        for option, default in defaults_of(name).items():
            assert taken[option].default == default

    def test_of_the_shell(self, name):
        chosen = cli.parser().parse_args([CASES[name].arguments.split()[0], "in", "out"])
        for declared in fields(getattr(vtkfilters, name).options):
            if declared.name not in CASES[name].not_in_shell:
                assert getattr(chosen, declared.metadata["flag"] or declared.name) == declared.default


@pytest.fixture(scope="module")
def filtered(sources):
    """The VTK filters' results by filter, whole."""
    results = {}
    for name, case in CASES.items():
        data = pyvista.read(sources[case.source][0])
        for step, options in case.chain:
            made = getattr(vtkfilters, step)(**options)
            made.SetInputDataObject(0, data)
            data = made.run()
        results[name] = pyvista.wrap(data)
    return results


# Simplices are drawn by the shell as a tree of them: their places are all that can be compared.
ONLY_PLACES_IN_SHELL = {"DelaunayMesh", "InteriorCells"}


@pytest.mark.parametrize("name", FILTERS)
class TestResults:
    """Places, cells and all arrays, to the last bit: no face rounds, and binary files keep every digit."""

    def test_of_the_vtk_filter(self, name, filtered, expected, described):
        assert_same(places(filtered[name]), expected[name])
        data = filtered[name]
        order = np.lexsort(np.round(data.points, 6).T)
        for array, values in described.get(name, {}).items():
            by_kernel = np.lexsort(np.round(described[name]["points"], 6).T)
            found = data.points if array == "points" else data.point_data[array]
            assert np.array_equal(found[order], np.asarray(values)[by_kernel]), array

    def test_of_the_accessor(self, name, sources, filtered):
        data = pyvista.read(sources[CASES[name].source][0])
        for step, options in CASES[name].chain:
            data = getattr(data.tetraskel, method_of(step))(**options)
        assert_same_data(data, filtered[name])

    def test_of_the_shell(self, name, sources, filtered, expected, tmp_path):
        command, *options = CASES[name].arguments.split()
        files = [str(sources[CASES[name].source][0]), str(tmp_path / "out.vtp")]
        assert cli.main([command, *files, *options]) == 0
        found = pyvista.read(tmp_path / "out.vtp")
        if name in ONLY_PLACES_IN_SHELL:
            assert_same(places(found), expected[name])
        else:  # the command goes on from a tree without flat cells to its skeleton
            assert_same_data(found, filtered["SkeletonOutput" if name == "FlatTetraRemoval" else name])


SCRIPT = """
import json, sys
from paraview.simple import *
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter, vtkXMLUnstructuredGridWriter
LoadPlugin(sys.argv[1], remote=False, ns=globals())
defaults = {}
for name, (source, chain) in json.load(open("cases.json")).items():
    proxy = XMLPolyDataReader(FileName=source)
    for step, options in chain:
        proxy = globals()[step](Input=proxy, **options)
    fresh = globals()[name]()
    ports = {"Input", "Boundary", "Original"}
    told = {key for key in fresh.ListProperties() if fresh.GetProperty(key).GetInformationOnly()}
    taken = [key for key in fresh.ListProperties() if key not in ports | told]
    defaults[name] = {key: str(fresh.GetPropertyValue(key)) for key in taken}
    data = servermanager.Fetch(proxy)
    writer = vtkXMLUnstructuredGridWriter() if data.IsA("vtkUnstructuredGrid") else vtkXMLPolyDataWriter()
    writer.SetFileName(name + (".vtu" if data.IsA("vtkUnstructuredGrid") else ".vtp"))
    writer.SetInputData(data)
    writer.Write()
json.dump(defaults, open("defaults.json", "w"))
"""


def in_panel(value):
    """An option's value as a proxy takes it."""
    return (
        value.capitalize()
        if isinstance(value, str) and value.islower()
        else int(value)
        if isinstance(value, bool)
        else value
    )


@pytest.fixture(scope="module")
def in_paraview(sources, tmp_path_factory):
    """Defaults and results of all filters, from one pvpython."""
    executable, folder = program("pvpython"), tmp_path_factory.mktemp("pvpython")
    told = {}
    for name, case in CASES.items():
        chain = [(step, {camel_case(key): in_panel(it) for key, it in options.items()}) for step, options in case.chain]
        told[name] = (str(sources[case.source][0]), chain)
    (folder / "cases.json").write_text(json.dumps(told))
    (folder / "script.py").write_text(SCRIPT)
    done = finished([executable, "script.py", str(PLUGIN)], folder, {})
    assert (done.returncode, done.stderr) == (0, "")
    results = {file.stem: pyvista.read(file) for file in folder.glob("*.vt?")}
    return json.loads((folder / "defaults.json").read_text()), results


@pytest.mark.parametrize("name", FILTERS)
class TestParaView:
    def test_has_the_defaults(self, name, in_paraview):
        told = {key: value.strip("'") for key, value in in_paraview[0][name].items()}
        wanted = {camel_case(option): default for option, default in defaults_of(name).items()}
        assert told == {key: shown(default) for key, default in wanted.items()}

    def test_has_the_results(self, name, in_paraview, filtered):
        """ParaView's Python has no numba here."""
        assert_same_data(in_paraview[1][name], filtered[name], another_engine=True)


def shown(default):
    choice = isinstance(default, str) and default.islower()
    return default.capitalize() if choice else str(list(default) if isinstance(default, tuple) else in_panel(default))
