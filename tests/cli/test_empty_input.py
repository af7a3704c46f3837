"""A file without points is an error at the shell: a result of nothing would look like success."""

from __future__ import annotations

import io
import types

import numpy as np
import pytest
import pyvista

from commands import run
from tetraskel.cli.tables import read_table

EMPTY = ["empty.csv", "header.csv", "comment.xyz", "empty.npy", "empty.vtp", "empty.vtu"]
CALLS = [
    ["skeleton"],
    ["skeleton", "--method", "tree"],
    ["skeleton", "--method", "tree", "--blocks"],
    ["tree"],
    ["voronoi"],
    ["raster"],
    ["thin"],
    ["compare"],
]


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, text in {"empty.csv": "", "header.csv": "x,y,z\n", "comment.xyz": "# nothing\n", "empty.swc": ""}.items():
        (tmp_path / name).write_text(text)
    np.save("empty.npy", np.empty((0, 3)))
    pyvista.PolyData().save("empty.vtp")
    pyvista.UnstructuredGrid().save("empty.vtu")
    return tmp_path


@pytest.mark.parametrize("call", CALLS, ids=" ".join)
@pytest.mark.parametrize("name", EMPTY)
def test_a_file_without_points_is_one_line_and_no_result(place, capsys, call, name):
    status, out, err = run(capsys, call[0], name, "o.vtp", *call[1:])
    assert (status, out) == (2, "")
    assert err == f"tetraskel {call[0]}: expected points in '{name}', got none.\n"
    assert not (place / "o.vtp").exists()


@pytest.mark.parametrize("call", CALLS[:4], ids=" ".join)
def test_a_pipe_without_points_is_one_line_and_no_result(place, capsys, monkeypatch, call):
    monkeypatch.setattr("sys.stdin", types.SimpleNamespace(buffer=io.BytesIO(b"")))
    status, out, err = run(capsys, call[0], "-", "o.vtp", *call[1:])
    assert (status, out) == (2, "")
    assert err == f"tetraskel {call[0]}: expected points from standard input, got none.\n"
    assert not (place / "o.vtp").exists()


@pytest.mark.parametrize("command", ["surface", "bezier"])
@pytest.mark.parametrize("name", ["empty.swc", "empty.vtp"])
def test_a_skeleton_without_points_is_one_line(place, capsys, command, name):
    status, _, err = run(capsys, command, name, "o.vtp")
    assert (status, err) == (2, f"tetraskel {command}: expected points in '{name}', got none.\n")


def test_a_table_without_rows_is_still_a_table(place):
    assert read_table(place / "empty.csv")[0].shape == (0, 3)
