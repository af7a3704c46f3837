"""`tetraskel compare` writes what `compare` gives, and refuses what it cannot do in one line."""

from __future__ import annotations

import json

import numpy as np
import pytest
import pyvista

import commands
from paths import SAMPLES
from tetraskel import compare, comparison, interior, triangulate
from tetraskel.errors import EngineError
from tetraskel.kernels.object_boundary import boundary_of
from tetraskel.options import COMPARED, RASTER_METHODS


def run(capsys, *arguments):
    return commands.run(capsys, "compare", *arguments)


def colours(path):
    return len(np.unique(np.asarray(pyvista.read(path).active_scalars), axis=0))


def test_the_rectangle_by_all_methods(tmp_path, capsys, monkeypatch):
    def missing(*_):
        raise EngineError("expected scikit-image, which is not there.")

    monkeypatch.setitem(comparison.DRAWERS, "thinning", missing)
    folder = tmp_path / "out"
    status, out, err = run(capsys, SAMPLES / "rectangle8.csv", folder, "--inside", "all", "--resolution", 32)
    assert (status, err) == (0, "")
    assert "9 of 10 skeletons drawn" in out
    points = np.loadtxt(SAMPLES / "rectangle8.csv", delimiter=",", skiprows=1)
    rows = compare(points, inside=np.ones(6), resolution=32)
    table = json.loads((folder / "table.json").read_text())
    assert [row["method"] for row in table["rows"]] == list(COMPARED)
    assert (table["judged_by"], table["surface"]) == ("boundary", None)
    assert table["object"] == {"components": 1, "euler": 1}
    for expected, written in zip(rows, table["rows"], strict=True):
        if expected.failure:
            assert written["failure"] == "expected scikit-image, which is not there."
            assert not (folder / f"{expected.method}.png").exists()
            continue
        assert written["kind"] == expected.kind
        for name, value in expected.measures.items():
            assert written[name] == (value if value is None else pytest.approx(value, rel=1e-6)), (written, name)
        data = pyvista.read(folder / f"{expected.method}.vtp")
        assert data.n_points == len(expected.drawn)
        assert np.allclose(data["MaximumInscribedSphereRadius"], expected.drawn.radius)
        assert colours(folder / f"{expected.method}.png") > 5
    assert colours(folder / "overview.png") > 20
    lines = (folder / "table.md").read_text().splitlines()
    assert any(
        line.startswith("Judged by the boundary of the object's inside, found from the points") for line in lines
    )
    assert any(line.startswith("| thinning | failed: expected scikit-image") for line in lines)
    cells = next(line for line in lines if line.startswith("| sk1 |")).split(" | ")
    assert cells[1:5] == ["points", "6", "-", "-"]


def test_a_surface_is_judged_by_and_named(tmp_path, capsys):
    mesh = triangulate(np.asarray(pyvista.read(SAMPLES / "torus.vtp").points))
    boundary = boundary_of(mesh, interior(mesh))
    surface = tmp_path / "surface.ply"
    faces = np.column_stack([np.full(len(boundary.facets), 3), boundary.facets]).ravel()
    pyvista.PolyData(boundary.vertices, faces).save(surface)
    status, _, err = run(
        capsys, SAMPLES / "torus.vtp", tmp_path / "out", "--methods", "curve,sk4", "--surface", surface
    )
    assert (status, err) == (0, "")
    table = json.loads((tmp_path / "out" / "table.json").read_text())
    assert (table["judged_by"], table["surface"]) == ("surface", str(surface))
    curve, sk4 = table["rows"]
    assert (curve["loops"], sk4["euler"], sk4["kind"]) == (1, 0, "sheets")
    assert f"Judged by the surface {surface}." in (tmp_path / "out" / "table.md").read_text()


