"""`tetraskel voronoi` writes what `voronoi_skeleton` gives."""

from __future__ import annotations

import numpy as np
import pytest
import pyvista

import commands
from paths import SAMPLES
from tetraskel import interior, triangulate, voronoi_skeleton


def run(capsys, *arguments):
    return commands.run(capsys, "voronoi", *arguments)


@pytest.mark.parametrize("method", ["sk1", "sk2", "sk3", "sk4"])
@pytest.mark.parametrize("sample", ["rectangle8.csv", "bent_tube.vtp"])
def test_it_is_the_function(tmp_path, capsys, method, sample):
    flat = sample.endswith(".csv")
    options = ["--inside", "all"] if flat else []
    picture = tmp_path / "out.png"
    status, out, err = run(capsys, SAMPLES / sample, tmp_path / "out.vtp", "--method", method, *options,
                           "--least-angle", 40, "--png", picture)  # fmt: skip
    assert (status, err) == (0, "")
    points = np.loadtxt(SAMPLES / sample, delimiter=",", skiprows=1) if flat else pyvista.read(SAMPLES / sample).points
    mesh = triangulate(np.asarray(points))
    inside = None if flat else interior(mesh)
    expected = voronoi_skeleton(mesh, inside=inside, method=method, least_angle=40)
    written = pyvista.read(tmp_path / "out.vtp")
    assert np.array_equal(written.points, expected.points)
    assert written.n_cells == len(expected.separation)
    assert f"{len(expected):,} nodes" in out
    assert (" faces" in out) == (expected.n_polygons > 0)
    assert len(np.unique(np.asarray(pyvista.read(picture).active_scalars), axis=0)) > 5


@pytest.mark.parametrize("suffix", [".swc", ".graphml", ".ply"])
def test_formats_that_would_lose_faces_are_refused(tmp_path, capsys, suffix):
    status, _, err = run(capsys, SAMPLES / "torus.vtp", tmp_path / f"o{suffix}")
    assert status == 2
    assert err.startswith("tetraskel voronoi: expected an output file ending in .vtp .vtk .csv")
    assert err.count("\n") == 1


def test_nothing_inside_is_one_line(tmp_path, capsys):
    status, _, err = run(capsys, SAMPLES / "rectangle8.csv", tmp_path / "o.vtp")
    assert status == 2
    assert "expected an object with an inside, got none of 6 cells" in err
