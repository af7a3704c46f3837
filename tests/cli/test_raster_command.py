"""`tetraskel raster` writes what `raster_skeleton` gives."""

from __future__ import annotations

import numpy as np
import pytest
import pyvista

import commands
from paths import SAMPLES
from tetraskel import interior, raster_skeleton, rasterise, triangulate


def run(capsys, *arguments):
    return commands.run(capsys, "raster", *arguments)


def image(path, mask):
    grid = pyvista.ImageData(dimensions=mask.shape, spacing=(0.5, 1, 1))
    grid["mask"] = mask.ravel(order="F").astype(np.uint8)
    grid.save(path)


@pytest.mark.parametrize("method", ["morphological", "thinning", "distance"])
def test_a_mask(tmp_path, capsys, method):
    if method == "thinning":
        pytest.importorskip("skimage")
    mask = np.zeros((20, 12, 9), bool)
    mask[2:18, 3:9, 1:8] = True
    image(tmp_path / "in.vti", mask)
    options = ["--method", method, "--png", tmp_path / "out.png"]
    status, out, err = run(capsys, tmp_path / "in.vti", tmp_path / "out.vtp", *options)
    assert (status, err) == (0, "")
    expected = raster_skeleton(mask, method=method, spacing=(0.5, 1, 1))
    written = pyvista.read(tmp_path / "out.vtp")
    assert np.array_equal(written.points, expected.points)
    assert np.array_equal(written["MaximumInscribedSphereRadius"], expected.radius)
    assert f"{len(expected)} nodes" in out
    assert (tmp_path / "out.png").exists()


def test_points_are_made_into_a_mask(tmp_path, capsys):
    torus = SAMPLES / "torus.vtp"
    assert run(capsys, torus, tmp_path / "out.csv", "--resolution", 30, "--element", "cross")[0] == 0
    mesh = triangulate(np.asarray(pyvista.read(torus).points))
    mask = rasterise(mesh, inside=interior(mesh), resolution=30)
    expected = raster_skeleton(mask.values, element="cross", spacing=mask.spacing, origin=mask.origin)
    table = np.genfromtxt(tmp_path / "out.csv", delimiter=",", names=True)
    assert np.allclose(np.stack([table[name] for name in "xyz"], axis=1), expected.points)
    assert np.array_equal(table["Subset"], expected.subset)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["empty.vti", "o.vtp"], "expected a mask with something inside, got 0 at all of its 60 points"),
        (["empty.vti", "o.vtp", "--mask-array", "x"], "expected a point array 'x'"),
        (["empty.vti", "o.vtp", "--resolution", "1"], "resolution must lie between 2 and 2048; got 1"),
        (["empty.vti", "o.swc"], "expected a skeleton with the arrays ParentId and Depth for SWC"),
        (["missing.vti", "o.vtp"], "does not exist"),
    ],
)
def test_bad_input_is_one_line_and_status_two(tmp_path, capsys, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    image(tmp_path / "empty.vti", np.full((3, 4, 5), arguments[1] == "o.swc"))
    status, _, err = run(capsys, *arguments)
    assert status == 2
    assert message in err
    assert err.count("\n") == 1
