"""An option that would do nothing is refused, not taken in silence."""

from __future__ import annotations

import numpy as np
import pytest
import pyvista

from commands import run

IDLE = [
    (
        "skeleton in.csv o.vtp --method tree --detail .9 --root widest --loop-spacings 9",
        "expected --detail, --loop-spacings, --root with --method curve only, got --method tree; leave them out.",
    ),
    (
        "skeleton in.csv o.vtp --threshold .9 --keep-leaves --traversal depth --centre incentre",
        "expected --traversal, --centre, --threshold, --keep-leaves with --method tree only, got --method curve; leave "
        "them out.",
    ),
    (
        "skeleton in.csv o.vtp --threshold=0.01",  # the default, but said
        "expected --threshold with --method tree only, got --method curve; leave --threshold out.",
    ),
    (
        "skeleton in.csv o.vtp --sheet-angle 90",
        "expected --sheet-angle with --sheets only, got none; leave --sheet-angle out.",
    ),
    (
        "skeleton in.csv o.vtp --root-point 1 2 3",
        "expected --root-point with --root point only, got --root paper; leave --root-point out.",
    ),
    (
        "skeleton in.csv o.vtp --inside all --ratio 3",
        "expected --ratio with --inside gates only, got --inside all; leave --ratio out.",
    ),
    ("tree in.csv o.vtp --noise 3", "expected --noise with --inside gates only, got --inside all; leave --noise out."),
    (
        "voronoi in.csv o.vtp --boundary b.vtp",
        "expected --boundary with --inside surface or outline only, got --inside gates; leave --boundary out.",
    ),
    (
        "raster in.csv o.vtp --label-array Here",
        "expected --label-array with --inside array only, got --inside gates; leave --label-array out.",
    ),
    (
        "raster in.csv o.vtp --method thinning --ridge-slope .5",
        "expected --ridge-slope with --method distance only, got --method thinning; leave --ridge-slope out.",
    ),
    (
        "raster in.csv o.vtp --mask-array here",
        "expected --mask-array with an image (.vti) only, got in.csv; leave --mask-array out.",
    ),
    (
        "raster in.vti o.vtp --resolution 9 --ratio 3 --engine qhull",
        "expected --resolution, --engine, --ratio with points, a mesh or --points-only only, got an image in in.vti; "
        "leave them out.",
    ),
    (
        "tree in.vtu o.vtp --engine qhull --joggle 1e-3",
        "expected --engine, --joggle with points or --points-only only, got a mesh in in.vtu; leave them out.",
    ),
    (
        "compare in.vtu out --no-denoise",
        "expected --denoise with points or --points-only only, got a mesh in in.vtu; leave --denoise out.",
    ),
    (
        "surface in.csv o.vtp --spacing .5 --max-cells 5000",
        "expected --max-cells with --spacing 0 only, got --spacing 0.5; leave --max-cells out.",
    ),
    (
        "skeleton in.csv o.vtp --method tree --blocks 2 --ratio 3",
        "expected --ratio with --inside gates only, got --inside all; leave --ratio out.",
    ),
]


@pytest.mark.parametrize(("command", "message"), IDLE)
def test_an_option_that_would_do_nothing_is_refused(tmp_path, capsys, monkeypatch, command, message):
    monkeypatch.chdir(tmp_path)
    np.savetxt("in.csv", np.random.default_rng(0).random((20, 3)), delimiter=",")
    pyvista.ImageData(dimensions=(5, 5, 5)).save("in.vti")
    pyvista.PolyData(np.random.default_rng(0).random((20, 3))).delaunay_3d().save("in.vtu")
    assert run(capsys, *command.split()) == (2, "", f"tetraskel {command.split()[0]}: {message}\n")
    assert not (tmp_path / "o.vtp").exists()


def test_what_is_of_use_is_taken(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    np.savetxt("in.csv", np.random.default_rng(0).random((60, 3)), delimiter=",")
    words = "skeleton in.csv o.vtp --method tree --threshold .1 --no-denoise --inside gates --ratio 1.02"
    assert run(capsys, *words.split())[0] == 0
