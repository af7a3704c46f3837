"""Points that fill a square or a cube: nothing lies inside by gates, and with --inside all everything does."""

from __future__ import annotations

import numpy as np
import pytest
import pyvista

from commands import run
from tetraskel import curve_skeleton, triangulate


@pytest.mark.parametrize("dimension", [2, 3])
def test_points_that_fill_their_hull_have_a_curve_skeleton(tmp_path, capsys, dimension):
    points = np.random.default_rng(0).random((400, dimension))
    np.savetxt(tmp_path / "in.csv", points, delimiter=",")
    status, _, err = run(capsys, "skeleton", tmp_path / "in.csv", tmp_path / "o.vtp")
    assert (status, (tmp_path / "o.vtp").exists()) == (2, False)
    assert "use --inside all to take all of it as inside, or --method tree to draw the tree." in err
    status, out, err = run(capsys, "skeleton", tmp_path / "in.csv", tmp_path / "o.vtp", "--inside", "all")
    assert (status, err) == (0, "")
    assert "1 pieces, 0 loops" in out
    mesh = triangulate(points, denoise=True)
    expected = curve_skeleton(mesh, inside=np.ones(len(mesh), bool))
    assert np.allclose(pyvista.read(tmp_path / "o.vtp").points[:, :dimension], expected.points)
