"""`tetraskel surface` and `tetraskel bezier`: the same arrays as the filters, one line per error."""

from __future__ import annotations

import numpy as np
import pytest
import pyvista

from commands import run
from paths import SAMPLES
from tetraskel import bezier_skeleton, skeleton_surface
from tetraskel.cli.swc import read_swc
from tetraskel.errors import InputError

SWC = """# id type x y z radius parent
1 1 0 0 0 0.5 -1
2 0 1 0 0 0.4 1  # a comment
4 0 2 1 0 0.3 2
3 0 2 -1 0 0.2 2
"""
POINTS = np.array([[0, 0, 0], [1, 0, 0], [2, 1, 0], [2, -1, 0]], float)
EDGES = np.array([[0, 1], [1, 2], [1, 3]])
RADIUS = np.array([0.5, 0.4, 0.3, 0.2])


@pytest.fixture
def branching(tmp_path):
    (tmp_path / "y.swc").write_text(SWC)
    return tmp_path / "y.swc"


def test_surface_is_skeleton_surface(tmp_path, capsys, branching):
    status, out, err = run(capsys, "surface", branching, tmp_path / "o.vtp", "--spacing", "0.1")
    expected = skeleton_surface((POINTS, EDGES, RADIUS), spacing=0.1)
    written = pyvista.read(tmp_path / "o.vtp")
    assert (status, err) == (0, "")
    assert f"4 balls -> {tmp_path / 'o.vtp'}: {len(expected.simplices):,} triangles, cells of 0.1" in out
    assert np.allclose(written.points, expected.points)
    assert np.array_equal(written.regular_faces, expected.simplices)


@pytest.mark.parametrize("suffix", [".vtk", ".ply", ".obj", ".stl"])
def test_every_format_of_surfaces_is_written(tmp_path, capsys, branching, suffix):
    status, _, err = run(capsys, "surface", branching, tmp_path / f"o{suffix}")
    assert (status, err) == (0, "")
    assert pyvista.read(tmp_path / f"o{suffix}").n_cells == len(skeleton_surface((POINTS, EDGES, RADIUS)).simplices)


def test_the_error_is_printed_and_the_picture_drawn(tmp_path, capsys, branching):
    run(capsys, "surface", branching, tmp_path / "fine.ply", "--cells-per-radius", "9")
    arguments = [branching, tmp_path / "o.vtp", "--against", tmp_path / "fine.ply", "--png", tmp_path / "o.png"]
    status, out, _ = run(capsys, "surface", *arguments)
    assert status == 0
    assert "distance from the original 0.0" in out
    assert "distance to the original 0.0" in out
    colours = np.unique(np.asarray(pyvista.read(tmp_path / "o.png").point_data.active_scalars), axis=0)
    assert len(colours) > 20


def test_a_region_of_the_plane(tmp_path, capsys, branching):
    status, out, _ = run(capsys, "surface", branching, tmp_path / "o.vtp", "--dimension", "plane")
    assert status == 0
    assert ": 1 outlines, " in out


WRONG = [
    ("1 1 0 0 0 0.5", "expected seven finite numbers in line 1"),
    ("1 1 0 0 0 thick -1", "expected seven finite numbers in line 1"),
    ("1 1 0 0 0 1 -1\n1 1 0 0 0 1 -1", "got 1 numbers twice"),
    ("1 1 0 0 0 1 -1\n2 1 0 0 0 1 7", "got 7, which is not there"),
    ("1 1 0 0 0 -1 -1", "finite and not negative, got 1 of 1"),
]


@pytest.mark.parametrize(("text", "message"), WRONG)
def test_a_broken_swc_is_one_line(tmp_path, capsys, text, message):
    (tmp_path / "in.swc").write_text(text)
    status, out, err = run(capsys, "surface", tmp_path / "in.swc", tmp_path / "o.vtp")
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert err.startswith("tetraskel surface: ")
    assert message in err
    assert not (tmp_path / "o.vtp").exists()


def test_what_is_no_text_is_no_swc(tmp_path):
    (tmp_path / "in.swc").write_bytes(b"\xff\xfe\x00\x80")
    with pytest.raises(InputError, match="UTF-8"):
        read_swc(tmp_path / "in.swc", "Radius")


BAD_USE = [
    ([SAMPLES / "torus.vtp", "o.vtp"], "got no arrays; name the array"),
    ([SAMPLES / "polygon.csv", "o.vtp"], "of radii, got "),
    (["missing.swc", "o.vtp"], "missing.swc"),
    ([SAMPLES / "torus.vtp", "o.swc"], "expected an output file ending in .vtp .vtk .ply .obj .stl"),
    ([SAMPLES / "torus.vtp", "o.vtp", "--spacing", "-1"], "spacing must lie between"),
    ([SAMPLES / "torus.vtp", "o.vtp", "--png", "o.gif"], "ending in .png"),
]


