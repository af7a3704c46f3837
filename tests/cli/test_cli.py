"""The command line: the same arrays as the filters, one line per error, nothing written over."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
import pyvista

from commands import run
from paths import ENVIRONMENT, PLUGIN, SAMPLES, SHIM
from tetraskel import assemble_skeleton, build_tree, interior, remove_flat, triangulate
from tetraskel.vtkfilters.progress import ProgressLine

POLYGON = SAMPLES / "polygon.csv"


def coordinates(file):
    return np.loadtxt(file, delimiter=",", skiprows=1)


def test_tree_is_build_tree(tmp_path, capsys):
    status, out, err = run(capsys, "tree", POLYGON, tmp_path / "tree.vtp")
    tree = build_tree(triangulate(coordinates(POLYGON)))
    written = pyvista.read(tmp_path / "tree.vtp")
    assert (status, err) == (0, "")
    assert "15 points" in out
    assert f"{len(tree)} nodes" in out
    assert np.array_equal(written["ParentId"], tree.parent)
    assert np.array_equal(written["CellId"], tree.cell)


def test_skeleton_is_the_chain(tmp_path, capsys):
    cloud = SAMPLES / "cloud20.csv"
    options = ["--threshold", "0.15", "--traversal", "depth", "--centre", "incentre", "--joggle", "1e-6"]
    assert run(capsys, "skeleton", cloud, tmp_path / "s.vtp", "--method", "tree", *options, "--keep-leaves")[0] == 0
    tree = build_tree(triangulate(coordinates(cloud), joggle=1e-6), traversal="depth")
    skeleton = assemble_skeleton(remove_flat(tree, threshold=0.15), centre="incentre", keep_leaves=True)
    written = pyvista.read(tmp_path / "s.vtp")
    assert np.array_equal(written.points, skeleton.points)
    assert np.array_equal(written.point_data["BranchId"], skeleton.branch_id)


def test_tetrahedra_of_a_file_are_walked_as_they_are(tmp_path, capsys):
    mesh = triangulate(np.random.default_rng(0).random((50, 3)))
    part = mesh.simplices[::2]
    cells = np.concatenate([np.full((len(part), 1), 4), part], axis=1).ravel()
    pyvista.UnstructuredGrid(cells, np.full(len(part), 10), mesh.points).save(tmp_path / "part.vtu")
    _, out, _ = run(capsys, "tree", tmp_path / "part.vtu", tmp_path / "tree.vtp")
    assert f"its own {len(part)} cells" in out
    assert pyvista.read(tmp_path / "tree.vtp").n_points == len(part)
    run(capsys, "tree", tmp_path / "part.vtu", tmp_path / "tree.vtp", "--points-only")
    assert pyvista.read(tmp_path / "tree.vtp").n_points == len(mesh)


POINTS = np.random.default_rng(1).random((40, 3)).round(3)


def write_points(path):
    suffix = path.suffix
    if suffix == ".npy":
        np.save(path, POINTS)
    elif suffix == ".csv":
        np.savetxt(path, POINTS, delimiter=";", header="X;Y;Z", comments="")
    elif suffix in (".xyz", ".txt"):
        np.savetxt(path, POINTS, header="a comment")
    elif suffix == ".vti":
        pyvista.ImageData(dimensions=(3, 3, 3)).save(path)
    elif suffix == ".vtu":
        pyvista.PolyData(POINTS).cast_to_unstructured_grid().save(path)
    else:
        surface = pyvista.Sphere(theta_resolution=6, phi_resolution=6)
        surface.points[:] = surface.points.round(3)
        surface.save(path) if suffix != ".obj" else path.write_text(
            "".join(f"v {x} {y} {z}\n" for x, y, z in POINTS) + "f 1 2 3\n"
        )


@pytest.mark.parametrize(
    "suffix", [".npy", ".csv", ".xyz", ".txt", ".vti", ".vtu", ".vtp", ".vtk", ".ply", ".stl", ".obj"]
)
def test_every_format_is_read(tmp_path, capsys, suffix):
    write_points(tmp_path / f"in{suffix}")
    assert run(capsys, "tree", tmp_path / f"in{suffix}", tmp_path / "out.vtp")[0] == 0
    nodes = pyvista.read(tmp_path / "out.vtp").n_points
    assert nodes > 20
    if suffix in (".npy", ".csv", ".xyz", ".txt", ".vtu"):
        assert nodes == len(triangulate(POINTS))


@pytest.mark.parametrize("suffix", [".vtp", ".vtk", ".csv"])
def test_every_format_is_written(tmp_path, capsys, suffix):
    out = tmp_path / f"out{suffix}"
    assert run(capsys, "tree", POLYGON, out)[0] == 0
    parents = build_tree(triangulate(coordinates(POLYGON))).parent
    if suffix == ".csv":
        table = np.genfromtxt(out, delimiter=",", names=True)
        assert np.array_equal(table["ParentId"], parents)
    else:
        assert np.array_equal(pyvista.read(out)["ParentId"], parents)


def test_columns_beside_the_coordinates_become_arrays(tmp_path, capsys):
    table = tmp_path / "in.csv"
    table.write_text("id,y,x,z\n" + "".join(f"{k},{y},{x},{z}\n" for k, (x, y, z) in enumerate(POINTS)))
    run(capsys, "tree", table, tmp_path / "out.vtp")
    assert pyvista.read(tmp_path / "out.vtp").n_points == len(triangulate(POINTS))


@pytest.mark.parametrize(
    "header", ['"id","Points:0","Points:1","Points:2"', "name;x [m];y [m];z [m]", "t\tpoints_0\tpoints_1\tpoints_2"]
)
def test_coordinates_are_found_by_name(tmp_path, capsys, header):
    mark = next(mark for mark in ";\t," if mark in header)
    rows = [mark.join(["word" if mark == ";" else "7", *map(str, row)]) for row in POINTS]
    (tmp_path / "in.csv").write_text("\n".join([header, *rows]))
    run(capsys, "tree", tmp_path / "in.csv", tmp_path / "out.vtp")
    assert pyvista.read(tmp_path / "out.vtp").n_points == len(triangulate(POINTS))


def test_a_link_is_followed_and_a_read_only_file_is_kept(tmp_path, capsys):
    (tmp_path / "real.csv").write_text("old")
    (tmp_path / "link.csv").symlink_to(tmp_path / "real.csv")
    assert run(capsys, "tree", POLYGON, tmp_path / "link.csv")[0] == 0
    assert (tmp_path / "link.csv").is_symlink()
    assert (tmp_path / "real.csv").read_text().startswith("x,y,z")


def test_inside_is_kept_and_nothing_inside_is_said(tmp_path, capsys):
    torus = SAMPLES / "torus.vtp"
    assert run(capsys, "tree", torus, tmp_path / "o.vtp", "--inside", "gates")[0] == 0
    mesh = triangulate(np.asarray(pyvista.read(torus).points))
    assert pyvista.read(tmp_path / "o.vtp").n_points == interior(mesh).sum()
    status, _, err = run(capsys, "tree", POLYGON, tmp_path / "o.vtp", "--inside", "gates")
    assert status == 0
    assert err.startswith("warning: InteriorCells: nothing lies inside")
    assert err.count("\n") == 1


def test_pictures_are_drawn(tmp_path, capsys):
    assert run(capsys, "skeleton", SAMPLES / "torus.vtp", tmp_path / "o.vtp", "--png", tmp_path / "o.png")[0] == 0
    picture = pyvista.read(tmp_path / "o.png")
    colours = np.unique(np.asarray(picture.point_data.active_scalars), axis=0)
    assert len(colours) > 20


BROKEN = {
    "words.csv": "one,two,three\nfour,five,six\n",
    "ragged.csv": "1,2,3\n4,5\n",
    "one.xyz": "1\n2\n3\n",
    "line.csv": "0,0,0\n1,1,1\n2,2,2\n",
    "few.csv": "x,y,z\n0,0,0\n",
    "nan.csv": "0,0,0\nnan,1,1\n",
    "comma.csv": "x;y;z\n13,4;84,7;76,4\n",
    "bob.csv": "x,y,z\n1,2,3\n1,bob,3\n",
    "first.csv": "0,5;0;0\n1;0;0\n0;1;0\n0;0;1\n",
    "blanks.xyz": "1 2 3\n-1,5 2 3\n",
    "wide.csv": "1,2,3,4,5\n",
    "named.csv": "id,Points:0,Points:1,height\n0,1,2,3\n",
    "other.csv": "a,b,c,d\n0,1,2,3\n",
    "broken.obj": "this is no mesh",
    "broken.stl": "this is no mesh",
    "broken.ply": "this is no mesh",
    "broken.vtp": "<VTKFile type='PolyData'>",
    "broken.npy": "not an array",
    "broken.vtu": "",
}
WRONG = [
    (["tree", "missing.csv", "o.vtp"], "expected a file to read, got 'missing.csv', which does not exist"),
    (["tree", "words.csv", "o.vtp"], "expected numbers in line 2 of 'words.csv', got 'four'."),
    (["tree", "bob.csv", "o.vtp"], "expected numbers in line 3 of 'bob.csv', got 'bob'."),
    (["tree", "ragged.csv", "o.vtp"], "expected 3 cells in each line of 'ragged.csv', got 2 in line 2"),
    (["tree", "one.xyz", "o.vtp"], "two or three columns"),
    (["tree", "line.csv", "o.vtp"], "3 points on one line"),
    (["tree", "few.csv", "o.vtp"], "expected at least 3 distinct points"),
    (["tree", "nan.csv", "o.vtp"], "got 1 of 2 points with NaN"),
    (["tree", "broken.vtp", "o.vtp"], "cannot be read as .vtp"),
    (["tree", "broken.vtu", "o.vtp"], "cannot be read as .vtu"),
    (["tree", "broken.npy", "o.vtp"], "not a plain array file"),
    (["tree", "broken.obj", "o.vtp"], "expected points in 'broken.obj', got none"),
    (["tree", "broken.stl", "o.vtp"], "broken.stl"),
    (["tree", "broken.ply", "o.vtp"], "broken.ply"),
    (["tree", "comma.csv", "o.vtp"], "decimal points in line 2 of 'comma.csv', got '13,4'; write '13.4'."),
    (["tree", "first.csv", "o.vtp"], "decimal points in line 1 of 'first.csv', got '0,5'; write '0.5'."),
    (["tree", "blanks.xyz", "o.vtp"], "decimal points in line 2 of 'blanks.xyz', got '-1,5'; write '-1.5'."),
    (
        ["skeleton", "first.csv", "o.vtp", "--method", "tree", "--blocks"],
        "decimal points in line 1 of 'first.csv', got '0,5'; write '0.5'.",
    ),
    (["tree", "wide.csv", "o.vtp"], "or a header that names x, y and z, got 5 columns"),
    (["tree", "other.csv", "o.vtp"], "got 4 columns named a, b, c, d"),
    (["tree", "line.csv", "o.vtp", "--png", "o.jpg"], "expected an output file ending in .png, got 'o.jpg'"),
    (["tree", "line.csv", "o.vtp", "--png", "o"], "expected an output file ending in .png, got 'o'"),
    (["tree", "o.vtp", "o.vtp"], "expected an output beside the input"),
    (["tree", ".", "o.vtp"], "expected a file ending in"),
    (["tree", "folder.csv", "o.vtp"], "'folder.csv', which is a folder"),
    (["tree", "line.csv", "folder.csv"], "'folder.csv', which is a folder"),
    (["tree", "line.csv", "o.vtp", "--inside", "surface"], "expected --boundary FILE with --inside surface"),
    (["tree", "line.csv", "o.jpg"], "expected an output file ending in .vtp .vtk .csv"),
    (["tree", "line.doc", "o.vtp"], "expected a file ending in .vtp"),
    (["tree", "line.csv", "nowhere/o.vtp"], "expected a folder to write into"),
    (["tree", "line.csv", "o.vtp", "--png", "nowhere/o.png"], "expected a folder to write into"),
    (["skeleton", "line.csv", "o.vtp", "--threshold", "3"], "threshold must lie between 0 and 1; got 3"),
    (["skeleton", "line.csv", "o.vtp", "--threshold", "x"], "invalid float value"),
    (["tree", "line.csv", "o.vtp", "--traversal", "up"], "invalid choice: 'up'"),
    (["tree", "line.csv"], "the following arguments are required: OUT"),
    (["dance"], "invalid choice: 'dance', expected one of skeleton, tree, "),
    (["skelton", "a", "b"], "; did you mean skeleton? (see tetraskel --help)."),
    (
        ["skeleton", "line.csv", "o.vtp", "--detial", "0.3"],
        "unrecognized arguments: --detial 0.3; did you mean --detail? (see tetraskel skeleton --help).",
    ),
    (["tree", "line.csv", "o.vtp", "--jsn=1"], "--jsn=1; did you mean --json? (see tetraskel tree --help)."),
    (["tree", "line.csv", "o.vtp", "--qwerty"], "arguments: --qwerty (see tetraskel tree --help)."),
    ([], "required: COMMAND"),
]


@pytest.mark.parametrize(("arguments", "message"), WRONG)
def test_bad_usage_and_bad_input_are_one_line_and_status_two(tmp_path, capsys, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    for name, text in BROKEN.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "o.vtp").write_text("precious")
    (tmp_path / "folder.csv").mkdir()
    status, out, err = run(capsys, *arguments)
    assert status == 2
    assert out == ""
    assert err.count("\n") == 1
    assert err.startswith("tetraskel")
    assert message in err
    assert (tmp_path / "o.vtp").read_text() == "precious"
    assert not list(tmp_path.glob(".tetraskel-*"))


def test_plugin_path_names_the_file(capsys, monkeypatch):
    monkeypatch.setenv("PATH", "")  # without a ParaView that needs a note
    assert run(capsys, "plugin-path") == (0, f"{PLUGIN}\n", "")
    assert run(capsys, "plugin-path", "--shim") == (0, f"{SHIM}\n", "")


def test_module_runs_as_a_program():
    command = [sys.executable, "-m", "tetraskel", "--version"]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=ENVIRONMENT)
    assert done.stdout.startswith("tetraskel ")


class Terminal(list):
    """A stream that remembers, and says it is a terminal or not."""

    def __init__(self, is_terminal):
        self.is_terminal = is_terminal

    def isatty(self):
        return self.is_terminal

    def write(self, text):
        self.append(text)

    def flush(self):
        pass


@pytest.mark.parametrize("is_terminal", [True, False])
def test_progress_is_for_terminals(is_terminal):
    stream = Terminal(is_terminal)
    with ProgressLine(stream) as line:
        line.started -= 10
        line.show("Working", 0.5)
    assert ("Working" in "".join(stream)) == is_terminal
    assert bool(stream) == is_terminal


def test_interrupted_work_leaves_nothing(tmp_path, capsys, monkeypatch):
    from tetraskel.vtkfilters import TreeBuilder

    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(TreeBuilder, "execute", interrupt)
    status, _, err = run(capsys, "skeleton", POLYGON, tmp_path / "o.vtp", "--method", "tree")
    assert status == 130
    assert err == "tetraskel skeleton: stopped; nothing was written.\n"
    assert not list(tmp_path.iterdir())


def test_a_mixed_mesh_is_refused_not_ignored(tmp_path, capsys):
    mesh = triangulate(POINTS)
    tetrahedra = np.concatenate([np.full((len(mesh), 1), 4), mesh.simplices], axis=1).ravel()
    cells = np.concatenate([[3, 0, 1, 2], tetrahedra])
    pyvista.UnstructuredGrid(cells, [5] + [10] * len(mesh), mesh.points).save(tmp_path / "mixed.vtu")
    status, _, err = run(capsys, "tree", tmp_path / "mixed.vtu", tmp_path / "o.vtp")
    assert status == 2
    assert f"got 1 of type triangle, {len(mesh)} of type tetra" in err
    status, out, _ = run(capsys, "tree", tmp_path / "mixed.vtu", tmp_path / "o.vtp", "--points-only")
    assert status == 0
    assert "cells" not in out