def test_json_is_the_table_in_a_line(tmp_path, capsys):
    grid = tmp_path / "mesh.vtu"
    points = np.loadtxt(SAMPLES / "rectangle8.csv", delimiter=",", skiprows=1)
    triangles = triangulate(points).simplices[:-1]
    pyvista.UnstructuredGrid({pyvista.CellType.TRIANGLE: triangles}, points).save(grid)
    for options, n_cells in (([], 5), (["--points-only"], 6)):
        status, out, err = run(
            capsys, grid, tmp_path / "out", "--inside", "all", "--methods", "sk4,tree", "--json", *options
        )
        assert (status, err, out.count("\n")) == (0, "", 1)
        told = json.loads(out)
        assert (told.pop("output"), told.pop("input_points")) == (str(tmp_path / "out"), 8)
        assert told == json.loads((tmp_path / "out" / "table.json").read_text())
        assert f"8 points, {n_cells} of {n_cells} cells inside" in (tmp_path / "out" / "table.md").read_text()


def test_an_outline_is_judged_by(tmp_path, capsys):
    points = np.loadtxt(SAMPLES / "rectangle8.csv", delimiter=",", skiprows=1)
    outline = pyvista.PolyData(points, lines=[9, *range(8), 0])
    outline.save(tmp_path / "outline.vtp")
    status, _, err = run(capsys, SAMPLES / "rectangle8.csv", tmp_path / "out", "--inside", "all", "--methods", "sk4",
                         "--surface", tmp_path / "outline.vtp")  # fmt: skip
    assert (status, err) == (0, "")
    (row,) = json.loads((tmp_path / "out" / "table.json").read_text())["rows"]
    assert row["inside"] == 1.0


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--methods", "curve,nosuch"], "methods must be all or some of curve, tree"),
        (["--detail", "2"], "detail must lie between 0 and 1; got 2"),
        (["--surface", "nosuch.ply"], "expected a file to read, got 'nosuch.ply', which does not exist"),
        (["--surface", str(SAMPLES / "rectangle8.csv")], "expected a surface to judge by"),
        (["--inside", "surface"], "expected --boundary FILE"),
    ],
)
def test_bad_usage_is_one_line_and_leaves_nothing(tmp_path, capsys, arguments, told):
    status, _, err = run(capsys, SAMPLES / "rectangle8.csv", tmp_path / "out", "--inside", "all", *arguments)
    assert status == 2
    assert err.startswith("tetraskel compare: ")
    assert told in err
    assert err.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_folders_that_cannot_be(tmp_path, capsys):
    taken = tmp_path / "taken"
    taken.write_text("mine")
    status, _, err = run(capsys, SAMPLES / "rectangle8.csv", taken)
    assert status == 2
    assert "which is a file" in err
    assert taken.read_text() == "mine"
    status, _, err = run(capsys, SAMPLES / "rectangle8.csv", tmp_path / "no" / "out")
    assert status == 2
    assert "which does not exist" in err


def test_an_input_is_never_replaced(tmp_path, capsys):
    source = tmp_path / "curve.vtp"
    source.write_bytes((SAMPLES / "torus.vtp").read_bytes())
    status, _, err = run(capsys, source, tmp_path)
    assert status == 2
    assert "expected an output beside the input" in err
    assert source.read_bytes() == (SAMPLES / "torus.vtp").read_bytes()
    assert list(tmp_path.iterdir()) == [source]


def test_no_skeleton_at_all_is_an_error(tmp_path, capsys, monkeypatch):
    def missing(*_):
        raise EngineError("expected scikit-image.")

    for name in RASTER_METHODS:
        monkeypatch.setitem(comparison.DRAWERS, name, missing)
    status, _, err = run(
        capsys, SAMPLES / "rectangle8.csv", tmp_path / "out", "--inside", "all", "--methods", "thinning"
    )
    assert (status, err) == (2, "tetraskel compare: no skeleton was drawn; thinning: expected scikit-image.\n")
    assert not (tmp_path / "out").exists()


def test_nothing_inside_is_told(tmp_path, capsys):
    status, _, err = run(capsys, SAMPLES / "rectangle8.csv", tmp_path / "out")
    assert status == 2
    assert "expected an object with an inside, got none of 6 cells" in err