@pytest.mark.parametrize(("arguments", "message"), BAD_USE)
def test_bad_use_is_one_line(tmp_path, capsys, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    status, out, err = run(capsys, "surface", *arguments)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert message in err


def test_a_grid_is_no_skeleton(tmp_path, capsys):
    pyvista.PolyData(POINTS).cast_to_unstructured_grid().save(tmp_path / "in.vtu")
    status, _, err = run(capsys, "surface", tmp_path / "in.vtu", tmp_path / "o.vtp")
    assert status == 2
    assert "expected a skeleton as polygonal data" in err


def test_bezier_is_bezier_skeleton(tmp_path, capsys, branching):
    out_file, pieces = tmp_path / "o.vtp", tmp_path / "o.vtu"
    status, out, err = run(
        capsys, "bezier", branching, out_file, "--samples", "4", "--pieces", pieces, "--png", tmp_path / "o.png"
    )
    expected = bezier_skeleton((POINTS, EDGES, RADIUS), samples=4)
    written = pyvista.read(out_file)
    assert (status, err) == (0, "")
    assert f"{len(expected)} cubic pieces in 3 branches, {len(expected.skeleton)} points" in out
    assert np.allclose(written.points, expected.skeleton.points)
    assert np.allclose(written["Curvature"], expected.curvature)
    cells = pyvista.read(pieces)
    assert cells.celltypes.tolist() == [75] * len(expected)
    assert np.allclose(cells.points.reshape(-1, 4, 3)[:, [0, 2, 3, 1]], expected.control)
    assert (tmp_path / "o.png").exists()


@pytest.mark.parametrize("suffix", [".swc", ".graphml", ".ply", ".csv", ".vtk"])
def test_curves_are_written_as_skeletons(tmp_path, capsys, branching, suffix):
    assert run(capsys, "bezier", branching, tmp_path / f"o{suffix}")[0] == 0
    assert (tmp_path / f"o{suffix}").stat().st_size > 100


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["in.swc", "o.stl"], "expected an output file ending in .vtp"),
        (["in.swc", "o.vtp", "--pieces", "curves.vtp"], "ending in .vtu"),
        (["in.swc", "o.vtp", "--tolerance", "2"], "tolerance must lie between"),
        (["in.swc", "o.vtp"], "in.swc"),
    ],
)
def test_bad_use_of_bezier_is_one_line(tmp_path, capsys, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    status, out, err = run(capsys, "bezier", *arguments)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert message in err


def test_surface_covers_sheets_too(tmp_path, capsys, branching):
    triangle = pyvista.PolyData([[5.0, 0, 0], [5.3, 0, 0], [5, 0.3, 0]], faces=[3, 0, 1, 2])
    triangle["MaximumInscribedSphereRadius"] = [0.4, 0.4, 0.4]
    triangle.save(tmp_path / "sheets.vtp")
    arguments = (branching, tmp_path / "o.vtp", "--sheets", tmp_path / "sheets.vtp", "--spacing", "0.1")
    status, _, err = run(capsys, "surface", *arguments)
    assert (status, err) == (0, "")
    points, radius = np.concatenate([POINTS, triangle.points]), np.concatenate([RADIUS, [0.4, 0.4, 0.4]])
    edges = np.concatenate([EDGES, 4 + np.array([[0, 1], [0, 2], [1, 2]])])
    expected = skeleton_surface((points, edges, radius), spacing=0.1)
    assert pyvista.read(tmp_path / "o.vtp").n_cells == len(expected.simplices)


def test_an_object_without_sheets_is_told_and_its_surface_is_that_of_the_lines(tmp_path, capsys):
    lines, sheets = tmp_path / "t.vtp", tmp_path / "sheets.vtp"
    status, out, err = run(capsys, "skeleton", SAMPLES / "torus.vtp", lines, "--sheets", sheets)
    assert status == 0
    assert "nodes" in out
    assert err == "warning: no part of the object has medial sheets; the file of --sheets has 0 faces.\n"
    assert pyvista.read(sheets).n_cells == 0
    for name, more in (("with.vtp", ["--sheets", sheets]), ("without.vtp", [])):
        assert run(capsys, "surface", lines, tmp_path / name, "--spacing", "0.1", *more)[::2] == (0, "")
    surfaces = [pyvista.read(tmp_path / name) for name in ("with.vtp", "without.vtp")]
    assert np.array_equal(surfaces[0].points, surfaces[1].points)
    assert np.array_equal(surfaces[0].faces, surfaces[1].faces)


def test_surface_wants_faces_for_sheets(tmp_path, capsys, branching):
    pyvista.PolyData([[0.0, 0, 0]]).save(tmp_path / "points.vtp")
    status, _, err = run(capsys, "surface", branching, tmp_path / "o.vtp", "--sheets", tmp_path / "points.vtp")
    assert status == 2
    assert "expected medial sheets, faces with radii, for --sheets, got" in err
