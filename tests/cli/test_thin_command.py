"""`tetraskel thin` writes what `thinned` keeps."""

from __future__ import annotations

import json

import numpy as np
import pytest
import pyvista

import commands
from tetraskel import thinned
from tubes import TUBES


@pytest.fixture
def points():
    return TUBES["y"]().sample(5000, np.random.default_rng(0))


def run(capsys, *arguments):
    return commands.run(capsys, "thin", *arguments)


def test_an_array_file_and_a_data_set_give_the_same(tmp_path, capsys, points):
    np.save(tmp_path / "in.npy", points)
    pyvista.PolyData(points).save(tmp_path / "in.vtp")
    expected = thinned(points, most_points=1000, samples_per_radius=9)
    for name in ("in.npy", "in.vtp"):
        options = ["--most-points", 1000, "--samples-per-radius", 9]
        status, out, err = run(capsys, tmp_path / name, tmp_path / "out.vtp", *options)
        assert (status, err) == (0, "")
        assert f"5,000 points -> {tmp_path / 'out.vtp'}: {len(expected):,} points" in out
        assert f"{expected.n_coarse:,} of them farther apart than asked" in out
        written = pyvista.read(tmp_path / "out.vtp")
        assert np.array_equal(written.points, points[expected.ids])
        assert np.array_equal(written["OriginalPointIds"], expected.ids)
        assert np.array_equal(written["Spacing"], expected.spacing)


def test_an_outline_in_the_plane(tmp_path, capsys):
    points = TUBES["annulus"]().sample(4000, np.random.default_rng(0))
    np.save(tmp_path / "in.npy", points)
    status, out, _ = run(capsys, tmp_path / "in.npy", tmp_path / "out.csv", "--most-points", 500, "--json")
    expected = thinned(points, most_points=500)
    table = np.genfromtxt(tmp_path / "out.csv", delimiter=",", names=True)
    assert status == 0
    assert json.loads(out)["points"] == len(expected)
    assert np.array_equal(table["OriginalPointIds"], expected.ids)


def test_a_picture_and_one_of_an_array_file(tmp_path, capsys, points):
    np.save(tmp_path / "in.npy", points)
    assert run(capsys, tmp_path / "in.npy", tmp_path / "out.vtp", "--png", tmp_path / "out.png")[0] == 0
    assert (tmp_path / "out.png").stat().st_size > 1000


def test_what_is_wrong_with_an_array_file_is_one_line(tmp_path, capsys, points):
    points[3] = np.inf
    np.save(tmp_path / "in.npy", points)
    status, out, err = run(capsys, tmp_path / "in.npy", tmp_path / "out.vtp")
    assert (status, out) == (2, "")
    assert err.startswith("tetraskel thin: expected finite coordinates below 1e+100, got 1 of 5000 points")
    assert not (tmp_path / "out.vtp").exists()
